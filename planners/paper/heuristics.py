"""The paper's two greedy heuristics (sections IV-A and IV-B): a static cube path, and what to do when it is blocked.

Neither predicts. The next cube is blocked when an obstacle, where it is now, reaches into it, or when none of its
configurations is free of the obstacles where they are now; otherwise the arm makes the smoothest transition into it.
"""

from abc import abstractmethod
from collections.abc import Callable

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from planners.base import ArmPlanner
from planners.problem import SpaceTimeProblem, TimedPath
from planners.search.configurations import enumerated_space, lattice_for
from planners.search.cubes import LayeredGraph, ObstacleSteps
from planners.search.cubes import _kernels as kernels
from scenarios.arm import ContinuumArm, FloatArray
from scenarios.scenario import STEP_S


class HeuristicSettings(BaseModel):
    """Settings of ``h`` and ``hs``."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    spacing_rad: float = Field(default=0.5, gt=0.05, le=3.0, description="spacing of the lattice of bends per section")


class StaticPathPlanner(ArmPlanner):
    """Follows a shortest cube path one cube per step; what to do about a blocked cube is for the subclass."""

    settings_model = HeuristicSettings
    commitment = "path"
    is_reactive = True

    @classmethod
    def check_fit(cls, settings: HeuristicSettings, arm: ContinuumArm) -> None:
        """See ``ArmPlanner.check_fit``: the lattice has to be of bounded size."""
        lattice_for(arm, settings.spacing_rad)

    def __init__(self, problem: SpaceTimeProblem, settings: HeuristicSettings) -> None:
        """Plan on ``problem`` with the lattice in ``settings``."""
        super().__init__(problem, settings)
        self._space = enumerated_space(problem.query.arm, settings.spacing_rad)
        self._purged = np.zeros(len(self._space.offsets) - 1, dtype=np.bool_)
        self._ahead: list[int] = []

    @abstractmethod
    def when_blocked(self, cube: int) -> bool:
        """Deal with a blocked next cube; True to wait for a step, False to look for another path."""

    def search(self, q: FloatArray, now_s: float, stop: Callable[[], bool]) -> TimedPath | None:
        """One step into the next cube, or a wait; None when no path is left."""
        times = now_s + STEP_S * np.arange(2, dtype=np.float64)
        here = self._space.cube_of(self.problem.query.arm.tip(q))
        while not stop():
            if self._ahead[:1] != [here]:
                self._ahead = self._static_path(here)
            if not self._ahead:
                self._purged[:] = False  # all is purged: forget it and try again at the next step
                return None
            if len(self._ahead) == 1:
                return TimedPath(times, np.stack([q, q]))
            following = self._ahead[1]
            step = self._transition(q, now_s, here, following)
            if step is not None:
                self._ahead = self._ahead[1:]
                return TimedPath(times, step)
            if self.when_blocked(following):
                return TimedPath(times, np.stack([q, q]))
            self._ahead = []
        return None

    def _static_path(self, here: int) -> list[int]:
        space = self._space
        goal = space.cube_of(self.problem.query.goal_m)
        cubes = kernels.static_path(here, goal, self._purged, space.offsets, space.half, space.cube_m)
        return [int(cube) for cube in cubes]

    def _transition(self, q: FloatArray, now_s: float, here: int, following: int) -> FloatArray | None:
        """Present and next configuration (2, dof) [rad] of the smoothest transition; None when the cube is blocked."""
        query, space = self.problem.query, self._space
        obstacles = ObstacleSteps.frozen(query.world, query.arm.radius_m)
        radii = obstacles.reach_m[0] - query.arm.radius_m
        if kernels.contains_obstacle(following, space.half, space.cube_m, obstacles.centers_m[0], radii):
            return None
        layered = LayeredGraph(query.arm, space, q, [here, following], obstacles)
        self.state_checks += layered.state_checks
        return layered.smoothest_path(self.motion_filter(now_s))


class PurgingPlanner(StaticPathPlanner):
    """First heuristic (paper, section IV-A): purge the blocked cube from the cubes-graph and find a new path."""

    name = "h"
    summary = "static cube path, recomputed without the cubes found blocked"
    source = "first heuristic: paper, section IV-A"

    def when_blocked(self, cube: int) -> bool:
        """Purge the cube for good."""
        self._purged[cube] = True
        return False


class WaitingPlanner(StaticPathPlanner):
    """Second heuristic (paper, section IV-B): wait until the obstacle has left the next cube."""

    name = "hs"
    summary = "static cube path, waiting while the next cube is blocked"
    source = "second heuristic: paper, section IV-B"

    def when_blocked(self, cube: int) -> bool:
        """Wait."""
        del cube
        return True
