"""What a planner is: an OMPL planner that says of itself what the suite has to know, and writes a search."""

import math
from abc import abstractmethod
from collections.abc import Callable
from typing import Any, ClassVar, Literal

from ompl import base as ob
from pydantic import BaseModel, ConfigDict

from planners.problem import SpaceTimeProblem, TimedPath, TipGoal, read_state, write_path
from scenarios.arm import ContinuumArm, FloatArray

Commitment = Literal["path", "while_valid", "step"]
"""When a planner is asked again: at the end of its path (Algorithm 2), as soon as the newest prediction makes the rest
of its path invalid or that path does not lead to the goal, or at every step."""


class NoSettings(BaseModel):
    """Settings of a planner that has none."""

    model_config = ConfigDict(frozen=True, extra="forbid")


class ArmPlanner(ob.Planner):
    """An ``ompl.base.Planner`` whose ``search`` works on arrays; OMPL states are touched at the ends only.

    The class attributes are all that the suite asks of a planner: one class is a planner.
    """

    name: ClassVar[str] = ""
    """What it is called in specs and tables; the class's own name if empty."""
    settings_model: ClassVar[type[BaseModel]] = NoSettings
    """Its settings with types, defaults, limits and descriptions; every field is a key in ``name[key=value]``."""
    budget: ClassVar[tuple[str, ...]] = ()
    """Names of the settings, all numbers, that say how much it may spend: ``name[budget=0.1]`` gives it a tenth."""
    summary: ClassVar[str] = ""
    """What it does, in a line."""
    source: ClassVar[str] = ""
    """Where it comes from: authors, venue, year."""
    commitment: ClassVar[Commitment] = "step"
    """When it is asked again."""
    horizon_s: ClassVar[float] = 1.0
    """How far ahead it is given a prediction [s], unless its settings have a ``horizon_s``; see ``look_ahead_s``."""
    prediction_step_s: ClassVar[float] = 1.0
    """Spacing of the predicted positions it is given [s]."""
    prediction_margin: ClassVar[float] = 0.0
    """Obstacles are grown by this many standard deviations of their predicted position's error."""
    largest_bound_m: ClassVar[float] = math.inf
    """Standard deviations are taken for no more than this [m]."""
    predictor: ClassVar[str] = "cubic"
    """The predictor it works with unless a run asks for another."""
    is_bound: ClassVar[bool] = False
    """Sees the true future: shows what is possible and is never ranked."""
    is_reactive: ClassVar[bool] = False
    """Goes by where obstacles are now: among moving ones its paths need not be free of what is predicted."""

    settings: Any
    """What it was asked for with, an instance of ``settings_model``."""

    def __init__(self, problem: SpaceTimeProblem, settings: BaseModel) -> None:
        """Plan on ``problem``."""
        super().__init__(problem.si, self.known_as())
        self.problem = problem
        self.settings = settings
        self.state_checks = 0
        """Configurations checked by this planner's own kernels, beside those the shared checker counts."""
        self.motion_checks = 0
        """Motions checked by this planner's own kernels, beside those the shared validator counts."""

    @property
    def goal(self) -> TipGoal:
        """The goal of this solve: known goal configurations, how early each can be reached, and the trial's ``rng``."""
        goal: TipGoal = self.getProblemDefinition().getGoal()
        return goal

    @classmethod
    def known_as(cls) -> str:
        """Its name in specs and tables."""
        return cls.name or cls.__name__

    @classmethod
    def look_ahead_s(cls, settings: Any) -> float:
        """How far ahead it looks with ``settings`` [s]."""
        return float(getattr(settings, "horizon_s", cls.horizon_s))

    @classmethod
    def predictor_for(cls, asked: str | None) -> str:
        """Name of the predictor it works with when a run asks for ``asked``, or for each planner's own (None)."""
        return "truth" if cls.is_bound else asked or cls.predictor

    @classmethod
    def check_fit(cls, settings: Any, arm: ContinuumArm) -> None:
        """Refuse settings that do not fit ``arm``, before anything is built.

        Raises:
            ScenarioError: A table of this planner's would be too large.
        """

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


class ReplanningPlanner(ArmPlanner):
    """A planner of whole ways through a long prediction: asked again as soon as the newest one invalidates its path."""

    commitment: ClassVar[Commitment] = "while_valid"
    prediction_step_s = 0.25
    prediction_margin = 1.0
    largest_bound_m = 0.005
    """What is less certain will have been observed again by then."""
    predictor = "portfolio"
