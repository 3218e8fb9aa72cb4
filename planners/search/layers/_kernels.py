"""Layers of free configurations and the motions between them (paper, section II-E).

A layer holds the free configurations of one cube at one step. A motion between two layers is looked at when a search
wants it, and what was found out is remembered until the next solve. ``scene`` is a ``search.scene.Scene``.
"""

import math
from typing import NamedTuple

import numpy as np

from planners.search.certificate._kernels import Stack, is_motion_free
from planners.search.configurations._kernels import decode, is_code_free, is_free
from planners.search.rates._kernels import within_rates
from scenarios.kernels.clearance import arc_clearances
from scenarios.kernels.jit import bare_kernel, kernel
from scenarios.kernels.kinematics import section_arcs
from scenarios.scenario import STEP_S

NONE = -1
CURRENT = -1  # stands for the arm's present configuration where a code is expected
UNASKED, POSSIBLE, BLOCKED = 0, 1, 2  # what is known of a motion
N_LAYERS, N_CONFIGURATIONS, N_MOTIONS, STATE_CHECKS, MOTION_CHECKS = range(5)  # entries of ``Layers.counts``
STEP, FIRST, END = range(3)  # columns of ``Layers.spans``


class Full(Exception):
    """There is too little room: the solve is to be made again with more."""


class Configurations(NamedTuple):
    """Free configurations, one row each."""

    codes: np.ndarray
    """Shape (capacity,), CURRENT for the present configuration."""
    digits: np.ndarray
    """Lattice numbers of the sections' bends, one more than there are for CURRENT, shape (capacity, n)."""
    states: np.ndarray
    """Bending vectors, shape (capacity, 2n), [rad]."""
    arcs: np.ndarray
    """Laid out when first needed, shape (capacity, n, ARC_SIZE)."""
    gaps: np.ndarray
    """Clearances of the sections at the layer's step, likewise, shape (capacity, n), [m]."""
    is_laid_out: np.ndarray
    """Shape (capacity,)."""
    labels: np.ndarray
    """For a search to write to, NONE at first, shape (capacity,)."""


class Motions(NamedTuple):
    """Motions, those between two layers in one block, row by row."""

    weights: np.ndarray
    """Their smoothness, shape (capacity,), [rad]."""
    answers: np.ndarray
    """What is known of each, shape (capacity,)."""


class Layers(NamedTuple):
    """Layers, and what was found out about the motions between them."""

    configurations: Configurations
    motions: Motions
    spans: np.ndarray
    """Step of each layer, its first configuration and the one after its last, shape (capacity, 3)."""
    blocks: np.ndarray
    """First motion to the layer of the next step in each direction, NONE if not added, shape (capacity, 27)."""
    memo: np.ndarray
    """What is known of the first sections of configurations at each step (``is_code_free``), shape (h + 1, ...)."""
    counts: np.ndarray
    """Layers, configurations and motions there are; states and motions that were checked."""
    stack: Stack
    change: np.ndarray
    """Work space, shape (2n,), [rad]."""


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
def clear(layers):
    """Forget all layers and motions: a new solve begins."""
    layers.counts[:] = 0
    layers.memo[:] = 0


@bare_kernel
def _append(layers, scene, code):
    """Append a configuration."""
    c, k = layers.configurations, layers.counts[N_CONFIGURATIONS]
    c.codes[k], c.is_laid_out[k], c.labels[k] = code, False, NONE
    base, n = scene.space.bends_rad.shape[0], scene.space.n_sections
    if code == CURRENT:
        for i in range(n):
            c.digits[k, i] = base
        for i in range(2 * n):
            c.states[k, i] = scene.q[i]
    else:
        decode(code, scene.space.bends_rad, c.states[k])
        for i in range(n - 1, -1, -1):
            c.digits[k, i] = code % base
            code //= base
    layers.counts[N_CONFIGURATIONS] = k + 1


@bare_kernel
def _open_layer(layers, step, more):
    """Add an empty layer that is to have up to ``more`` configurations; returns its number."""
    number, first = layers.counts[N_LAYERS], layers.counts[N_CONFIGURATIONS]
    if number == layers.spans.shape[0] or first + more > layers.configurations.codes.shape[0]:
        raise Full
    layers.counts[N_LAYERS] += 1
    layers.spans[number, STEP], layers.spans[number, FIRST], layers.spans[number, END] = step, first, first
    for move in range(layers.blocks.shape[1]):
        layers.blocks[number, move] = NONE
    return number


@bare_kernel
def add_start(layers, scene):
    """Add the layer at step 0 that holds the present configuration alone; returns its number."""
    number = _open_layer(layers, 0, 1)
    _append(layers, scene, CURRENT)
    layers.spans[number, END] += 1
    return number


@kernel
def add_layer(layers, scene, cube, step):
    """Add the free configurations of ``cube``, -1 for one off the grid, at ``step``; returns the layer's number.

    The present configuration counts as one of its own cube's, before the others.
    """
    space, is_current = scene.space, cube == scene.cube
    first, end = (space.offsets[cube], space.offsets[cube + 1]) if cube >= 0 else (0, 0)
    number = _open_layer(layers, step, end - first + 1)
    centers, reach = scene.steps.centers_m[step], scene.steps.reach_m[step]
    arcs, memo = layers.stack.arcs[0], layers.memo[step]
    if is_current and is_free(scene.q, scene.section_length, centers, reach, arcs):
        _append(layers, scene, CURRENT)
    for k in range(first, end):
        if is_code_free(space.codes[k], space.n_sections, space.arc_table, centers, reach, memo, arcs):
            _append(layers, scene, space.codes[k])
    layers.spans[number, END] = layers.counts[N_CONFIGURATIONS]
    layers.counts[STATE_CHECKS] += end - first + (1 if is_current else 0)
    return number


@bare_kernel
def size(layers, number):
    """Number of configurations in a layer."""
    return layers.spans[number, END] - layers.spans[number, FIRST]


@kernel
def first_motion(layers, scene, before, after, move):
    """Number of the first motion from layer ``before`` to layer ``after``, its neighbour in direction ``move``.

    That from the a-th to the b-th configuration is a * size(layers, after) + b further on. They are added, none of them
    looked at, when first asked for.
    """
    if layers.blocks[before, move] != NONE:
        return layers.blocks[before, move]
    c, m, block = layers.configurations, layers.motions, layers.counts[N_MOTIONS]
    end = block + size(layers, before) * size(layers, after)
    if end > m.answers.shape[0]:
        raise Full
    layers.blocks[before, move], layers.counts[N_MOTIONS] = block, end
    m.answers[block:end] = UNASKED
    n, base, k = scene.space.n_sections, scene.space.bends_rad.shape[0], block
    change = np.empty((n, base + 1))
    for a in range(layers.spans[before, FIRST], layers.spans[before, END]):
        for i in range(n):
            digit = c.digits[a, i]
            if digit == base:
                change[i] = scene.changes_now[i]
            else:
                change[i, :base] = scene.changes[digit]
                change[i, base] = scene.changes_now[i, digit]
        for b in range(layers.spans[after, FIRST], layers.spans[after, END]):
            weight = 0.0
            for i in range(n):
                weight += change[i, c.digits[b, i]]
            m.weights[k] = weight
            k += 1
    return block


@bare_kernel
def _lay_out(layers, scene, k, time_s):
    """Lay out arcs and clearances of configuration ``k``, which stands at ``time_s`` [s]."""
    c = layers.configurations
    if not c.is_laid_out[k]:
        section_arcs(c.states[k], scene.section_length, c.arcs[k])
        arc_clearances(c.arcs[k], time_s, scene.arm_radius, scene.world, c.gaps[k])
        c.is_laid_out[k] = True


@kernel
def is_possible(layers, scene, before, after, block, a, b):
    """Whether the arm can move from the a-th configuration of layer ``before`` to the b-th of ``after``.

    It can within the limits that bind, and if it touches nothing at any instant (paper, Algorithm 1, line 4).
    """
    motion = block + a * size(layers, after) + b
    answers = layers.motions.answers
    if answers[motion] == UNASKED:
        c, stack = layers.configurations, layers.stack
        a += layers.spans[before, FIRST]
        b += layers.spans[after, FIRST]
        t0 = scene.now_s + layers.spans[before, STEP] * STEP_S
        t1 = scene.now_s + layers.spans[after, STEP] * STEP_S
        layers.counts[MOTION_CHECKS] += 1
        free = within_rates(
            c.states[a], c.states[b], t1 - t0, scene.section_length, scene.bend_rate, scene.tip_speed
        )  # fmt: skip
        if free:
            _lay_out(layers, scene, a, t0)
            _lay_out(layers, scene, b, t1)
            for i in range(stack.arcs.shape[1]):
                stack.gaps[0, i], stack.gaps[1, i] = c.gaps[a, i], c.gaps[b, i]
                for k in range(stack.arcs.shape[2]):
                    stack.arcs[0, i, k], stack.arcs[1, i, k] = c.arcs[a, i, k], c.arcs[b, i, k]
            free = is_motion_free(
                c.states[a], t0, c.states[b], t1, layers.change, scene.section_length, scene.arm_radius, scene.world,
                stack,
            )  # fmt: skip
        answers[motion] = POSSIBLE if free else BLOCKED
    return answers[motion] == POSSIBLE


@kernel
def some_motion(layers, scene, before, after, block):
    """Whether the arm can move from some configuration of layer ``before`` to some of ``after``.

    Motions are asked for from the smoothest on, which are the likeliest.
    """
    width = size(layers, after)
    weights = layers.motions.weights[block : block + size(layers, before) * width]
    if weights.shape[0] == 0:
        return False
    best = np.argmin(weights)
    if is_possible(layers, scene, before, after, block, best // width, best % width):
        return True
    for k in np.argsort(weights):
        if is_possible(layers, scene, before, after, block, k // width, k % width):
            return True
    return False


@kernel
def smoothest_path(layers, scene, chain, blocks, look):
    """Bellman-Ford on a layered graph: its edges relaxed once, in the order of the layers, are final.

    With ``look`` motions have to be possible. All that are not known to be blocked are taken to be so until they are
    on a shortest path; where one is found blocked, another path is looked for. The first of equal ones is taken.

    Args:
        layers: The layers.
        scene: What the solve is about.
        chain: Numbers of the layers, shape (k,).
        blocks: First motion between each of them and the next, shape (k - 1,).
        look: Whether motions are looked at.

    Returns:
        Rows of the path's configurations, shape (k,); empty when there is no path.
    """
    weights, answers, length = layers.motions.weights, layers.motions.answers, chain.shape[0]
    begins = np.zeros(length + 1, np.int64)
    for step in range(length):
        begins[step + 1] = begins[step] + size(layers, chain[step])
    cost, parent = np.zeros(begins[length]), np.full(begins[length], -1)
    path = np.empty(length, np.int64)
    relaxed = 0  # layers up to this one have their final costs
    while True:
        for step in range(relaxed, length - 1):
            n_after, k = size(layers, chain[step + 1]), blocks[step]
            cost[begins[step + 1] : begins[step + 2]] = math.inf
            for a in range(begins[step], begins[step + 1]):
                for b in range(begins[step + 1], begins[step + 1] + n_after):
                    through = cost[a] + weights[k]
                    if through < cost[b] and answers[k] != BLOCKED:
                        cost[b], parent[b] = through, a
                    k += 1
        last = cost[begins[length - 1] :]
        if last.shape[0] == 0 or not math.isfinite(last.min()):
            return path[:0]
        k = begins[length - 1] + np.argmin(last)
        for step in range(length - 1, -1, -1):
            path[step] = k - begins[step]
            k = parent[k]
        relaxed = length
        if look:
            for step in range(length - 1):
                before, after = chain[step], chain[step + 1]
                if not is_possible(layers, scene, before, after, blocks[step], path[step], path[step + 1]):
                    relaxed = step
                    break
        if relaxed == length:
            for step in range(length):
                path[step] += layers.spans[chain[step], FIRST]
            return path


@kernel
def layered_graph(layers, scene, cubes):
    """Add layers of the cubes on a path, (k,) numbers, one per step, and the motions between them.

    Returns:
        Their numbers and those of the first motions between them, as ``smoothest_path`` takes them.
    """
    clear(layers)
    chain, blocks = np.empty(cubes.shape[0], np.int64), np.empty(cubes.shape[0] - 1, np.int64)
    chain[0] = add_start(layers, scene)
    for step in range(1, cubes.shape[0]):
        chain[step] = add_layer(layers, scene, cubes[step], step)
        # One way on from each layer: any direction will do.
        blocks[step - 1] = first_motion(layers, scene, chain[step - 1], chain[step], 0)
    return chain, blocks
