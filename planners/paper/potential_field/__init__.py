"""The potential field planner (paper, section IV-C).

The tip is attracted to the goal, the body point nearest to each obstacle is repelled by it (Khatib 1986), and each
actuator is kept off the ends of its range (Ataka et al., ICRA 2016): velocities are mapped to bending rates by damped
pseudo-inverses of the position Jacobians and summed. The paper follows Godage et al., ICMA 2012, whose gains are not
published; these are ours.
"""

import math
from collections.abc import Callable

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from planners.base import ArmPlanner
from planners.paper.potential_field import _kernels
from planners.problem import SpaceTimeProblem, TimedPath
from scenarios.arm import FloatArray
from scenarios.scenario import STEP_S

SUBSTEPS = 10
"""Euler steps per second."""
PUSH_PER_TIP_SPEED = 10.0
"""The fastest push of an obstacle, by the speed at which the arm's tip may move."""


class PotentialFieldSettings(BaseModel):
    """Settings of ``pf``."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    attraction: float = Field(default=0.5, gt=0, le=100, description="gain of the goal's pull on the tip [1/s]")
    repulsion: float = Field(default=1e-7, ge=0, le=1, description="gain of an obstacle's push [m^4/s]")
    influence_m: float = Field(default=0.05, gt=0, le=1, description="clearance at which repulsion begins")
    limit_gain: float = Field(default=1e-3, ge=0, le=1, description="gain of the actuator-limit potential [rad^4/s]")
    limit_margin_rad: float = Field(default=0.3, gt=0, le=3, description="distance to an actuator limit that repels")


class PotentialFieldPlanner(ArmPlanner):
    """Greedy: one second along the field of the obstacles as they stand now; nothing is predicted or searched."""

    name = "pf"
    settings_model = PotentialFieldSettings
    summary = "potential field on the arm's body"
    source = "Godage et al., ICMA 2012; Ataka et al., ICRA 2016; paper, section IV-C"
    is_reactive = True

    def __init__(self, problem: SpaceTimeProblem, settings: PotentialFieldSettings) -> None:
        """Follow the field with the gains in ``settings``."""
        super().__init__(problem, settings)
        s = settings
        fastest_push = PUSH_PER_TIP_SPEED * problem.query.arm.max_tip_speed_m_s
        self._gains = (s.attraction, s.repulsion, s.influence_m, fastest_push, s.limit_gain, s.limit_margin_rad)

    def search(self, q: FloatArray, now_s: float, stop: Callable[[], bool]) -> TimedPath | None:
        """One step of Euler integration; the field always says something."""
        del stop  # one bounded step
        query, arm, world = self.problem.query, self.problem.query.arm, self.problem.query.world
        rates = (arm.max_bend_rate_rad_s, arm.max_tip_speed_m_s) if query.limits else (math.inf, math.inf)
        path = _kernels.follow_field(
            q, query.goal_m, world.centers_m[0], world.radii_m[0], arm.section_length_m, arm.radius_m,
            arm.max_bend_rad, *rates, STEP_S / SUBSTEPS, SUBSTEPS, self._gains,
        )  # fmt: skip
        return TimedPath(now_s + STEP_S / SUBSTEPS * np.arange(SUBSTEPS + 1, dtype=np.float64), path)
