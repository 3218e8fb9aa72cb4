"""The paper's planner (Algorithm 2): a temporal cubes-graph for the tip, a layered graph for the shape."""

from collections.abc import Callable

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from planners.base import ArmPlanner
from planners.problem import SpaceTimeProblem, TimedPath
from planners.search.configurations import enumerated_space, lattice_for
from planners.search.cubes import LayeredGraph, ObstacleSteps, temporal_cubes_graph
from planners.search.temporal_graph.graph import Window
from scenarios.arm import ContinuumArm, FloatArray
from scenarios.scenario import STEP_S


class TemporalSettings(BaseModel):
    """Settings of ``temporal``."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    horizon: int = Field(default=3, ge=1, le=20, description="hops planned ahead, h in the paper")
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
        self._settings = settings
        self._space = enumerated_space(problem.query.arm, settings.spacing_rad)

    def search(self, q: FloatArray, now_s: float, stop: Callable[[], bool]) -> TimedPath | None:
        """Timed configurations, one per step, towards the reachable cube nearest to the goal."""
        query = self.problem.query
        obstacles = ObstacleSteps.from_world(query.world, now_s, self._settings.horizon, query.arm.radius_m)
        local = temporal_cubes_graph(query.arm, self._space, q, query.goal_m, obstacles, self._settings.waiting)
        self.state_checks += local.state_checks
        if local.target < 0:
            return None
        edges = local.graph.shortest_path(local.source, local.target, Window(0, 0), self._settings.horizon)
        if edges is None or stop():
            return None
        vertices = [local.source, *local.graph.v[edges]]
        layered = LayeredGraph(query.arm, self._space, q, [int(local.cubes[v]) for v in vertices], obstacles)
        self.state_checks += layered.state_checks
        path = layered.smoothest_path(self.motion_filter(now_s))
        if path is None:
            return None
        return TimedPath(now_s + STEP_S * np.arange(len(path), dtype=np.float64), path)
