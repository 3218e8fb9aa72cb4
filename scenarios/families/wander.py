"""Spheres that wander smoothly about points between the start and the goal tip: no circle, no line to fit."""

import numpy as np
from pydantic import Field

from scenarios.arm import ContinuumArm, FloatArray
from scenarios.families.base import Problem, draw_problem, random_direction, random_radius
from scenarios.families.drawing import DrawnFamily
from scenarios.motion import Wander, Wave
from scenarios.obstacle import Obstacle


class WanderFamily(DrawnFamily):
    """Ranges from which a scenario of the family is drawn."""

    min_distance_m: float = Field(default=0.15, ge=0, le=2, description="least distance from start to goal tip")
    max_distance_m: float = Field(default=0.60, gt=0, le=2, description="largest distance from start to goal tip")
    n_waves: int = Field(default=4, ge=1, le=8, description="number of waves of each obstacle's motion")
    min_scale_m: float = Field(default=0.06, ge=0, le=2, description="least root mean square distance from the point")
    max_scale_m: float = Field(default=0.15, gt=0, le=2, description="largest such distance")
    min_speed_m_s: float = Field(default=0.005, ge=0, le=1, description="least bound on an obstacle's speed")
    max_speed_m_s: float = Field(default=0.015, ge=0, le=1, description="largest such bound; none is ever faster")

    def draw(self, rng: np.random.Generator, arm: ContinuumArm, n_obstacles: int) -> Problem:
        """Draw start, goal and obstacles; radii are 2 or 3 cm."""
        start, start_tip, goal = draw_problem(rng, arm, self.min_distance_m, self.max_distance_m)
        obstacles = []
        for _ in range(n_obstacles):
            center = start_tip + rng.uniform() * (goal - start_tip)
            obstacles.append(Obstacle(radius_m=random_radius(rng), motion=self._wander(rng, center)))
        return Problem(start, goal, tuple(obstacles))

    def _wander(self, rng: np.random.Generator, center: FloatArray) -> Wander:
        """Waves of equal amplitude in random directions; no rate is more than four times another.

        Rates are drawn as they compare to one another, then scaled so that the speed bound is the one drawn.
        """
        amplitude = rng.uniform(self.min_scale_m, self.max_scale_m) * np.sqrt(2.0 / self.n_waves)
        directions = [tuple((amplitude * random_direction(rng)).tolist()) for _ in range(self.n_waves)]
        rates = rng.uniform(0.25, 1.0, size=self.n_waves)
        phases = rng.uniform(0.0, 2.0 * np.pi, size=self.n_waves)
        speed = rng.uniform(self.min_speed_m_s, self.max_speed_m_s)

        def wander(rates: FloatArray) -> Wander:
            terms = zip(directions, rates.tolist(), phases.tolist(), strict=True)
            waves = tuple(Wave(amplitude_m=a, rate_rad_s=r, phase_rad=p) for a, r, p in terms)
            return Wander(center_m=tuple(center.tolist()), waves=waves)

        bound = wander(rates).speed_bound_m_s
        return wander(rates * (speed / bound if bound > 0.0 else 0.0))
