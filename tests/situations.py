"""An arm among obstacles that crowd its way, for the searches of the paper's planners."""

import numpy as np
from strategies import ARM, random_configurations
from twins.cubes import is_free

from scenarios import SampledWorld, make_world

SPACING = 0.8  # 55 bends: most cubes hold a configuration or none, so that closed cubes are common
LENGTH = ARM.section_length_m


def situation(seed: int, horizon: int, crowd: int = 5) -> tuple[np.ndarray, np.ndarray, SampledWorld]:
    """A free configuration, a goal two decimetres off, and obstacles crowding the way."""
    rng = np.random.default_rng(seed)
    while True:
        q, other = random_configurations(rng, 2)
        q, other = 0.8 * q, 0.8 * other
        tip, goal = ARM.tips([q, other])
        if np.linalg.norm(goal - tip) < 0.15:
            continue
        centers = tip + rng.normal(scale=0.06, size=(crowd, 3))
        drift = rng.uniform(-0.015, 0.015, size=(crowd, 3))
        steps = centers + np.arange(horizon + 1)[:, None, None] * drift
        if is_free(q, LENGTH, steps[0], np.full(crowd, 0.025 + ARM.radius_m)):
            return q, goal, make_world(0.0, 1.0, steps, np.full(crowd, 0.025))
