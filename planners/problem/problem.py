"""The space-time planning problem that every planner receives through OMPL."""

import math

import numpy as np
from ompl import base as ob

from planners.problem.checker import SpaceTimeChecker
from planners.problem.goals import KnownGoals
from planners.problem.query import Query
from planners.problem.states import write_state
from planners.problem.tip_goal import TipGoal
from planners.problem.validator import SpaceTimeMotionValidator
from scenarios.arm import FloatArray


class SpaceTimeProblem:
    """One arm's ``SpaceInformation`` with the shared checker and validator; lives as long as a trial."""

    TIME_WEIGHT = 0.02

    def __init__(self, query: Query, horizon_s: float) -> None:
        """Build the time-augmented configuration space for ``query``'s arm."""
        arm = query.arm
        self.query = query
        self.horizon_s = horizon_s
        self._reach = np.full(arm.dof, arm.max_bend_rad)
        self.start: tuple[FloatArray, float] | None = None
        """Where the arm is in the latest definition: configuration (dof,) [rad] and time [s]."""
        # Every section turns at most at the bending rate, so the whole vector moves at most sqrt(n) times that.
        v_max = arm.max_bend_rate_rad_s * math.sqrt(arm.n_sections)
        self.space = ob.SpaceTimeStateSpace(ob.RealVectorStateSpace(arm.dof), v_max, self.TIME_WEIGHT)
        self.confine(-self._reach, self._reach, 0.0, horizon_s)
        self.si = ob.SpaceInformation(self.space)
        self.checker = SpaceTimeChecker(self.si, query)
        self.validator = SpaceTimeMotionValidator(self.si, query)
        self.si.setStateValidityChecker(self.checker)
        self.si.setMotionValidator(self.validator)
        self.si.setup()

    def update(self, query: Query, now_s: float) -> None:
        """Make every later check answer to ``query``; times may run from ``now_s`` to the horizon."""
        self.query = query
        self.checker.query = query
        self.validator.query = query
        self.confine(-self._reach, self._reach, now_s, now_s + self.horizon_s)

    def confine(self, low: FloatArray, high: FloatArray, from_s: float, until_s: float) -> None:
        """Let planners sample between ``low`` and ``high`` (dof,) [rad] and two times, until the next update."""
        bounds = ob.RealVectorBounds(len(low))
        for i in range(len(low)):
            bounds.setLow(i, float(low[i]))
            bounds.setHigh(i, float(high[i]))
        self.space.getSpaceComponent().setBounds(bounds)
        self.space.setTimeBounds(from_s, until_s)
        self.space.updateEpsilon()

    def definition(
        self,
        q: FloatArray,
        now_s: float,
        goals: KnownGoals,
        rng: np.random.Generator,
        latest_s: float | None = None,
    ) -> ob.ProblemDefinition:
        """Pose the solve: from ``q`` (dof,) [rad] at ``now_s`` [s] to the goal, which may be sampled at ``goals``.

        Arrivals are sampled up to ``latest_s``, the horizon when None.
        """
        self.start = (q, now_s)
        start = self.si.allocState()
        write_state(start, q, now_s)
        definition = ob.ProblemDefinition(self.si)
        definition.addStartState(start)
        until_s = now_s + self.horizon_s if latest_s is None else latest_s
        definition.setGoal(TipGoal(self.si, self.query, goals, (q, now_s), until_s, rng))
        return definition
