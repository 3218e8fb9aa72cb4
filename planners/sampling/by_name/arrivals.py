"""The goal of an attempt: one configuration at a few times."""

from collections.abc import Sequence

import numpy as np
from ompl import base as ob

from planners.problem import SpaceTimeProblem, TipGoal, write_state
from planners.problem.goals import OneGoal
from scenarios.arm import FloatArray


class Arrivals(TipGoal):
    """A goal configuration, offered at each of some times at which it is free.

    Planners that take all goal states at once ask for as many as there are; FMT must not be given none.
    """

    def __init__(
        self,
        problem: SpaceTimeProblem,
        start: tuple[FloatArray, float],
        goal: FloatArray,
        times_s: Sequence[float],
        rng: np.random.Generator,
    ) -> None:
        """Offer ``goal`` (dof,) [rad] at ``times_s`` [s], in turn."""
        super().__init__(problem.si, problem.query, OneGoal(goal), start, times_s[-1], rng)
        self._goal, self._times_s = goal, times_s
        self._offered = 0

    def sampleGoal(self, state: ob.State) -> None:
        """Write the next of the arrivals."""
        write_state(state, self._goal, self._times_s[self._offered % len(self._times_s)])
        self._offered += 1

    def maxSampleCount(self) -> int:
        """How many there are."""
        return len(self._times_s)

    def couldSample(self) -> bool:
        """There is one at least."""
        return True


def free_times(problem: SpaceTimeProblem, goal: FloatArray, times_s: FloatArray) -> list[float]:
    """Those of ``times_s`` (k,) [s] at which ``goal`` (dof,) [rad] is free."""
    state, free = problem.si.allocState(), []
    for time_s in times_s.tolist():
        write_state(state, goal, time_s)
        if problem.checker.isValid(state):
            free.append(time_s)
    return free
