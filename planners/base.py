"""What the house's own planners share: they are OMPL planners, and all they write is a search."""

from abc import abstractmethod
from collections.abc import Callable

from ompl import base as ob

from planners.problem import SpaceTimeProblem, TimedPath, read_state, write_path
from scenarios.arm import FloatArray


class ArmPlanner(ob.Planner):
    """An ``ompl.base.Planner`` whose ``search`` works on arrays; OMPL states are touched at the ends only."""

    def __init__(self, problem: SpaceTimeProblem, name: str) -> None:
        """Plan on ``problem``; ``name`` is the name OMPL reports."""
        super().__init__(problem.si, name)
        self.problem = problem
        self.state_checks = 0
        """Configurations checked by this planner's own kernels, beside those the shared checker counts."""
        self.motion_checks = 0
        """Motions checked by this planner's own kernels, beside those the shared validator counts."""

    @abstractmethod
    def search(self, q: FloatArray, now_s: float, stop: Callable[[], bool]) -> TimedPath | None:
        """Find a timed path from configuration ``q`` (dof,) [rad] at ``now_s`` [s]; None when there is none.

        ``stop`` says that the budget is spent; a search asks it between its own bounded pieces of work.
        """

    def solve(self, ptc: ob.PlannerTerminationCondition) -> ob.PlannerStatus:
        """Run ``search`` from the problem's start state and hand its path to OMPL."""
        start = self.getPlannerInputStates().nextStart()
        if start is not None:
            q, now_s = read_state(start, self.problem.query.arm.dof)
        elif self.problem.start is not None:
            # OMPL refuses a start in collision. But this is where the arm is: obstacles grown by a margin or misplaced
            # by noise may reach there, and it has to get out.
            q, now_s = self.problem.start
        else:
            return ob.PlannerStatus(ob.PlannerStatus.INVALID_START)
        if ptc():
            return ob.PlannerStatus(ob.PlannerStatus.TIMEOUT)
        found = self.search(q, now_s, ptc)
        if found is None:
            return ob.PlannerStatus(ob.PlannerStatus.TIMEOUT if ptc() else ob.PlannerStatus.INFEASIBLE)
        path = write_path(self.problem.si, found)
        distance = self.problem.query.goal_distance(found.configurations_rad[-1])
        reached = distance <= self.problem.query.goal_tolerance_m
        # Without its name OMPL books the path under "Unknown".
        self.getProblemDefinition().addSolutionPath(path, not reached, distance, self.getName())
        return ob.PlannerStatus(ob.PlannerStatus.EXACT_SOLUTION if reached else ob.PlannerStatus.APPROXIMATE_SOLUTION)
