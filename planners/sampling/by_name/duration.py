"""What planners that optimise are to keep short: time."""

import math

from ompl import base as ob

from planners.problem import SpaceTimeProblem


class Duration(ob.OptimizationObjective):
    """Time that passes, and time that bending takes at full rate: of two paths that arrive together, the straighter.

    Motions that are backward in time or too fast cost infinitely much, in heuristics too: with this objective RRT*
    rewires in one direction only, and informed samplers draw from what can be reached. OMPL's own path length knows no
    direction, and its informed samplers refuse a space with time.
    """

    def __init__(self, problem: SpaceTimeProblem) -> None:
        """Measure motions of ``problem``'s arm."""
        super().__init__(problem.si)
        arm = problem.query.arm
        self._dof, self._rate = arm.dof, arm.max_bend_rate_rad_s * math.sqrt(arm.n_sections)

    def isSymmetric(self) -> bool:
        """There is no way back."""
        return False

    def stateCost(self, state: ob.State) -> ob.Cost:
        """None."""
        del state
        return ob.Cost(0.0)

    def motionCost(self, start: ob.State, end: ob.State) -> ob.Cost:
        """Duration of a motion, twice where it is as fast as can be [s]."""
        duration_s = end[1].position - start[1].position
        before, after = start[0], end[0]
        bending_s = math.hypot(*(after[i] - before[i] for i in range(self._dof))) / self._rate
        return ob.Cost(math.inf if bending_s > duration_s * (1.0 + 1e-9) else duration_s + bending_s)

    def motionCostHeuristic(self, start: ob.State, end: ob.State) -> ob.Cost:
        """The straight motion is the shortest."""
        return self.motionCost(start, end)

    def motionCostBestEstimate(self, start: ob.State, end: ob.State) -> ob.Cost:
        """The same."""
        return self.motionCost(start, end)

    def costToGo(self, state: ob.State, goal: ob.Goal) -> ob.Cost:
        """The least there is: none."""
        del state, goal
        return ob.Cost(0.0)
