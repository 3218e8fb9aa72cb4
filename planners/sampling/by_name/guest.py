"""One of OMPL's planners, used as its treatment says."""

from collections.abc import Callable
from typing import ClassVar, Self

import numpy as np
from ompl import base as ob
from pydantic import Field, model_validator

from planners.problem import SpaceTimeProblem, TimedPath
from planners.problem.goals import OneGoal
from planners.sampling.by_name.arrivals import Arrivals, free_times
from planners.sampling.by_name.direction import LEISURE, DirectedSampler, DirectedValidator, Part
from planners.sampling.by_name.duration import Duration
from planners.sampling.by_name.projection import TipProjection
from planners.sampling.by_name.setters import bound_planners, fresh_planner, setters_of
from planners.sampling.by_name.treatment import TREATMENTS, Treatment
from planners.sampling.trees import AttemptSettings, SpaceTimeTree
from scenarios.arm import FloatArray


class GuestSettings(AttemptSettings):
    """Settings that all of OMPL's planners share; each model derived from it adds what OMPL lets one set."""

    guest: ClassVar[str] = ""
    """Name of the planner's class in OMPL."""

    arrivals: int = Field(default=10, ge=1, le=100, description="times at which a goal configuration is offered")

    @model_validator(mode="after")
    def _ask_ompl(self) -> Self:
        """Refuse what OMPL itself refuses."""
        planner = fresh_planner(self.guest)
        try:
            apply(self, planner)
            planner.setup()
        except RuntimeError as refused:
            raise ValueError(f"OMPL says: {' '.join(str(refused).split())}") from None
        return self


class ProjectedSettings(GuestSettings):
    """Settings of planners that look at a projection of where they have been."""

    cell_m: float = Field(default=0.3, ge=0.001, le=10, description="side of the cells of tip positions [m]")


def apply(settings: GuestSettings, planner: ob.Planner) -> None:
    """Set on a fresh planner what is to be otherwise than OMPL has it."""
    wanted = {setter: getattr(settings, setter.key, setter.default) for setter in setters_of(settings.guest)}
    for setter, value in wanted.items():
        if value != setter.default:
            setter.set(planner, value)


class GuestPlanner(SpaceTimeTree):
    """Plans with a planner of OMPL's, attempt after attempt; gives no path that the shared validator refuses."""

    guest: ClassVar[str] = ""
    """Name of the planner's class in OMPL."""

    def __init__(self, problem: SpaceTimeProblem, settings: GuestSettings) -> None:
        """Plan on ``problem``."""
        tree = bound_planners()[self.guest](problem.si)
        super().__init__(problem, settings, tree)
        self._arrivals, self._treatment = settings.arrivals, TREATMENTS.get(self.guest, Treatment())
        if isinstance(settings, ProjectedSettings):
            tree.setProjectionEvaluator(TipProjection(problem, settings.cell_m))
        apply(settings, tree)
        self._validator = DirectedValidator(problem.si, problem.validator)
        problem.si.setMotionValidator(self._validator)

    def search(self, q: FloatArray, now_s: float, stop: Callable[[], bool]) -> TimedPath | None:
        """The first path to the goal; else the one that leads nearest to it."""
        spent = False

        def latched() -> bool:
            """Planners ask again on their way out; the budget is asked once."""
            nonlocal spent
            spent = spent or stop()
            return spent

        return super().search(q, now_s, latched)

    def attempt(
        self, q: FloatArray, now_s: float, goal: FloatArray, earliest_s: float, stop: Callable[[], bool]
    ) -> TimedPath | None:
        """A path of OMPL's, if it starts where the arm is and every motion of it is valid."""
        found = super().attempt(q, now_s, goal, earliest_s, stop)
        if found is None or len(found.times_s) < 2:
            return None
        times, path = found.times_s, found.configurations_rad
        if times[0] != now_s or not np.array_equal(path[0], q):
            return None
        check = self.problem.validator.check
        valid = all(check(path[k], times[k], path[k + 1], times[k + 1]) for k in range(len(times) - 1))
        return found if valid else None

    def pose(
        self, q: FloatArray, now_s: float, goal: FloatArray, earliest_s: float, latest_s: float
    ) -> ob.ProblemDefinition | None:
        """The goal configuration at the times at which it is free; None if it never is."""
        problem, rng = self.problem, self.getProblemDefinition().getGoal().rng
        first_s = min(now_s + LEISURE * (earliest_s - now_s), latest_s)
        times = free_times(problem, goal, np.linspace(first_s, latest_s, self._arrivals))
        if not times:
            return None
        definition = problem.definition(q, now_s, OneGoal(goal), rng, latest_s)
        definition.setGoal(Arrivals(problem, (q, now_s), goal, times, rng))
        if not self._treatment.own_objective:
            definition.setOptimizationObjective(Duration(problem))
        low, high = self.box(q, goal)
        part = Part(
            problem.query.arm, self._treatment.two_trees, rng, low, high, now_s, latest_s, [float(x) for x in goal]
        )
        self._validator.part, checker = part, problem.checker
        problem.si.setValidStateSamplerAllocator(lambda si: DirectedSampler(si, checker, part))
        self._tree.clear()
        return definition
