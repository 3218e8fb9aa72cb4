"""Algorithm 1 of the paper, static cube paths, and when an obstacle is in a cube.

Vertices of a local graph number the box of (2 h + 1)^3 cubes about the arm's; ``scene`` is a ``search.scene.Scene``, in
whose dense grid cubes are numbered.
"""

import heapq
import math
from typing import NamedTuple

import numpy as np

from planners.search.configurations._kernels import FREE, HIT, UNKNOWN, is_code_free, is_free
from planners.search.layers._kernels import STATE_CHECKS
from planners.search.temporal_graph._kernels import NONE
from scenarios.kernels.jit import kernel

STAY = 13  # of the 27 moves, the one to the cube itself


class Box(NamedTuple):
    """The cubes within h hops, as far as the grid goes, and what is known of them."""

    width: int
    """2 h + 1."""
    here: int
    """Vertex of the arm's cube."""
    cubes: np.ndarray
    """Number of each vertex's cube, -1 off the grid, shape (width^3,)."""
    order: np.ndarray
    """Vertices from the goal outwards, shape (width^3,)."""
    known: np.ndarray
    """Whether each cube is open at each step, shape (h + 1, width^3)."""


class Edges(NamedTuple):
    """Edges (u, v, t, 1, d) of a temporal cubes-graph in order of t."""

    u: np.ndarray
    v: np.ndarray
    t: np.ndarray
    d: np.ndarray
    """Lengths [m]."""


@kernel
def box_about(scene, goal, horizon):
    """The box about the arm's cube; ``goal`` is the number of the goal's.

    Distances are compared as whole numbers of cubes squared, so equal ones are equal and the lower vertex comes first.
    """
    side, width, cube = 2 * scene.space.half, 2 * horizon + 1, scene.cube
    x, y, z = cube // (side * side) - horizon, cube // side % side - horizon, cube % side - horizon
    gx, gy, gz = goal // (side * side), goal // side % side, goal % side
    cubes, squared = np.empty(width**3, np.int64), np.empty(width**3, np.int64)
    for cell in range(width**3):
        i, j, k = x + cell // (width * width), y + cell // width % width, z + cell % width
        inside = min(i, j, k) >= 0 and max(i, j, k) < side
        cubes[cell] = (i * side + j) * side + k if inside else -1
        squared[cell] = (i - gx) ** 2 + (j - gy) ** 2 + (k - gz) ** 2
    order = np.argsort(squared, kind="mergesort")
    return Box(width, (width**3 - 1) // 2, cubes, order, np.zeros((horizon + 1, width**3), np.int8))


@kernel
def is_occupied(box, scene, cell):
    """Whether the cube holds a configuration, free or not."""
    cube, offsets = box.cubes[cell], scene.space.offsets
    return cell == box.here or (cube >= 0 and offsets[cube + 1] > offsets[cube])


@kernel
def closest_cube(box, scene):
    """The paper's q_b (Algorithm 1, line 5): of all cubes of the graph the nearest to the goal, reachable or not.

    Its cubes are those which breadth-first search in the cubes-graph finds within h hops (line 2).
    """
    width, horizon = box.width, box.known.shape[0] - 1
    found = np.zeros(width**3, np.bool_)
    queue, hops = np.empty(width**3, np.int64), np.zeros(width**3, np.int64)
    queue[0], found[box.here] = box.here, True
    first, end = 0, 1
    while first < end and hops[queue[first]] < horizon:
        cell = queue[first]
        first += 1
        for move in range(27):  # never off the box: it is h hops wide
            other = cell + ((move // 9 - 1) * width + move // 3 % 3 - 1) * width + move % 3 - 1
            if not found[other] and is_occupied(box, scene, other):
                found[other], hops[other], queue[end] = True, hops[cell] + 1, other
                end += 1
    for cell in box.order:
        if found[cell]:
            return cell
    return box.here


@kernel
def is_open(box, layers, scene, cell, step):
    """Whether the arm can stand in the cube at ``step``: some configuration of it is free, or the present one.

    Found out when first asked.
    """
    if box.known[step, cell] == UNKNOWN:
        space, cube = scene.space, box.cubes[cell]
        centers, reach, arcs = scene.steps.centers_m[step], scene.steps.reach_m[step], layers.stack.arcs[0]
        found = cell == box.here and is_free(scene.q, scene.section_length, centers, reach, arcs)
        if not found and cube >= 0:
            for k in range(space.offsets[cube], space.offsets[cube + 1]):
                layers.counts[STATE_CHECKS] += 1
                found = is_code_free(
                    space.codes[k], space.n_sections, space.arc_table, centers, reach, layers.memo[step], arcs
                )
                if found:
                    break
        box.known[step, cell] = FREE if found else HIT
    return box.known[step, cell] == FREE


@kernel
def hops_between(box, cell, other):
    """Number of moves from one cube to the other."""
    w = box.width
    x, y, z = cell // (w * w) - other // (w * w), cell // w % w - other // w % w, cell % w - other % w
    return max(abs(x), abs(y), abs(z))


@kernel
def edges_towards(box, layers, scene, candidate, waiting):
    """Edges of the temporal cubes-graph on which a path to ``candidate`` can lie, read at whole seconds.

    That is, those between open cubes, from cubes reached by t to cubes from which it is still within the hops that are
    left.

    Returns:
        The edges and whether the candidate is reached.
    """
    width, horizon = box.width, box.known.shape[0] - 1
    gx, gy, gz = candidate // (width * width), candidate // width % width, candidate % width
    u, v, t, d = np.empty(1024, np.int64), np.empty(1024, np.int64), np.empty(1024, np.int64), np.empty(1024)
    seen = np.full(width**3, NONE)  # the last step at which the search came to each cube
    frontier, following = np.empty(width**3, np.int64), np.empty(width**3, np.int64)
    frontier[0], n_frontier, n_edges, reached = box.here, 1, 0, False
    for step in range(horizon):
        hops_left, n_following = horizon - step - 1, 0
        for f in range(n_frontier):
            cell = frontier[f]
            x, y, z = cell // (width * width), cell // width % width, cell % width
            if n_edges + 27 > d.shape[0]:
                u, v, t, d = _doubled(u), _doubled(v), _doubled(t), _doubled(d)
            for move in range(27):
                dx, dy, dz = move // 9 - 1, move // 3 % 3 - 1, move % 3 - 1
                if max(abs(x + dx - gx), abs(y + dy - gy), abs(z + dz - gz)) > hops_left:
                    continue
                if move == STAY and not waiting:
                    continue
                other = cell + (dx * width + dy) * width + dz
                if is_open(box, layers, scene, other, step + 1):
                    u[n_edges], v[n_edges], t[n_edges] = cell, other, step
                    d[n_edges] = math.sqrt(abs(dx) + abs(dy) + abs(dz)) * scene.space.cube_m
                    n_edges += 1
                    reached = reached or other == candidate
                    if seen[other] != step:
                        seen[other] = step
                        following[n_following] = other
                        n_following += 1
        frontier, following, n_frontier = following, frontier, n_following
    return Edges(u[:n_edges], v[:n_edges], t[:n_edges], d[:n_edges]), reached


@kernel
def _doubled(array):
    """A copy of ``array`` with room for twice as many entries."""
    larger = np.empty(2 * array.shape[0], array.dtype)
    for k in range(array.shape[0]):
        larger[k] = array[k]
    return larger


@kernel
def temporal_cubes_graph(layers, scene, goal, horizon, waiting, reachable):
    """Algorithm 1, read at whole seconds: the edges on which a path to q_b can lie, and q_b.

    With ``reachable`` q_b is the nearest cube to the goal that can be reached, -1 if there is none.
    """
    box = box_about(scene, goal, horizon)
    for candidate in box.order if reachable else np.array([closest_cube(box, scene)]):
        edges, reached = edges_towards(box, layers, scene, candidate, waiting)
        if reached or not reachable:
            return edges, candidate, box.cubes
    return Edges(edges.u[:0], edges.v[:0], edges.t[:0], edges.d[:0]), -1, box.cubes


@kernel
def contains_obstacle(cube, half, cube_m, centers, radii):
    """Whether any of the spheres (m, 3), (m,) [m] reaches into the cube."""
    side = 2 * half
    corner = np.array([cube // (side * side), cube // side % side, cube % side]) - half
    for j in range(centers.shape[0]):
        squared = 0.0
        for k in range(3):
            low = corner[k] * cube_m
            outside = max(low - centers[j, k], centers[j, k] - low - cube_m, 0.0)
            squared += outside * outside
        if squared <= radii[j] * radii[j]:
            return True
    return False


@kernel
def static_path(start, goal, purged, offsets, half, cube_m):
    """Shortest path of occupied cubes from ``start`` to ``goal`` in the cubes-graph without ``purged`` (side^3,).

    Dijkstra's algorithm as A*, guided by the straight distance; the first of equal cubes wins by its number. Returns
    the cubes, empty when there is no path.
    """
    side = 2 * half
    gx, gy, gz = goal // (side * side), goal // side % side, goal % side
    if purged[goal] or offsets[goal] == offsets[goal + 1]:  # else the search would visit every cube to find no path
        return np.empty(0, np.int64)
    cost = np.full(side * side * side, np.inf)
    parent = np.empty(side * side * side, np.int32)
    expanded = np.zeros(side * side * side, np.bool_)  # and its cost has not changed since
    steps = cube_m * np.sqrt(np.arange(4.0))  # by the number of axes along which a move goes
    cost[start] = 0.0
    heap = [(0.0, start)]
    while len(heap) > 0:
        _, cube = heapq.heappop(heap)
        if cube == goal:
            break
        if expanded[cube]:
            continue
        expanded[cube] = True
        x, y, z = cube // (side * side), cube // side % side, cube % side
        for move in range(27):
            i, j, k = x + move // 9 - 1, y + move // 3 % 3 - 1, z + move % 3 - 1
            if move == STAY or min(i, j, k) < 0 or max(i, j, k) >= side:
                continue
            other = (i * side + j) * side + k
            if purged[other] or offsets[other] == offsets[other + 1]:
                continue
            through = cost[cube] + steps[abs(i - x) + abs(j - y) + abs(k - z)]
            if through < cost[other] - 1e-12:
                cost[other], parent[other], expanded[other] = through, cube, False
                left = cube_m * math.sqrt((i - gx) ** 2 + (j - gy) ** 2 + (k - gz) ** 2)
                heapq.heappush(heap, (through + left, other))
    if not np.isfinite(cost[goal]):
        return np.empty(0, np.int64)
    path = [goal]
    while path[-1] != start:
        path.append(np.int64(parent[path[-1]]))
    return np.array(path)[::-1].copy()
