"""The paper's scenarios (section V): spheres in orbit about points between the start and the goal tip."""

import numpy as np
from pydantic import Field

from scenarios.arm import ContinuumArm
from scenarios.families.base import Problem, draw_problem, random_direction, random_radius
from scenarios.families.drawing import DrawnFamily
from scenarios.motion import Orbit
from scenarios.obstacle import Obstacle


class OrbitFamily(DrawnFamily):
    """Ranges from which a scenario of the family is drawn; the defaults are the paper's."""

    min_distance_m: float = Field(default=0.15, ge=0, le=2, description="least distance from start to goal tip")
    max_distance_m: float = Field(default=0.60, gt=0, le=2, description="largest distance from start to goal tip")
    min_orbit_m: float = Field(default=0.06, ge=0, le=2, description="smallest orbit radius")
    max_orbit_m: float = Field(default=0.15, gt=0, le=2, description="largest orbit radius")
    max_speed_m_s: float = Field(default=0.015, ge=0, le=1, description="largest obstacle speed")

    def draw(self, rng: np.random.Generator, arm: ContinuumArm, n_obstacles: int) -> Problem:
        """Draw start, goal and obstacles; radii are 2 or 3 cm, speeds uniform and either way round."""
        start, start_tip, goal = draw_problem(rng, arm, self.min_distance_m, self.max_distance_m)
        obstacles = []
        for _ in range(n_obstacles):
            center = start_tip + rng.uniform() * (goal - start_tip)
            radius = rng.uniform(self.min_orbit_m, self.max_orbit_m)
            rate = rng.choice([-1.0, 1.0]) * rng.uniform(0.0, self.max_speed_m_s) / radius
            motion = Orbit(
                center_m=tuple(center.tolist()),
                radius_m=radius,
                normal=tuple(random_direction(rng).tolist()),
                rate_rad_s=rate,
                phase_rad=rng.uniform(0.0, 2.0 * np.pi),
            )
            obstacles.append(Obstacle(radius_m=random_radius(rng), motion=motion))
        return Problem(start, goal, tuple(obstacles))
