"""The paper's planner (Algorithm 2): a temporal cubes-graph for the tip, a layered graph for the shape."""

from collections.abc import Callable
from typing import Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from planners.base import ArmPlanner
from planners.problem import SpaceTimeProblem, TimedPath
from planners.search.configurations import enumerated_space, lattice_for
from planners.search.cube_paths import _kernels
from planners.search.layers import call, empty_layers
from planners.search.layers._kernels import MOTION_CHECKS, STATE_CHECKS
from planners.search.scene import scene_of
from scenarios.arm import ContinuumArm, FloatArray
from scenarios.scenario import STEP_S

READINGS = {"steps": _kernels.STEPS, "layers": _kernels.LAYERS, "edges": _kernels.EDGES, "chained": _kernels.CHAINED}
"""Of line 4 of Algorithm 1, the loosest first: see ``Reading``."""


class TemporalSettings(BaseModel):
    """Settings of ``temporal``; the defaults take the paper at its word."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    horizon: int = Field(default=3, ge=1, le=20, description="hops planned ahead, h in the paper")
    transitions: Literal["steps", "layers", "edges", "chained"] = Field(
        default="edges", description="which motions are looked at: none, the shape's, the cubes', from where it can be"
    )
    target: Literal["closest", "reachable"] = Field(
        default="closest", description="q_b: the cube closest to the goal, or the closest that can be reached"
    )
    waiting: bool = Field(default=True, description="whether the tip may stay in its cube for a step")
    spacing_rad: float = Field(default=0.5, gt=0.05, le=3.0, description="spacing of the lattice of bends per section")


class TemporalPlanner(ArmPlanner):
    """One round of Algorithm 2's loop per solve: lines 6 to 11; the episode repeats it from where the path ends."""

    name = "temporal"
    settings_model = TemporalSettings
    summary = "temporal cubes-graph and layered graph of configurations"
    source = "Meng et al., ICRA 2021, Algorithms 1 and 2"
    commitment = "path"

    @classmethod
    def look_ahead_s(cls, settings: TemporalSettings) -> float:
        """One step a hop."""
        return STEP_S * settings.horizon

    @classmethod
    def check_fit(cls, settings: TemporalSettings, arm: ContinuumArm) -> None:
        """See ``ArmPlanner.check_fit``: the lattice has to be of bounded size."""
        lattice_for(arm, settings.spacing_rad)

    def __init__(self, problem: SpaceTimeProblem, settings: TemporalSettings) -> None:
        """Plan ``settings.horizon`` steps ahead on ``problem``."""
        super().__init__(problem, settings)
        self._horizon = settings.horizon
        self._reading = _kernels.Reading(
            READINGS[settings.transitions], settings.target == "reachable", settings.waiting
        )
        self._space = enumerated_space(problem.query.arm, settings.spacing_rad)
        self._layers = empty_layers(self._space.n_sections, len(self._space.bends_rad), settings.horizon)

    def search(self, q: FloatArray, now_s: float, stop: Callable[[], bool]) -> TimedPath | None:
        """Timed configurations, one per step, towards q_b; None where no path leads there: the arm waits a step."""
        del stop  # one bounded piece of work
        query = self.problem.query
        scene = scene_of(query.arm, self._space, q, now_s, query.world, self._horizon, query.limits)
        goal = self._space.cube_of(query.goal_m)
        self._layers, (_, path) = call(_kernels.plan, self._layers, scene, goal, self._horizon, self._reading)
        self.state_checks += int(self._layers.counts[STATE_CHECKS])
        self.motion_checks += int(self._layers.counts[MOTION_CHECKS])
        if not len(path):
            return None
        return TimedPath(now_s + STEP_S * np.arange(len(path), dtype=np.float64), path)
