"""A family of scenarios, and what families share: drawing an arm's start and goal, and directions."""

from abc import ABC, abstractmethod
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from pydantic import BaseModel, ConfigDict

from scenarios.arm import ContinuumArm, FloatArray
from scenarios.obstacle import Obstacle
from scenarios.scenario import Scenario

CUBE_M = 0.01
"""Edge of the paper's workspace cubes; goals stand at their centres."""


class Problem(NamedTuple):
    """What a family draws: start configuration (dof,) [rad], goal point (3,) [m], obstacles."""

    start: FloatArray
    goal: FloatArray
    obstacles: tuple[Obstacle, ...]


class Family(BaseModel, ABC):
    """Where scenarios come from; its fields are its settings."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    @abstractmethod
    def scenarios(self, name: str, n_obstacles: int, trials: int, seed: int, arm: ContinuumArm) -> Iterator[Scenario]:
        """Scenarios number 0 to ``trials`` - 1, one after the other.

        Args:
            name: The family's own, for their ids.
            n_obstacles: Number of obstacles in each.
            trials: How many.
            seed: Seed of the experiment.
            arm: The arm.

        Raises:
            ScenarioError: There are none such.
        """


def random_configuration(rng: np.random.Generator, arm: ContinuumArm) -> FloatArray:
    """Bending vectors uniform over each section's disc of allowed bends, shape (dof,), [rad]."""
    bends = arm.max_bend_rad * np.sqrt(rng.uniform(size=arm.n_sections))
    planes = rng.uniform(0.0, 2.0 * np.pi, size=arm.n_sections)
    return arm.bending_from_arcs(np.stack([planes, bends], axis=1))


def random_direction(rng: np.random.Generator) -> FloatArray:
    """Unit vector (3,), uniform over the sphere."""
    vector = rng.normal(size=3)
    return np.asarray(vector / np.linalg.norm(vector))


def random_radius(rng: np.random.Generator) -> float:
    """Radius of a sphere [m]: 2 or 3 cm, the paper's two sizes."""
    return float(rng.choice([0.02, 0.03]))


def draw_problem(
    rng: np.random.Generator, arm: ContinuumArm, min_distance_m: float, max_distance_m: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Start configuration, its tip, and a goal at a cube's centre within the given distances of that tip.

    The goal's cube is that of a random configuration's tip, so an arm can be there.

    Raises:
        ValueError: No such pair turns up (the distances do not fit the arm).
    """
    for _ in range(10_000):
        start, other = random_configuration(rng, arm), random_configuration(rng, arm)
        tip, goal = arm.tips(np.stack([start, other]))
        goal = (np.floor(goal / CUBE_M) + 0.5) * CUBE_M
        if min_distance_m <= np.linalg.norm(goal - tip) <= max_distance_m:
            return start, tip, goal
    raise ValueError(f"found no tips {min_distance_m} to {max_distance_m} m apart, allowed distances within the arm")
