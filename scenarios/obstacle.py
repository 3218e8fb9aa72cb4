"""A moving obstacle: a sphere on a law of motion."""

from pydantic import BaseModel, ConfigDict, Field

from scenarios.motion import FloatArray, Motion


class Obstacle(BaseModel):
    """A sphere whose centre follows ``motion``."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    radius_m: float = Field(gt=0, le=10.0, allow_inf_nan=False)
    motion: Motion

    def position(self, times_s: FloatArray) -> FloatArray:
        """Centre at each time: (T,) [s] -> (T, 3) [m]."""
        return self.motion.position(times_s)
