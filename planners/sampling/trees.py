"""OMPL's random trees in space-time, grown towards one goal configuration after another.

A tree that samples all configurations and all times wastes nearly every check on motions that are backward in time or
too fast. So a solve is a series of short attempts, each at one goal configuration, the soonest to be reached first:
samples come from the box about start and goal, widened by a detour, and from the time until shortly after the earliest
arrival.
"""

import itertools
import math
from collections.abc import Callable

import numpy as np
from ompl import base as ob
from ompl import geometric as og
from pydantic import BaseModel, ConfigDict, Field

from planners.base import ReplanningPlanner
from planners.problem import SpaceTimeProblem, TimedPath, read_state
from planners.problem.goals import OneGoal
from scenarios.arm import FloatArray


class AttemptSettings(BaseModel):
    """Settings of a search in attempts."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    iterations: int = Field(default=1000, ge=1, le=10**9, description="budget of one solve, in samples")
    attempt: int = Field(
        default=50, ge=1, le=10**9, description="samples spent on a goal configuration before the next"
    )
    goals: int = Field(default=32, ge=1, le=1000, description="goal configurations tried, the soonest to be reached")
    detour_rad: float = Field(default=1.0, ge=0, le=10, description="widening of the box about start and goal")
    slack_s: float = Field(default=20.0, gt=0, le=3600, description="latest arrival tried, after the earliest possible")
    horizon_s: float = Field(default=90.0, gt=0, le=3600, description="latest arrival considered, from now")


class RangeSettings(BaseModel):
    """How far a tree grows at a time."""

    range: float = Field(
        default=1000.0, gt=0, le=1000, description="longest motion added to a tree, in space-time units"
    )


class TreeSettings(AttemptSettings, RangeSettings):
    """Settings that all trees share."""


class RRTSettings(TreeSettings):
    """Settings of ``rrt``."""

    goal_bias: float = Field(default=0.4, ge=0, le=1, description="share of samples drawn from the goal")


class SpaceTimeTree(ReplanningPlanner):
    """Lends one of OMPL's trees a goal and a part of space-time, attempt after attempt, until it has a path."""

    budget = ("iterations",)

    def __init__(self, problem: SpaceTimeProblem, settings: AttemptSettings, tree: ob.Planner) -> None:
        """Plan on ``problem`` with ``tree``, a planner on the same space."""
        super().__init__(problem, settings)
        self._settings, self._tree = settings, tree

    def search(self, q: FloatArray, now_s: float, stop: Callable[[], bool]) -> TimedPath | None:
        """The first path to the goal; else the one that leads nearest to it."""
        configurations, earliest_s = self.goal.reachable
        self._tree.clear()
        nearest, path = math.inf, None
        for k in itertools.cycle(np.argsort(earliest_s)[: self._settings.goals]):
            if stop():
                break
            found = self.attempt(q, now_s, configurations[k], float(earliest_s[k]), stop)
            distance = math.inf if found is None else self.problem.query.goal_distance(found.configurations_rad[-1])
            if distance < nearest:
                nearest, path = distance, found
            if nearest <= self.problem.query.goal_tolerance_m:
                break
        return path

    def attempt(
        self, q: FloatArray, now_s: float, goal: FloatArray, earliest_s: float, stop: Callable[[], bool]
    ) -> TimedPath | None:
        """Grow a tree towards one goal configuration (dof,) [rad]."""
        settings, problem = self._settings, self.problem
        latest_s = min(earliest_s + settings.slack_s, now_s + settings.horizon_s)
        problem.confine(*self.box(q, goal), now_s, latest_s)
        definition = self.pose(q, now_s, goal, earliest_s, latest_s)
        if definition is None:
            return None
        self._tree.setProblemDefinition(definition)
        self._tree.setup()
        left = iter(range(settings.attempt))
        self._tree.solve(ob.PlannerTerminationCondition(lambda: next(left, None) is None or stop()))
        if not definition.hasSolution():
            return None
        states = [read_state(state, len(q)) for state in definition.getSolutionPath().getStates()]
        return TimedPath(np.array([t for _, t in states]), np.array([configuration for configuration, _ in states]))

    def box(self, q: FloatArray, goal: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Corners (dof,) [rad] of the box about ``q`` and ``goal`` (dof,) [rad], widened by the detour."""
        reach, detour = self.problem.query.arm.max_bend_rad, self._settings.detour_rad
        low, high = np.minimum(q, goal) - detour, np.maximum(q, goal) + detour
        return np.maximum(low, -reach), np.minimum(high, reach)

    def pose(
        self, q: FloatArray, now_s: float, goal: FloatArray, earliest_s: float, latest_s: float
    ) -> ob.ProblemDefinition | None:
        """What the tree is asked for in an attempt; None where there is nothing to ask for."""
        del earliest_s
        return self.problem.definition(q, now_s, OneGoal(goal), self.goal.rng, latest_s)


class RRTPlanner(SpaceTimeTree):
    """OMPL's RRT (LaValle 1998)."""

    name = "rrt"
    settings_model = RRTSettings
    summary = "OMPL's RRT in space-time, replanned when the prediction invalidates the path"
    source = "LaValle 1998"

    def __init__(self, problem: SpaceTimeProblem, settings: RRTSettings) -> None:
        """Plan on ``problem``."""
        tree = og.RRT(problem.si)
        tree.setRange(settings.range)
        tree.setGoalBias(settings.goal_bias)
        super().__init__(problem, settings, tree)


class RRTConnectPlanner(SpaceTimeTree):
    """OMPL's RRT-Connect (Kuffner and LaValle 2000); its goal tree grows backward in time."""

    name = "rrtconnect"
    settings_model = TreeSettings
    summary = "OMPL's RRT-Connect in space-time, replanned when the prediction invalidates the path"
    source = "Kuffner and LaValle, ICRA 2000"

    def __init__(self, problem: SpaceTimeProblem, settings: TreeSettings) -> None:
        """Plan on ``problem``."""
        tree = og.RRTConnect(problem.si)
        tree.setRange(settings.range)
        super().__init__(problem, settings, tree)
