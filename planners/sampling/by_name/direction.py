"""Time has a direction, which most of OMPL's planners do not know.

A motion leads forward in time. A planner that grows a second tree from the goal and checks every motion outward from
its root would grow that tree into the goal's future; and one that samples near a state nearly always draws what can't
be reached from there in time. So a validator that knows the states of the goal's tree turns that tree's motions round,
and a sampler draws times that the arm's rates allow, after a state of the start's tree and before one of the goal's.
"""

from dataclasses import dataclass, field

import numpy as np
from ompl import base as ob

from planners.problem import SpaceTimeChecker, SpaceTimeMotionValidator, read_state, write_state
from planners.problem._kernels import least_duration
from scenarios.arm import ContinuumArm, FloatArray

LEISURE = 1.02
"""Motions take so much longer than the least: the shared validator measures the tip's speed on pieces over which it
varies by 2 %, so a motion as fast as it allows may be too fast at an instant."""
EARLY = 3
"""Times are drawn early in what the rates leave of an attempt: its share is a uniform number to this power."""


@dataclass
class Part:
    """The part of space-time that an attempt may use, and what the goal's tree has reached in it.

    It is shared by validator and sampler and holds no ``SpaceInformation``: a cycle through C++ would leak.
    """

    arm: ContinuumArm
    two_trees: bool
    """Whether the planner grows a tree from the goal whose motions it checks outward."""
    rng: np.random.Generator
    low: FloatArray
    """Corner of the box of configurations, shape (dof,), [rad]."""
    high: FloatArray
    from_s: float
    until_s: float
    goal: list[float]
    """The goal configuration [rad], root of the goal's tree at any time."""
    reached: set[float] = field(default_factory=set)
    """Times of the states of the goal's tree; they are random numbers, so a time names its state."""

    def is_of_goal(self, state: ob.State) -> bool:
        """Whether a state is of the goal's tree."""
        if not self.two_trees:
            return False
        return state[1].position in self.reached or [state[0][i] for i in range(self.arm.dof)] == self.goal


class DirectedValidator(ob.MotionValidator):
    """The shared motion validator, asked in the direction of time."""

    def __init__(self, si: ob.SpaceInformation, validator: SpaceTimeMotionValidator) -> None:
        """Check motions by ``validator``."""
        super().__init__(si)
        self._validator = validator
        self.part: Part | None = None

    def checkMotion(self, start: ob.State, end: ob.State) -> bool:
        """Whether the motion is possible and free: towards ``start`` where that is of the goal's tree."""
        part = self.part
        if part is None or not part.is_of_goal(start):
            return self._validator.checkMotion(start, end)
        valid = self._validator.checkMotion(end, start)
        if valid:
            part.reached.add(end[1].position)
        return valid


class DirectedSampler(ob.ValidStateSampler):
    """Draws valid states near others, at times that the arm's rates allow."""

    def __init__(self, si: ob.SpaceInformation, checker: SpaceTimeChecker, part: Part) -> None:
        """Draw in ``part``."""
        super().__init__(si)
        self._checker, self._part = checker, part

    def sample(self, state: ob.State) -> bool:
        """Draw anywhere; whether that is valid."""
        part = self._part
        write_state(state, part.rng.uniform(part.low, part.high), part.rng.uniform(part.from_s, part.until_s))
        return self._checker.isValid(state)

    def sampleNear(self, state: ob.State, near: ob.State, distance: float) -> bool:
        """Draw with every bend within ``distance`` [rad] of ``near``; whether that is valid."""
        part, arm = self._part, self._part.arm
        q, time_s = read_state(near, arm.dof)
        drawn = part.rng.uniform(np.maximum(part.low, q - distance), np.minimum(part.high, q + distance))
        backward = part.is_of_goal(near)
        start, end = (drawn, q) if backward else (q, drawn)
        needed_s = LEISURE * least_duration(
            start, end, arm.section_length_m, arm.max_bend_rate_rad_s, arm.max_tip_speed_m_s
        )
        left_s = (time_s - part.from_s if backward else part.until_s - time_s) - needed_s
        if left_s <= 0.0:
            return False
        duration_s = needed_s + left_s * part.rng.random() ** EARLY
        write_state(state, drawn, time_s - duration_s if backward else time_s + duration_s)
        return self._checker.isValid(state)
