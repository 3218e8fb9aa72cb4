"""A moving obstacle: a sphere or another convex shape on a law of motion."""

from typing import Any

import numpy as np
import numpy.typing as npt
from pydantic import BaseModel, ConfigDict, Field, SerializerFunctionWrapHandler, model_serializer, model_validator

from scenarios.motion import FloatArray, Motion, Track
from scenarios.shapes import Cover, Shape


def _bounding_radius(fields: dict[str, Any]) -> float:
    return float(fields["shape"].bounding_radius_m)


class Obstacle(BaseModel):
    """A convex body whose centre follows ``motion``: a sphere when given by ``radius_m``, else what ``shape`` says.

    ``radius_m`` then is the radius of a sphere about the centre that holds the shape; it is derived and not stored, so
    that whatever knows spheres only stays on the safe side.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    shape: Shape | None = None
    radius_m: float = Field(default_factory=_bounding_radius, gt=0, le=10.0, allow_inf_nan=False)
    motion: Motion

    @model_validator(mode="before")
    @classmethod
    def _has_one_shape(cls, fields: Any) -> Any:
        if isinstance(fields, dict) and (fields.get("shape") is None) == ("radius_m" not in fields):
            raise ValueError("an obstacle has either radius_m, for a sphere, or shape")
        return fields

    @model_serializer(mode="wrap")
    def _without_what_is_derived(self, write: SerializerFunctionWrapHandler) -> dict[str, Any]:
        fields: dict[str, Any] = write(self)
        del fields["shape" if self.shape is None else "radius_m"]
        return fields

    @property
    def cover(self) -> Cover:
        """Spheres about the centre that hold the obstacle: itself, if it is a sphere."""
        return self.shape.cover() if self.shape else Cover(np.zeros((1, 3)), np.array([self.radius_m]))

    def position(self, times_s: FloatArray) -> FloatArray:
        """Centre at each time: (T,) [s] -> (T, 3) [m]."""
        return self.motion.position(times_s)

    def unseen(self, times_s: FloatArray) -> npt.NDArray[np.bool_]:
        """At which times (T,) [s] no sensor sees it, because its record has a gap there: (T,)."""
        return self.motion.unseen(times_s) if isinstance(self.motion, Track) else np.zeros(len(times_s), dtype=bool)
