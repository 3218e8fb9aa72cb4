"""Configurations whose tip is at the goal: what trees in configuration space are grown towards."""

import numpy as np

from planners.goals import _kernels
from scenarios.arm import ContinuumArm, FloatArray
from scenarios.families.base import random_configuration


def goal_configurations(
    arm: ContinuumArm, goal_m: FloatArray, tolerance_m: float, count: int, rng: np.random.Generator
) -> FloatArray:
    """Configurations (K <= count, dof) [rad] with the tip well within ``tolerance_m`` of ``goal_m`` (3,) [m].

    The arm is redundant, so its goal is a surface of configurations: random ones are bent until their tip is there
    (damped least squares), which spreads the K over that surface. None may come back when the goal is out of reach.
    """
    starts = np.stack([random_configuration(rng, arm) for _ in range(count)])
    found, reached = _kernels.reach(starts, goal_m, 0.5 * tolerance_m, arm.section_length_m, arm.max_bend_rad)
    return np.ascontiguousarray(found[reached])
