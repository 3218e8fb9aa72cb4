"""What a planner is told about obstacles: where they were, once per step."""

from typing import NamedTuple

import numpy as np

from scenarios.arm import FloatArray


class Observation(NamedTuple):
    """Everything observed so far, oldest first; the last entry is the present."""

    times_s: FloatArray
    """Times, shape (r,), one step apart, [s]."""
    positions_m: FloatArray
    """Centres, shape (r, m, 3), [m]; NaN where an observation was lost."""
    radii_m: FloatArray
    """Radii, shape (m,), [m]."""


def without_gaps(observation: Observation) -> Observation:
    """Fill lost observations: straight between those around a gap, at the last known velocity after the last one."""
    lost = np.isnan(observation.positions_m[:, :, 0])
    if not lost.any():
        return observation
    times, positions = observation.times_s, observation.positions_m.copy()
    for j in np.flatnonzero(lost.any(axis=0)):
        seen = ~lost[:, j]
        known_times, known = times[seen], positions[seen, j]
        for k in range(3):
            positions[:, j, k] = np.interp(times, known_times, known[:, k])
        if len(known) > 1:
            velocity = (known[-1] - known[-2]) / (known_times[-1] - known_times[-2])
            late = times > known_times[-1]
            positions[late, j] = known[-1] + (times[late] - known_times[-1])[:, None] * velocity
    return observation._replace(positions_m=positions)
