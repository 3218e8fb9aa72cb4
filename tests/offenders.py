"""Planners that break one promise each; importable by their module's name, so that other processes find them."""

import itertools
import os

import numpy as np
from ompl import base as ob
from pydantic import Field

from planners import TimedPath
from suite.scaffold.new_planner import NewPlanner, NewPlannerSettings

_CALLS = itertools.count()


class NoSummary(NewPlanner):
    summary = ""


class TwoLines(NewPlanner):
    summary = "one\ntwo"


class UnknownCommitment(NewPlanner):
    commitment = "steps"


class UnknownPredictor(NewPlanner):
    predictor = "crystal ball"


class EndlessHorizon(NewPlanner):
    horizon_s = float("inf")


class NoStep(NewPlanner):
    prediction_step_s = 0.0


class NegativeMargin(NewPlanner):
    prediction_margin = -1.0


class NoBound(NewPlanner):
    largest_bound_m = 0.0


class Undescribed(NewPlanner):
    class settings_model(NewPlannerSettings):
        gain: float = 1.0


class DefaultPastItsLimit(NewPlanner):
    class settings_model(NewPlannerSettings):
        gain: float = Field(default=2.0, le=1.0, description="gain")


class Required(NewPlanner):
    class settings_model(NewPlannerSettings):
        gain: float = Field(description="gain")


class UnreadableDefault(NewPlanner):
    class settings_model(NewPlannerSettings):
        gains: tuple[float, ...] = Field(default=(1.0,), description="gains")


class FindsNothing(NewPlanner):
    def search(self, q, now_s, stop):
        return None


class NotANumber(NewPlanner):
    def search(self, q, now_s, stop):
        return TimedPath(now_s + np.arange(2.0), np.stack([q, q * np.nan]))


class OneState(NewPlanner):
    def search(self, q, now_s, stop):
        return TimedPath(np.array([now_s]), q[None])


class StartsElsewhere(NewPlanner):
    def search(self, q, now_s, stop):
        return super().search(q + 0.01, now_s, stop)


class StartsLater(NewPlanner):
    def search(self, q, now_s, stop):
        return super().search(q, now_s + 0.5, stop)


class StandsStillInTime(NewPlanner):
    def search(self, q, now_s, stop):
        return TimedPath(np.full(2, now_s), np.stack([q, q]))


class ClaimsTooMuch(NewPlanner):
    def solve(self, ptc):
        super().solve(ptc)
        return ob.PlannerStatus(ob.PlannerStatus.EXACT_SOLUTION)

    def search(self, q, now_s, stop):
        return TimedPath(now_s + np.arange(2.0), np.stack([q, q]))


class ClaimsWithoutAPath(ClaimsTooMuch):
    def search(self, q, now_s, stop):
        return None


class Blind(NewPlanner):
    def _free_part(self, way):
        return way


class TooFast(NewPlanner):
    def search(self, q, now_s, stop):
        path = super().search(q, now_s, stop)
        return path and TimedPath(now_s + 0.8 * (path.times_s - now_s), path.configurations_rad)


class StaysInThePast(NewPlanner):
    def search(self, q, now_s, stop):
        self._first = getattr(self, "_first", None) or super().search(q, now_s, stop)
        return self._first


class OtherEveryTime(NewPlanner):
    def search(self, q, now_s, stop):
        return TimedPath(now_s + np.array([0.0, 1.0 + next(_CALLS)]), np.stack([q, q]))


class Uncounted(NewPlanner):
    def search(self, q, now_s, stop):
        self.state_checks += next(_CALLS)
        return super().search(q, now_s, stop)


class MovesTheGoal(NewPlanner):
    def search(self, q, now_s, stop):
        self.problem.query.goal_m[:] += 0.001
        return super().search(q, now_s, stop)


class MovesObstacles(NewPlanner):
    def search(self, q, now_s, stop):
        self.problem.query.world.centers_m[:] += 0.001
        return super().search(q, now_s, stop)


class GoesOnAsking(NewPlanner):
    def search(self, q, now_s, stop):
        for _ in range(20):
            stop()
        return super().search(q, now_s, stop)


class ReadsNoBudget(NewPlanner):
    class settings_model(NewPlannerSettings):
        iterations: int = Field(default=1000, ge=5, description="budget")

    def search(self, q, now_s, stop):
        self.state_checks += 1000
        return super().search(q, now_s, lambda: False)


class RaisesWhenLost(NewPlanner):
    def search(self, q, now_s, stop):
        if not len(self.goal.configurations):
            raise ValueError("no goal\nanywhere")
        return super().search(q, now_s, stop)


class GivesUpForGood(NewPlanner):
    has_given_up = False

    def search(self, q, now_s, stop):
        path = None if self.has_given_up else super().search(q, now_s, stop)
        self.has_given_up = path is None
        return path


class OtherInEveryProcess(NewPlanner):
    def search(self, q, now_s, stop):
        return TimedPath(now_s + np.array([0.0, 1.0 + os.getpid()]), np.stack([q, q]))


class StopsHalfWay(NewPlanner):
    def search(self, q, now_s, stop):
        path = None if now_s else super().search(q, now_s, stop)
        return path and TimedPath(path.times_s[:-9], path.configurations_rad[:-9])


class Hostile(NewPlanner):
    """Prints; hangs where the goal is out of reach, and takes its process down when told to stop."""

    class settings_model(NewPlannerSettings):
        hang: bool = Field(default=False, description="hangs without a goal")
        die: bool = Field(default=False, description="dies when told to stop")

    def search(self, q, now_s, stop):
        print("{}\n" * 100)  # noqa: T201
        if self.settings.die and stop():
            os._exit(3)
        while self.settings.hang and not len(self.goal.configurations):
            pass
        return super().search(q, now_s, stop)
