"""Algorithm 1 of the paper and the layered graph, over an enumerated configuration space.

Obstacles come as ``centers`` (h + 1, m, 3) [m] and ``reach`` (h + 1, m) [m], the obstacle's radius plus the arm's, one
row per whole second from now on. ``space`` is an ``EnumeratedSpace``, in whose dense grid cubes are numbered.
"""

import heapq
import math

import numpy as np

from planners.search.configurations._kernels import FREE, HIT, UNKNOWN, is_code_free, is_free, memo_size
from scenarios.kernels.jit import kernel
from scenarios.kernels.kinematics import ARC_SIZE

STAY = 13  # of the 27 moves, the one to the cube itself
CURRENT = -1  # stands for the arm's present configuration where a code is expected


@kernel
def cube_is_open(cube, space, centers, reach, memo, arcs):
    """Whether some enumerated configuration of ``cube`` is free, and the number looked at."""
    first, end = space.offsets[cube], space.offsets[cube + 1]
    for k in range(first, end):
        if is_code_free(space.codes[k], space.n_sections, space.arc_table, centers, reach, memo, arcs):
            return True, k - first + 1
    return False, end - first


@kernel
def temporal_cubes_graph(q_now, cube_now, goal_cube, horizon, waiting, space, section_length, centers, reach):
    """Algorithm 1: the temporal cubes-graph about ``cube_now`` as far as it leads to q_b, and q_b.

    An edge (u, v, t, 1, d) exists when the arm can stand in u at t and in v at t + 1 without collision, that is, when
    either cube holds a free configuration at that time; ``q_now`` counts as one of ``cube_now``'s. Candidates for q_b
    are tried from the nearest to the goal outwards, each with the edges on which a path to it can lie: those from cubes
    reached by t to cubes from which it is still within the hops that are left. Whether a cube is open is found out when
    first asked. Vertices number the box of (2 horizon + 1)^3 cubes about ``cube_now``.

    Returns:
        u, v, t (M,) int64 in order of t; d (M,) [m]; the vertex of q_b, -1 if no cube can be reached; the number of
        states checked.
    """
    side, width = 2 * space.half, 2 * horizon + 1
    n_cells = width * width * width
    here = (n_cells - 1) // 2
    cubes, order = _box_by_distance(cube_now, goal_cube, horizon, side)
    known = np.zeros((horizon, n_cells), np.int8)  # whether each cube is open at step + 1
    memo = np.zeros((horizon, memo_size(space.bends_rad.shape[0], space.n_sections)), np.int8)
    seen = np.zeros(n_cells, np.int64)  # the last round of the search that came to each cube
    frontier, following = np.empty(n_cells, np.int64), np.empty(n_cells, np.int64)
    arcs = np.empty((space.n_sections, ARC_SIZE))
    u, v, t = np.empty(1024, np.int64), np.empty(1024, np.int64), np.empty(1024, np.int64)
    d = np.empty(1024)
    checks, rounds = 0, 0
    for candidate in order:
        gx, gy, gz = candidate // (width * width), candidate // width % width, candidate % width
        n_edges, reached = 0, False
        frontier[0], n_frontier = here, 1
        for step in range(horizon):
            hops_left = horizon - step - 1
            n_following = 0
            rounds += 1
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
                    if known[step, other] == UNKNOWN:
                        spheres, radii = centers[step + 1], reach[step + 1]
                        is_open = other == here and is_free(q_now, section_length, spheres, radii, arcs)
                        if not is_open and cubes[other] >= 0:
                            is_open, looked = cube_is_open(cubes[other], space, spheres, radii, memo[step], arcs)
                            checks += looked
                        known[step, other] = FREE if is_open else HIT
                    if known[step, other] == FREE:
                        u[n_edges], v[n_edges], t[n_edges] = cell, other, step
                        d[n_edges] = math.sqrt(abs(dx) + abs(dy) + abs(dz)) * space.cube_m
                        n_edges += 1
                        reached = reached or other == candidate
                        if seen[other] != rounds:
                            seen[other] = rounds
                            following[n_following] = other
                            n_following += 1
            frontier, following, n_frontier = following, frontier, n_following
        if reached:
            return u[:n_edges], v[:n_edges], t[:n_edges], d[:n_edges], candidate, checks
    return u[:0], v[:0], t[:0], d[:0], -1, checks


@kernel
def _box_by_distance(cube_now, goal_cube, horizon, side):
    """Cube numbers of the box about ``cube_now``, -1 off the grid, and its vertices from the goal outwards.

    Distances are compared as whole numbers of cubes squared, so equal ones are equal and the lower vertex comes first.
    """
    width = 2 * horizon + 1
    x, y, z = cube_now // (side * side) - horizon, cube_now // side % side - horizon, cube_now % side - horizon
    gx, gy, gz = goal_cube // (side * side), goal_cube // side % side, goal_cube % side
    cubes, squared = np.empty(width**3, np.int64), np.empty(width**3, np.int64)
    for cell in range(width**3):
        i, j, k = x + cell // (width * width), y + cell // width % width, z + cell % width
        inside = min(i, j, k) >= 0 and max(i, j, k) < side
        cubes[cell] = (i * side + j) * side + k if inside else -1
        squared[cell] = (i - gx) ** 2 + (j - gy) ** 2 + (k - gz) ** 2
    return cubes, np.argsort(squared, kind="mergesort")


@kernel
def _doubled(array):
    """A copy of ``array`` with room for twice as many entries."""
    larger = np.empty(2 * array.shape[0], array.dtype)
    for k in range(array.shape[0]):
        larger[k] = array[k]
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
def free_layer(cube, with_current, q_now, space, section_length, centers, reach):
    """Free configurations of ``cube`` as codes, CURRENT first where asked for and free, and the number looked at."""
    first, end = space.offsets[cube], space.offsets[cube + 1]
    out = np.empty(end - first + 1, np.int64)
    arcs = np.empty((space.n_sections, ARC_SIZE))
    memo = np.zeros(memo_size(space.bends_rad.shape[0], space.n_sections), np.int8)
    n = 0
    if with_current and is_free(q_now, section_length, centers, reach, arcs):
        out[0], n = CURRENT, 1
    for k in range(first, end):
        if is_code_free(space.codes[k], space.n_sections, space.arc_table, centers, reach, memo, arcs):
            out[n] = space.codes[k]
            n += 1
    return out[:n], end - first + (1 if with_current else 0)


@kernel
def digits(codes, base, n):
    """Lattice numbers (len(codes), n) of codes, first section first; ``base`` in every place for CURRENT."""
    out = np.full((codes.shape[0], n), base, np.int64)
    for a in range(codes.shape[0]):
        code = codes[a]
        if code != CURRENT:
            for i in range(n - 1, -1, -1):
                out[a, i] = code % base
                code //= base
    return out


@kernel
def changes_from(q_now, bends):
    """Orientation change from each section of ``q_now`` (2n,) to every lattice bend: (n, B + 1) [rad].

    The last column is the change from the present configuration to itself.
    """
    n, base = q_now.shape[0] // 2, bends.shape[0]
    out = np.zeros((n, base + 1))
    for i in range(n):
        for b in range(base):
            out[i, b] = section_change(q_now[2 * i], q_now[2 * i + 1], bends[b, 0], bends[b, 1])
    return out


@kernel
def relax_layer(cost, before, after, from_now, table, possible):
    """One round of Bellman-Ford between two layers: best cost of each configuration after, and where it comes from.

    An edge costs its smoothness (paper, section II-D).

    Args:
        cost: Best cost of each configuration before, shape (A,), [rad].
        before: Codes of the configurations before, shape (A,).
        after: Codes of the configurations after, shape (C,).
        from_now: ``changes_from`` the present configuration.
        table: ``change_table`` of the lattice.
        possible: Which edges there are, shape (A, C); (0, 0) for all.
    """
    n, base = from_now.shape[0], table.shape[0]
    rows, columns = digits(before, base, n), digits(after, base, n)
    best = np.full(after.shape[0], np.inf)
    parent = np.full(after.shape[0], -1, np.int64)
    change = np.empty((n, base + 1))
    for a in range(rows.shape[0]):
        for i in range(n):
            row = rows[a, i]
            for b in range(base):
                change[i, b] = from_now[i, b] if row == base else table[row, b]
            change[i, base] = from_now[i, row]
        for b in range(columns.shape[0]):
            if possible.shape[0] > 0 and not possible[a, b]:
                continue
            weight = 0.0
            for i in range(n):
                weight += change[i, columns[b, i]]
            through = cost[a] + weight
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
