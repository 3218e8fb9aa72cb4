"""NewPlanner: straight ways to the goal.

One class is a planner. The suite makes an instance for each trial and calls ``search`` whenever ``commitment`` says so.

What it is given:
    self.settings             an instance of ``settings_model``, from NewPlanner[speed=0.5]
    self.problem.query        the arm, the goal point and the obstacles as predicted
    self.problem.validator    says whether a motion is forward in time, within the arm's rates, and free
    self.goal                 configurations with the tip at the goal, and ``rng``, seeded by the trial

What it promises:
    A path starts at ``q`` and ``now_s``, its times increase, and between two states it is linear in bending vectors.
    No path is None, never an exception.
    ``stop()`` is asked between pieces of work. Random numbers come from ``self.goal.rng`` alone.
    What it is given stays as it is.

A configuration has two numbers for each section, its bending vector [rad]; whatever lies between two configurations
that the arm allows is allowed as well. So among no obstacles the straight way to any goal configuration is a path.
"""

from collections.abc import Callable

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from planners import ArmPlanner, TimedPath
from scenarios.arm import FloatArray

MOTIONS = 60
"""A straight way is cut into so many motions, each with a speed of its own."""


class NewPlannerSettings(BaseModel):
    """Settings; every field is a key in ``NewPlanner[key=value]``."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    speed: float = Field(default=0.9, gt=0, le=0.95, description="share of the arm's largest speeds that is used")


class NewPlanner(ArmPlanner):
    """Takes the first straight way to the goal that is free; else, to get away, the one that is free for longest."""

    settings_model = NewPlannerSettings
    summary = "straight ways to the goal, the soonest that is free"
    source = "yours"
    commitment = "while_valid"  # asked again when the newest prediction says that its path is no longer free
    horizon_s = 120.0  # how far ahead it is given a prediction
    prediction_margin = 1.0  # obstacles are grown by so many standard deviations of what is predicted

    def search(self, q: FloatArray, now_s: float, stop: Callable[[], bool]) -> TimedPath | None:
        """A free way to the goal, or what is free of another; None when there is nothing, and the arm holds still."""
        goals, earliest_s = self.goal.reachable
        longest: TimedPath | None = None
        for k in np.argsort(earliest_s):
            if stop():
                break
            way = self._timed(np.linspace(q, goals[k], MOTIONS + 1), now_s)
            free = self._free_part(way)
            if len(free.times_s) == len(way.times_s):
                return way
            if len(free.times_s) > 1 and (longest is None or free.times_s[-1] > longest.times_s[-1]):
                longest = free
        return longest

    def _timed(self, way: FloatArray, now_s: float) -> TimedPath:
        """Give every motion of a way (k, dof) [rad] the time that its bends and the tip need."""
        arm = self.problem.query.arm
        bends = np.diff(way, axis=0)
        bends_rad = np.hypot(bends[:, 0::2], bends[:, 1::2]).max(axis=1)
        tip_m = np.linalg.norm(np.diff(arm.tips(way), axis=0), axis=1)
        needed_s = np.maximum(bends_rad / arm.max_bend_rate_rad_s, tip_m / arm.max_tip_speed_m_s)
        lasting_s = np.maximum(needed_s / self.settings.speed, 1e-3)  # times increase, even where nothing moves
        return TimedPath(now_s + np.concatenate([[0.0], np.cumsum(lasting_s)]), way)

    def _free_part(self, way: TimedPath) -> TimedPath:
        """The way until the first motion that the shared validator refuses, and no further than is predicted."""
        check, times, states = self.problem.validator.check, way.times_s, way.configurations_rad
        k = 0
        while (
            k + 1 < len(times)
            and times[k + 1] <= times[0] + self.horizon_s
            and check(states[k], times[k], states[k + 1], times[k + 1])
        ):
            k += 1
        return TimedPath(times[: k + 1], states[: k + 1])
