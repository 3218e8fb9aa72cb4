"""The one motion validator. OMPL: callbacks must return a real ``bool`` and not hold the ``SpaceInformation``."""

import numpy as np
from ompl import base as ob

from planners.problem import _kernels
from planners.problem.query import Query
from planners.problem.states import read_state
from scenarios.arm import FloatArray
from scenarios.collision import CONTACT_TOLERANCE_M
from scenarios.world import make_world

_NOTHING = make_world(0.0, 1.0, np.empty((2, 0, 3)), np.empty(0))
"""A world without obstacles."""


class SpaceTimeMotionValidator(ob.MotionValidator):
    """The one motion validator: forward in time, within the arm's rates, collision-free at every instant."""

    def __init__(self, si: ob.SpaceInformation, query: Query) -> None:
        """Check motions against ``query``, which may be replaced at every solve."""
        super().__init__(si)
        self.query = query
        self.checks = 0

    def checkMotion(self, start: ob.State, end: ob.State) -> bool:
        """Whether the motion, linear in bending vectors, is possible and free under the prediction."""
        if not end[1].position > start[1].position:  # half of what a tree proposes: refused unread
            self.checks += 1
            return False
        dof = self.query.arm.dof
        return self.check(*read_state(start, dof), *read_state(end, dof))

    def check(self, q0: FloatArray, t0_s: float, q1: FloatArray, t1_s: float) -> bool:
        """The same on arrays (dof,) [rad] and times [s]; one compiled call, unless shapes have to decide."""
        self.checks += 1
        query = self.query
        if _kernels.motion_valid(q0, t0_s, q1, t1_s, *self._limits(), query.world):
            return True
        if query.shapes is None or not _kernels.motion_valid(q0, t0_s, q1, t1_s, *self._limits(), _NOTHING):
            return False
        return query.shapes.is_motion_valid(query.arm, q0, t0_s, q1, t1_s)

    def _limits(self) -> tuple[float, ...]:
        """The arm and the tolerance, as the kernels take them."""
        arm = self.query.arm
        return (
            arm.section_length_m, arm.radius_m, arm.max_bend_rad,
            arm.max_bend_rate_rad_s, arm.max_tip_speed_m_s, CONTACT_TOLERANCE_M,
        )  # fmt: skip
