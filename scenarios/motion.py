"""Laws of motion of an obstacle's centre, known at every instant of a scenario."""

import functools
import itertools
from typing import Annotated, Any, Literal

import numpy as np
import numpy.typing as npt
from pydantic import BaseModel, ConfigDict, Field, SerializerFunctionWrapHandler, model_serializer, model_validator

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
        e1, e2 = _plane(self.normal)
        angle = self.phase_rad + self.rate_rad_s * np.asarray(times_s, dtype=np.float64)
        offset = self.radius_m * (np.outer(np.cos(angle), e1) + np.outer(np.sin(angle), e2))
        return np.asarray(np.asarray(self.center_m) + offset)

    @property
    def speed_bound_m_s(self) -> float:
        """Largest speed at any time."""
        return abs(self.rate_rad_s) * self.radius_m


@functools.lru_cache(maxsize=4096)  # an episode asks for every obstacle at every step
def _plane(normal: Point) -> tuple[FloatArray, FloatArray]:
    """Unit vectors e1 and e2 that span the plane with this normal, right-handed about it."""
    axis = np.asarray(normal) / np.linalg.norm(normal)
    # Any vector not along the axis gives a first direction; the smallest component is the safest choice.
    helper = np.eye(3)[int(np.argmin(np.abs(axis)))]
    e1 = np.cross(axis, helper)
    e1 /= np.linalg.norm(e1)
    return e1, np.cross(axis, e1)


class Line(BaseModel):
    """A straight line run at constant velocity, at every time: it comes from afar and goes on for ever."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    kind: Literal["line"] = "line"
    point_m: Point = Field(description="where the centre is at t = 0")
    velocity_m_s: Point

    def position(self, times_s: FloatArray) -> FloatArray:
        """Centre at each time: (T,) [s] -> (T, 3) [m]."""
        return np.asarray(np.asarray(self.point_m) + np.outer(times_s, self.velocity_m_s))

    @property
    def speed_bound_m_s(self) -> float:
        """Speed at every time."""
        return float(np.linalg.norm(self.velocity_m_s))


class Wave(BaseModel):
    """One term of a ``Wander``: to and fro along a direction, ``amplitude * sin(phase + rate * t)``."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    amplitude_m: Point
    rate_rad_s: Finite
    phase_rad: Finite


class Wander(BaseModel):
    """A smooth wandering about ``center``: the sum of a few waves, each along a direction of its own."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    kind: Literal["wander"] = "wander"
    center_m: Point
    waves: tuple[Wave, ...] = Field(min_length=1, max_length=8)

    def position(self, times_s: FloatArray) -> FloatArray:
        """Centre at each time: (T,) [s] -> (T, 3) [m]."""
        rates = np.array([wave.rate_rad_s for wave in self.waves])
        phases = np.array([wave.phase_rad for wave in self.waves])
        amplitudes = np.array([wave.amplitude_m for wave in self.waves])
        return np.asarray(np.asarray(self.center_m) + np.sin(phases + np.outer(times_s, rates)) @ amplitudes)

    @property
    def speed_bound_m_s(self) -> float:
        """Largest speed at any time, whatever the phases are.

        The velocity is a sum of c_i * rate_i * amplitude_i with every c_i in [-1, 1]. Its length is convex in the c_i,
        so it is largest where all are 1 or -1; one of them may be fixed, since signs can be swapped together.
        """
        peaks = np.array([np.multiply(wave.amplitude_m, wave.rate_rad_s) for wave in self.waves])
        signs = [(1.0, *others) for others in itertools.product((1.0, -1.0), repeat=len(peaks) - 1)]
        return float(np.linalg.norm(np.array(signs) @ peaks, axis=1).max())


class Still(BaseModel):
    """A body that stays where it is."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    kind: Literal["still"] = "still"
    point_m: Point

    def position(self, times_s: FloatArray) -> FloatArray:
        """Centre at each time: (T,) [s] -> (T, 3) [m]."""
        return np.tile(np.asarray(self.point_m), (len(times_s), 1))

    @property
    def speed_bound_m_s(self) -> float:
        """It never moves."""
        return 0.0


class Track(BaseModel):
    """A recorded motion: straight between timed points, at rest before the first and after the last.

    In a gap nobody saw it: sensors report nothing there, and what is true is the straight way across.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    kind: Literal["track"] = "track"
    times_s: tuple[Finite, ...] = Field(min_length=1, max_length=100_000)
    positions_m: tuple[Point, ...] = Field(min_length=1, max_length=100_000)
    gaps_s: tuple[tuple[Finite, Finite], ...] = Field(
        default=(), max_length=100_000, description="from when to when it is unseen, ends not included"
    )

    @model_serializer(mode="wrap")
    def _without_no_gaps(self, write: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Tracks from before there were gaps keep the hash of their content."""
        fields: dict[str, Any] = write(self)
        if not self.gaps_s:
            del fields["gaps_s"]
        return fields

    @model_validator(mode="after")
    def _is_a_function_of_time(self) -> "Track":
        if len(self.times_s) != len(self.positions_m):
            raise ValueError(f"times_s has {len(self.times_s)} entries, positions_m has {len(self.positions_m)}")
        if (np.diff(self.times_s) <= 0).any():
            raise ValueError("times_s must increase strictly")
        ends = np.array(self.gaps_s, dtype=np.float64).reshape(-1)
        if (np.diff(ends)[::2] <= 0).any() or (np.diff(ends) < 0).any():
            raise ValueError("gaps_s must be intervals in increasing order that do not overlap")
        return self

    def unseen(self, times_s: FloatArray) -> npt.NDArray[np.bool_]:
        """Which of the times (T,) [s] are in a gap: (T,)."""
        ends = np.array(self.gaps_s, dtype=np.float64).reshape(-1)
        times = np.asarray(times_s, dtype=np.float64)
        return np.asarray((ends.searchsorted(times, "left") % 2 == 1) & ~np.isin(times, ends))

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


Motion = Annotated[Orbit | Line | Wander | Still | Track, Field(discriminator="kind")]
