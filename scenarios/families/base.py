"""A family of scenarios, and what families share: drawing an arm's start and goal, and directions."""

from abc import ABC, abstractmethod
from typing import NamedTuple

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from scenarios.arm import ContinuumArm, FloatArray
from scenarios.obstacle import Obstacle

CUBE_M = 0.01
"""Edge of the paper's workspace cubes; goals stand at their centres."""


class Problem(NamedTuple):
    """What a family draws: start configuration (dof,) [rad], goal point (3,) [m], obstacles."""

    start: FloatArray
    goal: FloatArray
    obstacles: tuple[Obstacle, ...]


class Family(BaseModel, ABC):
    """A way to draw problems; its fields are the ranges drawn from."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    redraw: bool = Field(default=True, description="whether a draw whose start is hit is drawn anew")

    @abstractmethod
    def draw(self, rng: np.random.Generator, arm: ContinuumArm, n_obstacles: int) -> Problem:
        """Draw start, goal and obstacles."""


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
