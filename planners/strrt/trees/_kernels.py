"""Trees in space-time: the distance between states, near nodes, growing and pruning.

The distance is (1) of Grothe, Hartmann, Orthey and Toussaint, ICRA 2022 (arXiv 2203.02176), its words are theirs.
"""

import math
from typing import NamedTuple

import numpy as np

from planners.problem._kernels import least_duration, motion_valid
from planners.search.rates._kernels import within_rates
from scenarios.kernels.jit import kernel
from scenarios.kernels.kinematics import section_arcs

TRAPPED, ADVANCED, REACHED = range(3)  # how growing a tree ended

GLANCES = 6  # places at which a motion's tip is looked at before its least duration is computed
RESERVE = 1.0 + 1e-6  # on the least duration of a motion, for rounding


class Arm(NamedTuple):
    """The arm's numbers as kernels take them."""

    section_length: float
    radius: float
    max_bend: float
    bend_rate: float
    tip_speed: float
    tolerance: float


class Tree(NamedTuple):
    """Preallocated; a node of the start tree is left for later ones, a node of the goal tree leads on to its parent."""

    states: np.ndarray
    """Bending vectors, shape (capacity, 2n), [rad]."""
    tips: np.ndarray
    """Tip positions, shape (capacity, 3), [m]."""
    times: np.ndarray
    """Shape (capacity,), [s]."""
    parents: np.ndarray
    """Index of the parent, -1 at a root, shape (capacity,)."""
    arrivals: np.ndarray
    """Time of the node's root, shape (capacity,), [s]; in the goal tree, when a path through the node arrives."""
    joined: np.ndarray
    """In the goal tree: the start tree's node at the same state and time, -1 where there is none, shape (capacity,)."""
    fresh: np.ndarray
    """Whether a root is a goal of the newly expanded region, shape (capacity,)."""
    size: np.ndarray
    """Number of nodes, shape (1,)."""


class Work(NamedTuple):
    """What a search works in."""

    state: np.ndarray
    """State to grow towards, shape (2n,), [rad]."""
    tip: np.ndarray
    """Its tip, shape (3,), [m]."""
    step: np.ndarray
    """State that is grown to, shape (2n,), [rad]."""
    glance: np.ndarray
    """State on the way, shape (2n,), [rad]."""
    arcs: np.ndarray
    """Of the arm at a state, shape (n, ARC_SIZE)."""
    far: np.ndarray
    """Distances of the nodes, shape (capacity,), [s]."""
    near: np.ndarray
    """Near nodes, shape (capacity,)."""
    checks: np.ndarray
    """Numbers of states and of motions checked, shape (2,)."""


@kernel
def place_tip(q, section_length, arcs, tip):
    """Tip position at ``q`` (2n,) [rad] into ``tip`` (3,) [m]."""
    section_arcs(q, section_length, arcs)
    for r in range(3):
        tip[r] = arcs[arcs.shape[0] - 1, 12 + r]


@kernel
def least_time(q0, tip0, q1, tip1, arm):
    """Lower bound [s] on any way between two configurations: of every section's turn, and of the tip along a chord.

    The paper's d_Q / v_max. It is a metric; a straight motion takes as long or longer (``least_duration``).
    """
    turn = 0.0
    for i in range(0, q0.shape[0], 2):
        turn = max(turn, (q1[i] - q0[i]) ** 2 + (q1[i + 1] - q0[i + 1]) ** 2)
    way = (tip1[0] - tip0[0]) ** 2 + (tip1[1] - tip0[1]) ** 2 + (tip1[2] - tip0[2]) ** 2
    return max(math.sqrt(turn) / arm.bend_rate, math.sqrt(way) / arm.tip_speed)


@kernel
def distance(least, duration, weight):
    """Distance (1) of the paper between states ``duration`` [s] apart whose least time is ``least`` [s].

    Infinite backward in time and where the rates do not suffice: a pseudometric, as it is not symmetric.
    """
    if duration <= 0.0 or least > duration:
        return math.inf
    return weight * least + (1.0 - weight) * duration


@kernel
def near_nodes(tree, forward, time, count, weight, arm, work):
    """The ``count`` nodes nearest to ``work.state`` at ``time`` [s] into ``work.near``; how many there are.

    In the order in which they are tried: of the start tree the nearest first, of the goal tree what arrives first.
    """
    n, found = tree.size[0], 0
    for k in range(n):
        least = least_time(tree.states[k], tree.tips[k], work.state, work.tip, arm)
        duration = time - tree.times[k] if forward else tree.times[k] - time
        work.far[k] = distance(least, duration, weight)
    while found < count:
        k = 0
        for other in range(1, n):
            if work.far[other] < work.far[k]:
                k = other
        if n == 0 or work.far[k] == math.inf:
            break
        work.far[k] = math.inf
        place = found
        if not forward:  # insertion keeps the order of arrival
            while place > 0 and tree.arrivals[work.near[place - 1]] > tree.arrivals[k]:
                work.near[place] = work.near[place - 1]
                place -= 1
        work.near[place] = k
        found += 1
    return found


@kernel
def add_node(tree, state, time, parent, arm, work):
    """Append a node; returns its index, -1 when the tree is full."""
    k = tree.size[0]
    if k >= tree.times.shape[0]:
        return -1
    tree.size[0] = k + 1
    tree.states[k, :] = state
    place_tip(state, arm.section_length, work.arcs, tree.tips[k])
    tree.times[k] = time
    tree.parents[k] = parent
    tree.arrivals[k] = time if parent < 0 else tree.arrivals[parent]
    tree.joined[k] = -1
    tree.fresh[k] = False
    return k


@kernel
def is_free(q0, t0, q1, t1, arm, world, work):
    """Whether the shared motion validator's kernel allows the motion."""
    work.checks[1] += 1
    return motion_valid(
        q0, t0, q1, t1, arm.section_length, arm.radius, arm.max_bend, arm.bend_rate, arm.tip_speed, arm.tolerance, world
    )


@kernel
def straight_time(q0, tip0, q1, arm, work):
    """Lower bound [s] on the straight motion's least duration, by its tip at a few places."""
    fastest, x, y, z = 0.0, tip0[0], tip0[1], tip0[2]
    for k in range(1, GLANCES + 1):
        for i in range(q0.shape[0]):
            work.glance[i] = q0[i] + (q1[i] - q0[i]) * k / GLANCES
        section_arcs(work.glance, arm.section_length, work.arcs)
        tip = work.arcs[work.arcs.shape[0] - 1]
        fastest = max(fastest, (tip[12] - x) ** 2 + (tip[13] - y) ** 2 + (tip[14] - z) ** 2)
        x, y, z = tip[12], tip[13], tip[14]
    return GLANCES * math.sqrt(fastest) / arm.tip_speed


@kernel
def grow(tree, forward, node, time, limit, reach, weight, arm, world, work):
    """Grow ``tree`` from ``node`` towards ``work.state`` at ``time`` [s]; returns how it ended and the new node.

    A motion is no longer than ``reach`` [s], in the distance. One that the rates do not allow in the time it is given
    takes its least duration, unless it then ends beyond ``limit`` [s].
    """
    q, t = tree.states[node], tree.times[node]
    least = least_time(q, tree.tips[node], work.state, work.tip, arm)
    share = min(1.0, reach / distance(least, abs(time - t), weight))
    for i in range(q.shape[0]):
        # The whole way ends at the very state: where trees join, it is one.
        work.step[i] = q[i] + share * (work.state[i] - q[i]) if share < 1.0 else work.state[i]
    there = t + share * (time - t) if share < 1.0 else time
    room = abs((time if share < 1.0 else limit) - t)
    if straight_time(q, tree.tips[node], work.step, arm, work) > room:
        return TRAPPED, -1
    reached = share == 1.0
    if not within_rates(q, work.step, abs(there - t), arm.section_length, arm.bend_rate, arm.tip_speed):
        if room <= abs(there - t):
            return TRAPPED, -1
        needed = RESERVE * least_duration(q, work.step, arm.section_length, arm.bend_rate, arm.tip_speed)
        if needed > room:
            return TRAPPED, -1
        there = t + needed if forward else t - needed
        reached = False
    if forward:
        free = is_free(q, t, work.step, there, arm, world, work)
    else:
        free = is_free(work.step, there, q, t, arm, world, work)
    new = add_node(tree, work.step, there, node, arm, work) if free else -1
    if new < 0:
        return TRAPPED, -1
    return REACHED if reached else ADVANCED, new


@kernel
def keep_nodes(tree, kept, index):
    """Drop every node but those ``kept`` (capacity,), whose parents are kept too; new places into ``index``."""
    n, left = tree.size[0], 0
    for k in range(n):
        index[k] = left if kept[k] else -1
        left += kept[k]
    for k in range(n):
        to = index[k]
        if to < 0:
            continue
        tree.states[to, :] = tree.states[k]
        tree.tips[to, :] = tree.tips[k]
        tree.times[to] = tree.times[k]
        tree.parents[to] = -1 if tree.parents[k] < 0 else index[tree.parents[k]]
        tree.arrivals[to] = tree.arrivals[k]
        tree.joined[to] = tree.joined[k]
        tree.fresh[to] = tree.fresh[k]
    tree.size[0] = left
