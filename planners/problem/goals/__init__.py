"""Configurations whose tip is at the goal: what trees in configuration space are grown towards."""

import functools
from typing import NamedTuple, Protocol

import numpy as np

from planners.problem.goals import _kernels
from scenarios.arm import ContinuumArm, FloatArray
from scenarios.families.base import random_configuration


class KnownGoals(Protocol):
    """Something that knows goal configurations."""

    @property
    def configurations(self) -> FloatArray:
        """Configurations (K, dof) [rad] with the tip at the goal."""


class OneGoal(NamedTuple):
    """A single goal configuration."""

    configuration: FloatArray
    """Shape (dof,), [rad]."""

    @property
    def configurations(self) -> FloatArray:
        """The one, shape (1, dof), [rad]."""
        return self.configuration[None]


class GoalConfigurations:
    """Goal configurations of one trial, looked for when first asked for."""

    def __init__(
        self, arm: ContinuumArm, goal_m: FloatArray, tolerance_m: float, count: int, rng: np.random.Generator
    ) -> None:
        """Look for at most ``count`` configurations with the tip within ``tolerance_m`` of ``goal_m`` (3,) [m]."""
        self._arm, self._goal_m, self._tolerance_m = arm, goal_m, tolerance_m
        self._count, self._rng = count, rng

    @functools.cached_property
    def configurations(self) -> FloatArray:
        """Configurations (K <= count, dof) [rad], well within the tolerance; none when the goal is out of reach.

        The arm is redundant, so its goal is a surface of configurations: random ones are bent until their tip is there
        (damped least squares), which spreads them over that surface.
        """
        arm = self._arm
        starts = np.stack([random_configuration(self._rng, arm) for _ in range(self._count)])
        found, reached = _kernels.reach(
            starts, self._goal_m, 0.5 * self._tolerance_m, arm.section_length_m, arm.max_bend_rad
        )
        return np.ascontiguousarray(found[reached])
