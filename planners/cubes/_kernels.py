"""Algorithm 1 of the paper and the layered graph, over an enumerated configuration space.

Obstacles come as ``centers`` (h + 1, m, 3) [m] and ``reach`` (h + 1, m) [m], the obstacle's radius plus the arm's, one
row per whole second from now on. Cubes are numbered in the dense grid of ``EnumeratedSpace``.
"""

import heapq
import math

import numpy as np

from planners.configurations._kernels import decode
from scenarios.kernels.clearance import distance_to_arc
from scenarios.kernels.jit import kernel
from scenarios.kernels.kinematics import ARC_SIZE, section_arcs

STAY = 13  # of the 27 moves, the one to the cube itself
CURRENT = -1  # stands for the arm's present configuration where a code is expected


@kernel
def is_free(q, section_length, centers, reach, arcs):
    """Whether the arm at ``q`` touches none of the spheres ``centers`` (m, 3) within ``reach`` (m,) of its backbone."""
    section_arcs(q, section_length, arcs)
    for i in range(arcs.shape[0]):
        for j in range(centers.shape[0]):
            if distance_to_arc(arcs[i], centers[j, 0], centers[j, 1], centers[j, 2]) <= reach[j]:
                return False
    return True


@kernel
def first_free(cube, offsets, codes, bends, q, section_length, centers, reach, arcs):
    """Whether some enumerated configuration of ``cube`` is free, and the number looked at; ``q`` is work space."""
    for k in range(offsets[cube], offsets[cube + 1]):
        decode(codes[k], bends, q)
        if is_free(q, section_length, centers, reach, arcs):
            return True, k - offsets[cube] + 1
    return False, offsets[cube + 1] - offsets[cube]


@kernel
def temporal_cubes_graph(
    q_now, cube_now, horizon, waiting, offsets, codes, bends, half, cube_m, section_length, centers, reach, goal
):
    """Algorithm 1: the temporal cubes-graph about ``cube_now`` and its cube nearest to the goal.

    An edge (u, v, t, 1, d) exists when the arm can stand in u at t and in v at t + 1 without collision, that is, when
    either cube holds a free configuration at that time; ``q_now`` counts as one of ``cube_now``'s. Edges from cubes
    that cannot be reached by t are left out, as no path from ``cube_now`` uses them. Vertices number the box of
    (2 horizon + 1)^3 cubes about ``cube_now``.

    Returns:
        u, v, t (M,) int64 in order of t; d (M,) [m]; the vertex nearest to ``goal`` (3,) [m] among those reached, -1
        if none is; the number of states checked.
    """
    side, width = 2 * half, 2 * horizon + 1
    corner = np.array([cube_now // (side * side), cube_now // side % side, cube_now % side]) - horizon
    n_cells = width * width * width
    here = (n_cells - 1) // 2
    q, arcs = np.empty_like(q_now), np.empty((q_now.shape[0] // 2, ARC_SIZE))
    u, v, t = np.empty(1024, np.int64), np.empty(1024, np.int64), np.empty(1024, np.int64)
    d = np.empty(1024)
    n_edges, checks = 0, 0
    frontier, following = np.empty(n_cells, np.int64), np.empty(n_cells, np.int64)
    frontier[0], n_frontier = here, 1
    nearest, nearest_distance = -1, math.inf
    for step in range(horizon):
        spheres, radii = centers[step + 1], reach[step + 1]
        known = np.zeros(n_cells, np.int8)  # of each cube at step + 1: 0 not looked at, 1 open, 2 closed
        n_following = 0
        for f in range(n_frontier):
            cell = frontier[f]
            if n_edges + 27 > d.shape[0]:
                u, v, t, d = _doubled(u), _doubled(v), _doubled(t), _doubled(d)
            for move in range(27):
                if move == STAY and not waiting:
                    continue
                dx, dy, dz = move // 9 - 1, move // 3 % 3 - 1, move % 3 - 1
                other = cell + (dx * width + dy) * width + dz
                if known[other] == 0:
                    x, y, z = other // (width * width), other // width % width, other % width
                    cx, cy, cz = corner[0] + x, corner[1] + y, corner[2] + z
                    is_open = other == here and is_free(q_now, section_length, spheres, radii, arcs)
                    if not is_open and min(cx, cy, cz) >= 0 and max(cx, cy, cz) < side:
                        cube = (cx * side + cy) * side + cz
                        is_open, looked = first_free(
                            cube, offsets, codes, bends, q, section_length, spheres, radii, arcs
                        )
                        checks += looked
                    known[other] = 1 if is_open else 2
                    if is_open:
                        following[n_following] = other
                        n_following += 1
                        distance = math.sqrt(
                            ((cx - half + 0.5) * cube_m - goal[0]) ** 2
                            + ((cy - half + 0.5) * cube_m - goal[1]) ** 2
                            + ((cz - half + 0.5) * cube_m - goal[2]) ** 2
                        )
                        # Equal but for rounding: the one reached first, in the order of vertices.
                        if distance < nearest_distance - 1e-9:
                            nearest, nearest_distance = other, distance
                if known[other] == 1:
                    u[n_edges], v[n_edges], t[n_edges] = cell, other, step
                    d[n_edges] = math.sqrt(abs(dx) + abs(dy) + abs(dz)) * cube_m
                    n_edges += 1
        frontier, following, n_frontier = following, frontier, n_following
    return u[:n_edges], v[:n_edges], t[:n_edges], d[:n_edges], nearest, checks


@kernel
def _doubled(array):
    """A copy of ``array`` with room for twice as many entries."""
    larger = np.empty(2 * array.shape[0], array.dtype)
    larger[: array.shape[0]] = array
    return larger


@kernel
def section_change(u0, v0, u1, v1):
    """Orientation change of one section between bending vectors (paper, section II-D), theta wrapped [rad].

    A straight section has no bending plane: its theta is taken to be the other's.
    """
    phi0, phi1 = math.hypot(u0, v0), math.hypot(u1, v1)
    turn = 0.0
    if phi0 > 1e-9 and phi1 > 1e-9:
        turn = abs(math.atan2(v1, u1) - math.atan2(v0, u0))
        turn = min(turn, 2.0 * math.pi - turn)
    return math.hypot(turn, phi1 - phi0)


@kernel
def change_table(bends):
    """Orientation change between all pairs of lattice bends: (B, B) [rad]."""
    out = np.empty((bends.shape[0], bends.shape[0]))
    for a in range(bends.shape[0]):
        for b in range(bends.shape[0]):
            out[a, b] = section_change(bends[a, 0], bends[a, 1], bends[b, 0], bends[b, 1])
    return out


@kernel
def free_layer(cube, with_current, q_now, offsets, codes, bends, section_length, centers, reach):
    """Free configurations of ``cube`` as codes, CURRENT first where asked for and free, and the number looked at."""
    out = np.empty(offsets[cube + 1] - offsets[cube] + 1, np.int64)
    q, arcs = np.empty_like(q_now), np.empty((q_now.shape[0] // 2, ARC_SIZE))
    n, checks = 0, 0
    if with_current:
        checks += 1
        if is_free(q_now, section_length, centers, reach, arcs):
            out[0], n = CURRENT, 1
    for k in range(offsets[cube], offsets[cube + 1]):
        decode(codes[k], bends, q)
        checks += 1
        if is_free(q, section_length, centers, reach, arcs):
            out[n] = codes[k]
            n += 1
    return out[:n], checks


@kernel
def digits(codes, base, n):
    """Lattice numbers (len(codes), n) of codes, first section first; CURRENT in every place for CURRENT."""
    out = np.full((codes.shape[0], n), CURRENT, np.int64)
    for a in range(codes.shape[0]):
        code = codes[a]
        if code != CURRENT:
            for i in range(n - 1, -1, -1):
                out[a, i] = code % base
                code //= base
    return out


@kernel
def layer_costs(q_now, before, after, bends, table):
    """Smoothness (paper, section II-D) between every configuration of two layers: (len(before), len(after)) [rad]."""
    n, base = q_now.shape[0] // 2, bends.shape[0]
    from_now = np.empty((n, base + 1))
    from_now[:, CURRENT] = 0.0  # the last column: from the present configuration to itself
    for i in range(n):
        for b in range(base):
            from_now[i, b] = section_change(q_now[2 * i], q_now[2 * i + 1], bends[b, 0], bends[b, 1])
    rows, columns = digits(before, base, n), digits(after, base, n)
    out = np.zeros((before.shape[0], after.shape[0]))
    for a in range(rows.shape[0]):
        for b in range(columns.shape[0]):
            for i in range(n):
                if rows[a, i] == CURRENT:
                    out[a, b] += from_now[i, columns[b, i]]
                elif columns[b, i] == CURRENT:
                    out[a, b] += from_now[i, rows[a, i]]
                else:
                    out[a, b] += table[rows[a, i], columns[b, i]]
    return out


@kernel
def relax_layer(cost, weights):
    """One round of Bellman-Ford between two layers: best cost of each configuration after, and where it comes from."""
    best = np.full(weights.shape[1], np.inf)
    parent = np.full(weights.shape[1], -1, np.int64)
    for a in range(weights.shape[0]):
        for b in range(weights.shape[1]):
            through = cost[a] + weights[a, b]
            if through < best[b]:
                best[b], parent[b] = through, a
    return best, parent


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
    cost = np.full(side * side * side, np.inf)
    parent = np.full(side * side * side, -1, np.int32)
    cost[start] = 0.0
    heap = [(0.0, start)]
    while len(heap) > 0:
        _, cube = heapq.heappop(heap)
        if cube == goal:
            break
        x, y, z = cube // (side * side), cube // side % side, cube % side
        for move in range(27):
            i, j, k = x + move // 9 - 1, y + move // 3 % 3 - 1, z + move % 3 - 1
            if move == STAY or min(i, j, k) < 0 or max(i, j, k) >= side:
                continue
            other = (i * side + j) * side + k
            if purged[other] or offsets[other] == offsets[other + 1]:
                continue
            through = cost[cube] + cube_m * math.sqrt((i - x) ** 2 + (j - y) ** 2 + (k - z) ** 2)
            if through < cost[other] - 1e-12:
                cost[other], parent[other] = through, cube
                left = cube_m * math.sqrt((i - gx) ** 2 + (j - gy) ** 2 + (k - gz) ** 2)
                heapq.heappush(heap, (through + left, other))
    if not np.isfinite(cost[goal]):
        return np.empty(0, np.int64)
    path = [goal]
    while path[-1] != start:
        path.append(np.int64(parent[path[-1]]))
    return np.array(path)[::-1].copy()
