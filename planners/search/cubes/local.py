"""Algorithm 1: the temporal cubes-graph about the cube that holds the tip."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from planners.search.configurations import EnumeratedSpace
from planners.search.cubes import _kernels
from planners.search.temporal_graph.graph import TemporalGraph
from scenarios.arm import ContinuumArm, FloatArray
from scenarios.scenario import STEP_S
from scenarios.world import SampledWorld


class ObstacleSteps(NamedTuple):
    """Where obstacles are at whole seconds from now on, ready for the kernels."""

    centers_m: FloatArray
    """Centres, shape (h + 1, m, 3), [m]; row 0 is now."""
    reach_m: FloatArray
    """Obstacle radius plus arm radius, shape (h + 1, m), [m]."""

    @classmethod
    def from_world(cls, world: SampledWorld, now_s: float, horizon: int, arm_radius_m: float) -> "ObstacleSteps":
        """Read rows now, now + 1 s, ..., now + ``horizon`` s out of a world sampled each second or finer."""
        last = len(world.centers_m) - 1
        passed = (now_s + STEP_S * np.arange(horizon + 1) - world.start_s) / world.step_s
        rows = np.clip(np.rint(passed).astype(int), 0, last)
        return cls(
            np.ascontiguousarray(world.centers_m[rows]), np.ascontiguousarray(world.radii_m[rows]) + arm_radius_m
        )

    @classmethod
    def frozen(cls, world: SampledWorld, arm_radius_m: float) -> "ObstacleSteps":
        """Obstacles as they are now, now and a step later: the view of a planner that does not predict."""
        centers = np.repeat(world.centers_m[:1], 2, axis=0)
        return cls(centers, np.repeat(world.radii_m[:1], 2, axis=0) + arm_radius_m)


class LocalGraph(NamedTuple):
    """What Algorithm 1 returns."""

    graph: TemporalGraph
    """Times are steps from now; vertices are numbered in the box of (2 h + 1)^3 cubes about the current one."""
    source: int
    """Vertex of the current cube."""
    target: int
    """Vertex of q_b, the reached cube nearest to the goal; -1 if no cube can be reached."""
    cubes: npt.NDArray[np.int64]
    """Cube number of each vertex, shape ((2 h + 1)^3,)."""
    state_checks: int


def temporal_cubes_graph(
    arm: ContinuumArm,
    space: EnumeratedSpace,
    q: FloatArray,
    goal_m: FloatArray,
    obstacles: ObstacleSteps,
    waiting: bool,
) -> LocalGraph:
    """Build the temporal cubes-graph that extends as many hops as ``obstacles`` holds steps (paper, Algorithm 1).

    The paper's q_b is the cube of the graph nearest to the goal; here the nearest among those that can be reached in
    time, because the nearest of all may lie inside an obstacle.

    Args:
        arm: The arm.
        space: Its enumerated configurations.
        q: Present configuration, shape (dof,), [rad].
        goal_m: Goal point, shape (3,), [m].
        obstacles: Predicted obstacles at whole seconds.
        waiting: Whether a cube has an edge of cost 0 to itself.
    """
    horizon = len(obstacles.centers_m) - 1
    cube_now = space.cube_of(arm.tip(q))
    u, v, t, d, target, checks = _kernels.temporal_cubes_graph(
        q,
        cube_now,
        space.cube_of(goal_m),
        horizon,
        waiting,
        space,
        arm.section_length_m,
        obstacles.centers_m,
        obstacles.reach_m,
    )
    width, side = 2 * horizon + 1, 2 * space.half
    hops = np.arange(-horizon, horizon + 1)
    cubes = cube_now + ((hops[:, None, None] * side + hops[:, None]) * side + hops).reshape(-1)
    graph = TemporalGraph(width**3, u, v, t, np.ones_like(t), d)
    return LocalGraph(graph, (width**3 - 1) // 2, int(target), cubes, int(checks))
