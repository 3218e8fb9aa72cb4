"""The shared checker and validator of the trial under way, asked one question at a time."""

import functools
import math
from collections.abc import Callable
from typing import Any

import numpy as np

from planners.problem import Query, SpaceTimeProblem, write_state
from planners.search.scene import Scene
from scenarios.arm import ContinuumArm, FloatArray
from scenarios.world import SampledWorld

DISTANCES_AGREE_M = 1e-9
UNLIMITED = math.inf, math.inf


class Court:
    """Hands each question to the checker or validator that OMPL holds, about the world that the planner searches."""

    def __init__(self) -> None:
        """Nothing has been asked."""
        self.asked = 0
        self.unsafe = 0
        """Motions that a planner's own kernel took to be free and the validator does not."""
        self.cautious = 0
        """Motions that it took to be blocked and the validator does not."""
        self._problem: SpaceTimeProblem | None = None
        self._scene: Scene | None = None

    def sit(self) -> None:
        """Take note of every problem that is set up, for the questions of its planner."""
        set_up = SpaceTimeProblem.__init__

        def noting(problem: SpaceTimeProblem, query: Query, horizon_s: float) -> None:
            set_up(problem, query, horizon_s)
            self._problem = problem

        SpaceTimeProblem.__init__ = noting  # type: ignore[method-assign]

    def noting(self, scene_of: Callable[..., Scene]) -> Callable[..., Scene]:
        """``scene_of``, whose scenes are kept: kernels that look at configurations name only the obstacles' places."""

        @functools.wraps(scene_of)
        def noted(*given: Any, **named: Any) -> Scene:
            self._scene = scene_of(*given, **named)
            return self._scene

        return noted

    @property
    def through_ompl(self) -> int:
        """How often checker and validator of the trial under way were asked through OMPL or the planner's own code."""
        assert self._problem is not None
        return self._problem.checker.checks + self._problem.validator.checks

    def compare(self, own: bool, free: bool) -> None:
        """Take note of where a planner's own kernel and the validator differ."""
        self.unsafe += bool(own and not free)
        self.cautious += bool(free and not own)

    def is_code_free(self, code: int, centers_m: FloatArray) -> bool:
        """Whether an enumerated configuration is valid when obstacles are at ``centers_m`` (m, 3)."""
        assert self._scene is not None
        return self.is_free(self._scene.space.decode(np.array([code]))[0], centers_m)

    def is_free(self, q: FloatArray, centers_m: FloatArray) -> bool:
        """The same of ``q`` (dof,) [rad]."""
        scene = self._scene
        assert scene is not None
        step = next(k for k, row in enumerate(scene.steps.centers_m) if np.array_equal(row, centers_m))
        return self.clearance(q, scene.now_s + step, scene.world) > 0.0

    def clearance(self, q: FloatArray, time_s: float, world: SampledWorld) -> float:
        """What the checker says of a state [m]."""
        problem = self._in_session(world)
        checker, checks = problem.checker, problem.checker.checks
        state = problem.si.allocState()
        write_state(state, np.asarray(q), time_s)
        gap = checker.clearance(state)
        assert (gap > 0.0) == problem.si.isValid(state)
        checker.checks = checks
        self.asked += 1
        return gap

    def compare_distances(self, own_m: float, q: FloatArray, center_m: FloatArray) -> None:
        """Take note of a distance of the backbone from a point that is not the checker's, from a sphere about it."""
        here = np.broadcast_to(np.asarray(center_m), (2, 1, 3)).copy()
        world = SampledWorld(0.0, 1.0, here, np.zeros((2, 1)), 0.0)
        clearance = self.clearance(q, 0.0, world)
        if clearance > -math.inf:  # within the bends
            self.unsafe += abs(own_m - clearance - self._arm().radius_m) > DISTANCES_AGREE_M

    def is_motion_free(
        self,
        q0: FloatArray,
        t0_s: float,
        q1: FloatArray,
        t1_s: float,
        world: SampledWorld,
        *,
        margin_m: float = 0.0,
        rates: tuple[float, float] | None = None,
    ) -> bool:
        """The validator on a motion among obstacles grown by ``margin_m``, within ``rates``, else the arm's."""
        grown = SampledWorld(*world)._replace(radii_m=np.asarray(world.radii_m) + margin_m)
        arm = self._arm()
        if rates:
            arm = arm.model_copy(update={"max_bend_rate_rad_s": rates[0], "max_tip_speed_m_s": rates[1]})
        validator = self._in_session(grown, arm).validator
        checks = validator.checks
        free = validator.check(np.asarray(q0).copy(), t0_s, np.asarray(q1).copy(), t1_s)
        validator.checks = checks
        self.asked += 1
        return free

    def _arm(self) -> ContinuumArm:
        assert self._problem is not None
        return self._problem.query.arm

    def _in_session(self, world: SampledWorld, arm: ContinuumArm | None = None) -> SpaceTimeProblem:
        """The problem of the trial under way, its checker and validator asked about ``world``."""
        problem = self._problem
        assert problem is not None
        assert math.isfinite(world.start_s)
        query = problem.query._replace(world=SampledWorld(*world), shapes=None, arm=arm or problem.query.arm)
        problem.checker.query = problem.validator.query = query
        return problem


COURT = Court()
"""The one of this process: kernels can ask nothing but a global."""
