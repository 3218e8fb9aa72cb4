"""Lines 7 to 10 of the paper's Algorithm 2: q_b, a shortest temporal cube path to it, a smoothest path through it.

What an edge of the temporal cubes-graph says of the arm's motion is a matter of reading, see ``Reading``. Edges and
motions are looked at when a shortest path wants them: a path that holds when all others are taken to hold is shortest.
"""

import heapq
import math
from typing import NamedTuple

import numpy as np

from planners.search.cubes._kernels import STAY, box_about, closest_cube, edges_towards, hops_between, is_open
from planners.search.layers._kernels import (
    BLOCKED,
    FIRST,
    N_CONFIGURATIONS,
    NONE,
    add_layer,
    add_start,
    clear,
    first_motion,
    is_possible,
    size,
    smoothest_path,
    some_motion,
)
from planners.search.temporal_graph._kernels import shortest
from scenarios.kernels.jit import kernel

STEPS, LAYERS, EDGES, CHAINED = range(4)  # readings of an edge, see ``Reading``

# Lengths of moves along 0 to 3 axes as whole numbers, so that equal paths are equal however they are summed up.
UNIT = 2.0**40
STRAIGHT, DIAGONAL, CORNER = round(UNIT), round(math.sqrt(2.0) * UNIT), round(math.sqrt(3.0) * UNIT)


class Reading(NamedTuple):
    """How Algorithm 1 is read."""

    transitions: int
    """STEPS: an edge leads to a cube that holds a free configuration at its end. LAYERS: the same, and motions of the
    layered graph are looked at. EDGES: and an arm can move from some free configuration of the one cube to some of the
    other. CHAINED: and it can move so from the present configuration on, all along the path."""
    reachable: bool
    """Whether q_b is the closest cube that can be reached, or simply the closest."""
    waiting: bool
    """Whether a cube has an edge of cost 0 to itself."""


@kernel
def _layer_at(layers, scene, box, numbers, cell, step):
    """Number of the layer of a cube at a step, which is added when first asked for; ``numbers`` (h + 1, cells)."""
    if numbers[step, cell] == NONE:
        numbers[step, cell] = add_layer(layers, scene, box.cubes[cell], step)
    return numbers[step, cell]


@kernel
def _between(layers, scene, box, numbers, cell, other, step):
    """The layers of a cube at a step and of its neighbour at the next, with the motions between them.

    Returns:
        The numbers of the two and that of the first motion.
    """
    before = _layer_at(layers, scene, box, numbers, cell, step)
    after = _layer_at(layers, scene, box, numbers, other, step + 1)
    w = box.width
    dx, dy = other // (w * w) - cell // (w * w), other // w % w - cell // w % w
    dz = other % w - cell % w
    return before, after, first_motion(layers, scene, before, after, 9 * dx + 3 * dy + dz + STAY)


@kernel
def shortest_path(layers, scene, box, numbers, edges, target, look):
    """Vertices of a shortest temporal path to ``target``, the earliest among equals; empty when there is none.

    With ``look`` each of its edges allows some motion; an edge is asked for it when a shortest path wants it.
    """
    horizon, d = box.known.shape[0] - 1, edges.d.copy()
    holds = np.zeros(d.shape[0], np.bool_)
    path, vertices = np.empty(horizon, np.int64), np.full(horizon + 1, box.here)
    while True:
        cost, via = shortest(
            edges.u, edges.v, edges.t, edges.t + 1, d, box.cubes.shape[0], horizon + 1, box.here, 0, 0
        )  # fmt: skip
        length = 0
        for step in range(1, horizon + 1):
            if via[target, step] != NONE and (length == 0 or cost[target, step] < cost[target, length]):
                length = step
        cell = target
        for step in range(length, 0, -1):
            path[step - 1], vertices[step] = via[cell, step], cell
            cell = edges.u[via[cell, step]]
        shut = NONE
        for e in path[:length]:
            if look and not holds[e]:
                before, after, block = _between(layers, scene, box, numbers, edges.u[e], edges.v[e], edges.t[e])
                holds[e] = some_motion(layers, scene, before, after, block)
                if not holds[e]:
                    shut = e
                    break
        if shut == NONE:
            return vertices[: length + 1 if length > 0 else 0]
        d[shut] = math.inf


@kernel
def _straight(box, cell, other):
    """Least length of a path from one cube to the other [1 / UNIT cubes]."""
    w = box.width
    x, y, z = abs(cell // (w * w) - other // (w * w)), abs(cell // w % w - other // w % w), abs(cell % w - other % w)
    corner, most = min(x, y, z), max(x, y, z)
    diagonal = x + y + z - most - 2 * corner  # the middle one less the least
    return corner * CORNER + diagonal * DIAGONAL + (most - diagonal - corner) * STRAIGHT


@kernel
def _claim(layers, scene, before, after, block, parent, label, one):
    """Label what of layer ``after`` is not labelled yet and can be reached from what ``parent`` labels of ``before``.

    Returns whether there was any; with ``one`` the first is enough.
    """
    c, m = layers.configurations, layers.motions
    width, found = size(layers, after), False
    for b in range(width):
        row = layers.spans[after, FIRST] + b
        while c.labels[row] == NONE:
            best = NONE
            for a in range(size(layers, before)):
                k = block + a * width + b
                mine = c.labels[layers.spans[before, FIRST] + a] == parent and m.answers[k] != BLOCKED
                if mine and (best == NONE or m.weights[k] < m.weights[block + best * width + b]):
                    best = a
            if best == NONE:
                break
            if is_possible(layers, scene, before, after, block, best, b):
                c.labels[row], found = label, True
        if found and one:
            break
    return found


@kernel
def chained_path(layers, scene, box, numbers, target, waiting):
    """Vertices of a shortest temporal path to ``target`` that some chain of configurations can follow; empty if none.

    Best first over cube paths, the earliest arrival among equals. A path keeps the configurations that no shorter one
    reached before it, and ends where it keeps none: paths that meet are not pooled, or they would be mixed.
    """
    horizon = box.known.shape[0] - 1
    layers.configurations.labels[: layers.counts[N_CONFIGURATIONS]] = NONE
    layers.configurations.labels[layers.spans[numbers[0, box.here], FIRST]] = 0
    cells, steps, parents, lengths = [box.here], [0], [NONE], [0]
    heap = [(_straight(box, box.here, target), hops_between(box, box.here, target), 0, 0)]
    open_at_all = False
    for step in range(max(1, hops_between(box, box.here, target)), horizon + 1):
        open_at_all = open_at_all or is_open(box, layers, scene, target, step)
    while open_at_all and len(heap) > 0:
        _, _, _, label = heapq.heappop(heap)
        cell, step, parent = cells[label], steps[label], parents[label]
        if step > 0:
            before, after, block = _between(layers, scene, box, numbers, cells[parent], cell, step - 1)
            if not _claim(layers, scene, before, after, block, parent, label, cell == target):
                continue
            if cell == target:
                path = np.empty(step + 1, np.int64)
                for k in range(step, -1, -1):
                    path[k], label = cells[label], parents[label]
                return path
        if step == horizon:
            continue
        for move in range(27):
            dx, dy, dz = move // 9 - 1, move // 3 % 3 - 1, move % 3 - 1
            other = cell + (dx * box.width + dy) * box.width + dz
            if move == STAY and not waiting:
                continue
            left = hops_between(box, other, target) if hops_between(box, cell, target) <= horizon - step else horizon
            if left > horizon - step - 1 or not is_open(box, layers, scene, other, step + 1):
                continue
            axes = abs(dx) + abs(dy) + abs(dz)
            length = lengths[label] + (0 if axes == 0 else STRAIGHT if axes == 1 else DIAGONAL if axes == 2 else CORNER)
            cells.append(other)
            steps.append(step + 1)
            parents.append(label)
            lengths.append(length)
            # Of equally good ones first that which has come farthest.
            entry = (length + _straight(box, other, target), step + 1 + left, -step - 1, len(cells) - 1)
            heapq.heappush(heap, entry)
    return np.empty(0, np.int64)


@kernel
def plan(layers, scene, goal, horizon, reading):
    """One round of Algorithm 2, lines 7 to 10.

    Args:
        layers: Arrays to work in.
        scene: Where the arm is and what it is shown.
        goal: Number of the goal's cube.
        horizon: Steps ahead, h.
        reading: How Algorithm 1 is read.

    Returns:
        Numbers of the cubes on the shortest path to q_b, one per step, empty when there is none, and configurations of
        the smoothest path through them (k, 2n) [rad], empty when there is none.
    """
    clear(layers)
    box = box_about(scene, goal, horizon)
    numbers, vertices = np.full((horizon + 1, box.cubes.shape[0]), NONE), np.empty(0, np.int64)
    start = add_start(layers, scene)
    if reading.transitions != EDGES:  # Algorithm 1 is told the cube where the arm is, not its configuration
        numbers[0, box.here] = start
    for candidate in box.order if reading.reachable else np.array([closest_cube(box, scene)]):
        if reading.transitions == CHAINED:
            vertices = chained_path(layers, scene, box, numbers, candidate, reading.waiting)
        else:
            edges, reached = edges_towards(box, layers, scene, candidate, reading.waiting)
            if reached:
                look = reading.transitions == EDGES
                vertices = shortest_path(layers, scene, box, numbers, edges, candidate, look)
        if vertices.shape[0] > 0:
            break
    steps = vertices.shape[0] - 1
    if steps < 0:
        return vertices, np.empty((0, scene.q.shape[0]))
    numbers[0, box.here] = start
    chain, blocks = np.zeros(steps + 1, np.int64), np.empty(steps, np.int64)
    for step in range(steps):
        a, b = vertices[step], vertices[step + 1]
        chain[step], chain[step + 1], blocks[step] = _between(layers, scene, box, numbers, a, b, step)
    look = reading.transitions != STEPS or scene.bend_rate < math.inf
    rows = smoothest_path(layers, scene, chain, blocks, look)
    return box.cubes[vertices], layers.configurations.states[rows]
