"""Algorithm 1, read at whole seconds: the temporal cubes-graph about the cube that holds the tip."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from planners.search.cubes import _kernels
from planners.search.layers import empty_layers
from planners.search.layers._kernels import STATE_CHECKS, clear
from planners.search.scene import Scene
from planners.search.temporal_graph.graph import TemporalGraph
from scenarios.arm import FloatArray


class LocalGraph(NamedTuple):
    """What Algorithm 1 returns."""

    graph: TemporalGraph
    """Times are steps from now; vertices are numbered in the box of (2 h + 1)^3 cubes about the current one."""
    source: int
    """Vertex of the current cube."""
    target: int
    """Vertex of q_b; -1 if no cube can be reached."""
    cubes: npt.NDArray[np.int64]
    """Cube number of each vertex, -1 off the grid, shape ((2 h + 1)^3,)."""
    state_checks: int


def temporal_cubes_graph(scene: Scene, goal_m: FloatArray, waiting: bool, reachable: bool) -> LocalGraph:
    """Build the temporal cubes-graph of ``scene`` as far as it leads to q_b (paper, Algorithm 1).

    An edge (u, v, t, 1, d) is there when v holds a free configuration at t + 1.

    Args:
        scene: Where the arm is and what it is shown.
        goal_m: Goal point, shape (3,), [m].
        waiting: Whether a cube has an edge of cost 0 to itself.
        reachable: Whether q_b is the cube nearest to the goal that can be reached, or simply the nearest.
    """
    space, horizon = scene.space, scene.horizon
    layers = empty_layers(space.n_sections, len(space.bends_rad), horizon)
    clear(layers)
    (u, v, t, d), target, cubes = _kernels.temporal_cubes_graph(
        layers, scene, space.cube_of(goal_m), horizon, waiting, reachable
    )
    graph = TemporalGraph(len(cubes), u, v, t, np.ones_like(t), d)
    return LocalGraph(graph, (len(cubes) - 1) // 2, int(target), cubes, int(layers.counts[STATE_CHECKS]))
