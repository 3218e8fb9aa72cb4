"""Laws of motion of an obstacle's centre, known at every instant of a scenario."""

from typing import Annotated, Literal

import numpy as np
import numpy.typing as npt
from pydantic import BaseModel, ConfigDict, Field, model_validator

FloatArray = npt.NDArray[np.float64]
Coordinate = Annotated[float, Field(ge=-100.0, le=100.0, allow_inf_nan=False)]
Point = tuple[Coordinate, Coordinate, Coordinate]
Finite = Annotated[float, Field(ge=-1e6, le=1e6, allow_inf_nan=False)]


class Orbit(BaseModel):
    """A circle run at constant rate: the paper's obstacles (section V).

    The centre is at ``center + radius * (cos a * e1 + sin a * e2)`` with ``a = phase + rate * t``, where e1 and e2 span
    the plane with unit normal ``normal``.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    kind: Literal["orbit"] = "orbit"
    center_m: Point
    radius_m: float = Field(ge=0, le=100.0, allow_inf_nan=False)
    normal: Point = Field(description="normal of the orbit's plane, any length but zero")
    rate_rad_s: Finite
    phase_rad: Finite

    @model_validator(mode="after")
    def _has_a_plane(self) -> "Orbit":
        if np.linalg.norm(self.normal) < 1e-9:
            raise ValueError("normal must not be zero")
        return self

    def position(self, times_s: FloatArray) -> FloatArray:
        """Centre at each time: (T,) [s] -> (T, 3) [m]."""
        axis = np.asarray(self.normal) / np.linalg.norm(self.normal)
        # Any vector not along the axis gives a first direction; the smallest component is the safest choice.
        helper = np.eye(3)[int(np.argmin(np.abs(axis)))]
        e1 = np.cross(axis, helper)
        e1 /= np.linalg.norm(e1)
        e2 = np.cross(axis, e1)
        angle = self.phase_rad + self.rate_rad_s * np.asarray(times_s, dtype=np.float64)
        offset = self.radius_m * (np.outer(np.cos(angle), e1) + np.outer(np.sin(angle), e2))
        return np.asarray(np.asarray(self.center_m) + offset)

    @property
    def speed_bound_m_s(self) -> float:
        """Largest speed at any time."""
        return abs(self.rate_rad_s) * self.radius_m


class Track(BaseModel):
    """A recorded motion: straight between timed points, at rest before the first and after the last."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    kind: Literal["track"] = "track"
    times_s: tuple[Finite, ...] = Field(min_length=1, max_length=100_000)
    positions_m: tuple[Point, ...] = Field(min_length=1, max_length=100_000)

    @model_validator(mode="after")
    def _is_a_function_of_time(self) -> "Track":
        if len(self.times_s) != len(self.positions_m):
            raise ValueError(f"times_s has {len(self.times_s)} entries, positions_m has {len(self.positions_m)}")
        if (np.diff(self.times_s) <= 0).any():
            raise ValueError("times_s must increase strictly")
        return self

    def position(self, times_s: FloatArray) -> FloatArray:
        """Centre at each time: (T,) [s] -> (T, 3) [m]."""
        points = np.asarray(self.positions_m)
        return np.stack([np.interp(times_s, self.times_s, points[:, k]) for k in range(3)], axis=1)

    @property
    def speed_bound_m_s(self) -> float:
        """Largest speed at any time."""
        if len(self.times_s) == 1:
            return 0.0
        steps = np.linalg.norm(np.diff(self.positions_m, axis=0), axis=1)
        return float((steps / np.diff(self.times_s)).max())


Motion = Annotated[Orbit | Track, Field(discriminator="kind")]
