"""The space-time planning problem that every planner receives through OMPL.

One ``SpaceInformation`` over (configuration, time), one state validity checker, one motion validator and one goal. OMPL
facts behind the shape of this file: the checker and the validator must not hold the ``SpaceInformation`` (the cycle
leaks through C++), callbacks must return a real ``bool``, and an element-wise read is the cheapest way out of a state.
"""

import functools
import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from ompl import base as ob
from ompl import geometric as og

from planners import _kernels
from planners.goals import KnownGoals
from planners.prediction import Prediction
from scenarios.arm import ContinuumArm, FloatArray
from scenarios.collision import CONTACT_TOLERANCE_M
from scenarios.shaped_world import ShapedWorld
from scenarios.world import SampledWorld, make_world

_NOTHING = make_world(0.0, 1.0, np.empty((2, 0, 3)), np.empty(0))
"""A world without obstacles."""


class TimedPath(NamedTuple):
    """Timed states, linear in bending vectors between them."""

    times_s: FloatArray
    """Strictly increasing, shape (k,), [s]."""
    configurations_rad: FloatArray
    """Shape (k, dof), [rad]."""


class Query(NamedTuple):
    """What one solve is about, shared by the checker, the validator and the planners."""

    arm: ContinuumArm
    goal_m: FloatArray
    """Goal point of the tip, shape (3,), [m]."""
    goal_tolerance_m: float
    prediction: Prediction
    """The obstacles as predicted, with error bounds."""
    world: SampledWorld
    """The same for collision checks, grown by the margin that the planner's registry entry asks for: spheres that hold
    the obstacles, whatever their shapes are."""
    limits: bool
    """Whether planners whose paths may otherwise jump in shape must keep to what the motion validator allows."""
    shapes: ShapedWorld | None = None
    """The obstacles' own shapes, which decide where the spheres are hit; None where ``world`` is exact."""

    def goal_distance(self, q: FloatArray) -> float:
        """Distance of the tip at ``q`` (dof,) [rad] from the goal point [m]."""
        return float(_kernels.tip_distance(q, self.arm.section_length_m, self.goal_m))


def read_state(state: ob.State, dof: int) -> tuple[FloatArray, float]:
    """Copy (configuration (dof,) [rad], time [s]) out of an OMPL state."""
    return np.fromiter(map(state[0].__getitem__, range(dof)), np.float64, dof), float(state[1].position)


def write_state(state: ob.State, q: FloatArray, time_s: float) -> None:
    """Write a configuration (dof,) [rad] and a time [s] into an OMPL state."""
    state[0][0 : len(q)] = q.tolist()
    state[1].position = float(time_s)


def write_path(si: ob.SpaceInformation, timed: TimedPath) -> og.PathGeometric:
    """The same path in OMPL states. A state in one call: long paths were a tenth of the median solve."""
    path, state, write = og.PathGeometric(si), si.allocState(), si.getStateSpace().copyFromReals
    for reals in np.column_stack([timed.configurations_rad, timed.times_s]).tolist():
        write(state, reals)
        path.append(state)
    return path


class SpaceTimeChecker(ob.StateValidityChecker):
    """The one state validity checker: bends within limits and no contact at the state's time."""

    def __init__(self, si: ob.SpaceInformation, query: Query) -> None:
        """Check states against ``query``, which may be replaced at every solve."""
        super().__init__(si)
        self.query = query
        self.checks = 0

    def isValid(self, state: ob.State) -> bool:
        """Whether the state is free of the predicted obstacles."""
        return self.clearance(state) > 0.0

    def clearance(self, state: ob.State) -> float:
        """Signed distance to the nearest predicted obstacle [m], never overstated; -inf past the bending limit."""
        self.checks += 1
        arm, world = self.query.arm, self.query.world
        q, time_s = read_state(state, arm.dof)
        gap = float(_kernels.clearance(q, time_s, arm.section_length_m, arm.radius_m, arm.max_bend_rad, world))
        shapes = self.query.shapes
        return gap if shapes is None or gap > 0.0 or gap == -math.inf else shapes.clearance(arm, q, time_s)


class SpaceTimeMotionValidator(ob.MotionValidator):
    """The one motion validator: forward in time, within the arm's rates, collision-free at every instant."""

    def __init__(self, si: ob.SpaceInformation, query: Query) -> None:
        """Check motions against ``query``, which may be replaced at every solve."""
        super().__init__(si)
        self.query = query
        self.checks = 0

    def checkMotion(self, start: ob.State, end: ob.State) -> bool:
        """Whether the motion, linear in bending vectors, is possible and free under the prediction."""
        if not end[1].position > start[1].position:  # half of what a tree proposes: refused unread
            self.checks += 1
            return False
        dof = self.query.arm.dof
        return self.check(*read_state(start, dof), *read_state(end, dof))

    def check(self, q0: FloatArray, t0_s: float, q1: FloatArray, t1_s: float) -> bool:
        """The same on arrays (dof,) [rad] and times [s]; one compiled call, unless shapes have to decide."""
        self.checks += 1
        query = self.query
        if _kernels.motion_valid(q0, t0_s, q1, t1_s, *self._limits(), query.world):
            return True
        if query.shapes is None or not _kernels.motion_valid(q0, t0_s, q1, t1_s, *self._limits(), _NOTHING):
            return False
        return query.shapes.is_motion_valid(query.arm, q0, t0_s, q1, t1_s)

    def check_all(self, before: FloatArray, t0_s: float, after: FloatArray, t1_s: float) -> npt.NDArray[np.bool_]:
        """The same from each of ``before`` (A, dof) to each of ``after`` (B, dof), in one compiled call: (A, B).

        So many motions are checked against spheres that hold the obstacles, whatever their shapes are.
        """
        self.checks += len(before) * len(after)
        valid: npt.NDArray[np.bool_] = _kernels.motions_valid(
            before, t0_s, after, t1_s, *self._limits(), self.query.world
        )
        return valid

    def _limits(self) -> tuple[float, ...]:
        """The arm and the tolerance, as the kernels take them."""
        arm = self.query.arm
        return (
            arm.section_length_m, arm.radius_m, arm.max_bend_rad,
            arm.max_bend_rate_rad_s, arm.max_tip_speed_m_s, CONTACT_TOLERANCE_M,
        )  # fmt: skip


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


class SpaceTimeProblem:
    """One arm's ``SpaceInformation`` with the shared checker and validator; lives as long as a trial."""

    TIME_WEIGHT = 0.02

    def __init__(self, query: Query, horizon_s: float) -> None:
        """Build the time-augmented configuration space for ``query``'s arm."""
        arm = query.arm
        self.query = query
        self.horizon_s = horizon_s
        self._reach = np.full(arm.dof, arm.max_bend_rad)
        self.start: tuple[FloatArray, float] | None = None
        """Where the arm is in the latest definition: configuration (dof,) [rad] and time [s]."""
        # Every section turns at most at the bending rate, so the whole vector moves at most sqrt(n) times that.
        v_max = arm.max_bend_rate_rad_s * math.sqrt(arm.n_sections)
        self.space = ob.SpaceTimeStateSpace(ob.RealVectorStateSpace(arm.dof), v_max, self.TIME_WEIGHT)
        self.confine(-self._reach, self._reach, 0.0, horizon_s)
        self.si = ob.SpaceInformation(self.space)
        self.checker = SpaceTimeChecker(self.si, query)
        self.validator = SpaceTimeMotionValidator(self.si, query)
        self.si.setStateValidityChecker(self.checker)
        self.si.setMotionValidator(self.validator)
        self.si.setup()

    def update(self, query: Query, now_s: float) -> None:
        """Make every later check answer to ``query``; times may run from ``now_s`` to the horizon."""
        self.query = query
        self.checker.query = query
        self.validator.query = query
        self.confine(-self._reach, self._reach, now_s, now_s + self.horizon_s)

    def confine(self, low: FloatArray, high: FloatArray, from_s: float, until_s: float) -> None:
        """Let planners sample between ``low`` and ``high`` (dof,) [rad] and two times, until the next update."""
        bounds = ob.RealVectorBounds(len(low))
        for i in range(len(low)):
            bounds.setLow(i, float(low[i]))
            bounds.setHigh(i, float(high[i]))
        self.space.getSpaceComponent().setBounds(bounds)
        self.space.setTimeBounds(from_s, until_s)
        self.space.updateEpsilon()

    def definition(
        self,
        q: FloatArray,
        now_s: float,
        goals: KnownGoals,
        rng: np.random.Generator,
        latest_s: float | None = None,
    ) -> ob.ProblemDefinition:
        """Pose the solve: from ``q`` (dof,) [rad] at ``now_s`` [s] to the goal, which may be sampled at ``goals``.

        Arrivals are sampled up to ``latest_s``, the horizon when None.
        """
        self.start = (q, now_s)
        start = self.si.allocState()
        write_state(start, q, now_s)
        definition = ob.ProblemDefinition(self.si)
        definition.addStartState(start)
        until_s = now_s + self.horizon_s if latest_s is None else latest_s
        definition.setGoal(TipGoal(self.si, self.query, goals, (q, now_s), until_s, rng))
        return definition
