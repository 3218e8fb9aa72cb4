"""What a planner is told about obstacles: where they were, once per step."""

from typing import NamedTuple

from scenarios.arm import FloatArray


class Observation(NamedTuple):
    """Everything observed so far, oldest first; the last entry is the present."""

    times_s: FloatArray
    """Times, shape (r,), one step apart, [s]."""
    positions_m: FloatArray
    """Centres, shape (r, m, 3), [m]."""
    radii_m: FloatArray
    """Radii, shape (m,), [m]."""
