"""The goal: where the tip is to be, whenever and in whatever shape it gets there."""

import functools

import numpy as np
from ompl import base as ob

from planners.problem import _kernels
from planners.problem.goals import KnownGoals
from planners.problem.query import Query
from planners.problem.states import read_state, write_state
from scenarios.arm import FloatArray


class TipGoal(ob.GoalSampleableRegion):
    """All states whose tip lies within the goal tolerance; samples known goal configurations at random arrivals."""

    def __init__(
        self,
        si: ob.SpaceInformation,
        query: Query,
        goals: KnownGoals,
        start: tuple[FloatArray, float],
        latest_s: float,
        rng: np.random.Generator,
    ) -> None:
        """Offer ``goals`` to planners that sample, arriving from ``start`` (q, time) no earlier than rates allow."""
        super().__init__(si)
        self._query = query
        self._goals = goals
        self._start = start
        self._latest_s = latest_s
        self.rng = rng
        # Strictly inside: the audit measures the same distance with other arithmetic.
        self.setThreshold(0.999 * query.goal_tolerance_m)

    def distanceGoal(self, state: ob.State) -> float:
        """Distance of the state's tip from the goal point [m]."""
        q, _ = read_state(state, self._query.arm.dof)
        return self._query.goal_distance(q)

    def sampleGoal(self, state: ob.State) -> None:
        """Write a goal configuration at an arrival time drawn between its earliest and the planning horizon."""
        configurations, earliest_s = self.reachable
        k = int(self.rng.integers(len(configurations)))
        write_state(state, configurations[k], self.rng.uniform(earliest_s[k], self._latest_s))

    def maxSampleCount(self) -> int:
        """As many as asked for, when there is a goal configuration at all."""
        return 1_000_000 if self.couldSample() else 0

    def couldSample(self) -> bool:
        """Whether a goal configuration is known."""
        return len(self.reachable[0]) > 0

    @property
    def configurations(self) -> FloatArray:
        """Goal configurations (K, dof) [rad], whether they can be reached in time or not."""
        return self._goals.configurations

    @functools.cached_property
    def reachable(self) -> tuple[FloatArray, FloatArray]:
        """Goal configurations (K, dof) [rad] that can be reached in time, and how early each can (K,) [s].

        Found out when first asked: many planners never sample the goal.
        """
        arm, (q, now_s) = self._query.arm, self._start
        earliest_s = now_s + _kernels.least_durations(
            q, self._goals.configurations, arm.section_length_m, arm.max_bend_rate_rad_s, arm.max_tip_speed_m_s
        )
        in_time = earliest_s < self._latest_s
        return self._goals.configurations[in_time], earliest_s[in_time]
