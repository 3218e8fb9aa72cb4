"""The paper's two greedy heuristics (sections IV-A and IV-B): a static cube path, and what to do when it is blocked.

Neither predicts: the next cube is judged by the obstacles where they are now, and so are motions where they are looked
at. Otherwise the arm makes the smoothest transition into the next cube.
"""

from abc import abstractmethod
from collections.abc import Callable
from typing import Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from planners.base import ArmPlanner
from planners.problem import SpaceTimeProblem, TimedPath
from planners.search.configurations import enumerated_space, lattice_for
from planners.search.cubes import _kernels as kernels
from planners.search.layers import LayeredGraph
from planners.search.scene import frozen, scene_of, without_obstacles
from scenarios.arm import ContinuumArm, FloatArray
from scenarios.scenario import STEP_S


class HeuristicSettings(BaseModel):
    """Settings of ``hs``."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    blocked: Literal["cube", "body", "motion"] = Field(
        default="body",
        description="when a cube is blocked: an obstacle reaches into it, or none of its configurations is free, or no "
        "motion to one",
    )
    spacing_rad: float = Field(default=0.5, gt=0.05, le=3.0, description="spacing of the lattice of bends per section")


class PurgingSettings(HeuristicSettings):
    """Settings of ``h``."""

    forget: bool = Field(default=False, description="whether purged cubes return and the path is found anew each step")


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
        self._blocked = settings.blocked
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
        query, space, now = self.problem.query, self._space, frozen(self.problem.query.world)
        if kernels.contains_obstacle(following, space.half, space.cube_m, now.centers_m[0], now.radii_m[0]):
            return None
        seen = without_obstacles(now) if self._blocked == "cube" else now
        layered = LayeredGraph(scene_of(query.arm, space, q, now_s, seen, 1, query.limits), [here, following])
        path = layered.smoothest_path(look=query.limits or self._blocked == "motion")
        self.state_checks += layered.state_checks
        self.motion_checks += layered.motion_checks
        return path


class PurgingPlanner(StaticPathPlanner):
    """First heuristic (paper, section IV-A): purge the blocked cube from the cubes-graph and find a new path."""

    name = "h"
    summary = "static cube path, recomputed without the cubes found blocked"
    source = "first heuristic: paper, section IV-A"
    settings_model = PurgingSettings

    def __init__(self, problem: SpaceTimeProblem, settings: PurgingSettings) -> None:
        """Plan on ``problem`` with the lattice in ``settings``."""
        super().__init__(problem, settings)
        self._forget = settings.forget

    def search(self, q: FloatArray, now_s: float, stop: Callable[[], bool]) -> TimedPath | None:
        """See ``StaticPathPlanner.search``."""
        if self._forget:
            self._purged[:] = False
            self._ahead = []
        return super().search(q, now_s, stop)

    def when_blocked(self, cube: int) -> bool:
        """Purge the cube."""
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
