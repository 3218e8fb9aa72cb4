"""Spheres that come from afar, cross the way from start to goal on straight lines, and leave."""

import numpy as np
from pydantic import Field

from scenarios.arm import ContinuumArm
from scenarios.families.base import Problem, draw_problem, random_direction, random_radius
from scenarios.families.drawing import DrawnFamily
from scenarios.motion import Line
from scenarios.obstacle import Obstacle


class CrossingFamily(DrawnFamily):
    """Ranges from which a scenario of the family is drawn."""

    min_distance_m: float = Field(default=0.15, ge=0, le=2, description="least distance from start to goal tip")
    max_distance_m: float = Field(default=0.60, gt=0, le=2, description="largest distance from start to goal tip")
    max_miss_m: float = Field(default=0.05, ge=0, le=2, description="largest distance at which the way is passed")
    min_pass_s: float = Field(default=5.0, ge=0, le=3600, description="earliest time of passing")
    max_pass_s: float = Field(default=60.0, ge=0, le=3600, description="latest time of passing")
    min_speed_m_s: float = Field(default=0.005, ge=0, le=1, description="smallest obstacle speed")
    max_speed_m_s: float = Field(default=0.015, ge=0, le=1, description="largest obstacle speed")

    def draw(self, rng: np.random.Generator, arm: ContinuumArm, n_obstacles: int) -> Problem:
        """Draw start, goal and obstacles: near which point of the way each passes, when, whence and how fast."""
        start, start_tip, goal = draw_problem(rng, arm, self.min_distance_m, self.max_distance_m)
        obstacles = []
        for _ in range(n_obstacles):
            miss = rng.uniform(0.0, self.max_miss_m) * random_direction(rng)
            passed = start_tip + rng.uniform() * (goal - start_tip) + miss
            velocity = rng.uniform(self.min_speed_m_s, self.max_speed_m_s) * random_direction(rng)
            origin = passed - rng.uniform(self.min_pass_s, self.max_pass_s) * velocity
            motion = Line(point_m=tuple(origin.tolist()), velocity_m_s=tuple(velocity.tolist()))
            obstacles.append(Obstacle(radius_m=random_radius(rng), motion=motion))
        return Problem(start, goal, tuple(obstacles))
