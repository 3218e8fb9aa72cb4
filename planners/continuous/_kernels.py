"""A space-time tree whose branches are steered runs: docs/temporal-ct.md tells why.

A branch runs from a node towards a point for the tip and a posture for the body, one steered step after another, until
it arrives, has run its length, or is blocked. Every step is certified collision-free at every instant.
"""

import math
from typing import NamedTuple

import numpy as np

from planners.search.certificate._kernels import CONTACT_M, is_clear
from planners.search.randomness._kernels import random_posture, uniform
from planners.search.steering._kernels import ARRIVED_M, least_duration, steer
from scenarios.kernels.clearance import arc_clearances
from scenarios.kernels.jit import bare_kernel, kernel
from scenarios.kernels.kinematics import section_arcs, tip_jacobian

BLOCKED, RAN, REACHED, FULL = range(4)  # how a branch ended

DIRECT_RUNS = 4  # straight for the goal, before anything else is tried
GOAL_SHARE, EXPLORING_SHARE = 0.4, 0.4  # of the branches; the rest waits, or turns the body with the tip at rest
REFINING_SHARE = 0.5  # of the branches once the goal was reached
LONGEST_DETOUR = 20  # steps of a branch that does not run for the goal
BOUNCE_BACK = 8  # a blocked branch goes back by fewer nodes than this
FAILURE_WEIGHT = 0.3  # a node from which a branch failed at once looks farther away by this share
ESCAPE_M = 2e-4  # an arm that is too close to an obstacle may come closer by this in a step of its way out
COMPARED = 256  # nodes that the search for a near one looks at, spread evenly over the tree


class Budget(NamedTuple):
    """How a search goes about its work, and how much of it."""

    iterations: int
    """Branches until the goal is reached."""
    refinements: int
    """Branches after that."""
    bounces: int
    """New postures that a blocked branch tries."""
    enough: float
    """A way to the goal this many times as long as the straight one, in time, is not refined further."""
    duration: float
    """Of a step [s]."""
    margin: float
    """Clearance to keep [m]."""


class Tree(NamedTuple):
    """Preallocated; node k was reached from ``parents[k]`` by one linear motion."""

    states: np.ndarray
    """Bending vectors, shape (capacity, 2n), [rad]."""
    tips: np.ndarray
    """Tip positions, shape (capacity, 3), [m]."""
    times: np.ndarray
    """Shape (capacity,), [s]."""
    parents: np.ndarray
    """Index of the parent, -1 at the root, shape (capacity,)."""
    failures: np.ndarray
    """Branches from here that were blocked at once, shape (capacity,)."""
    counts: np.ndarray
    """Nodes in the tree, states checked, motions checked."""


@bare_kernel
def _copy(values, out):
    """Copy one array into another of the same length; ``out[:] = values`` would make a third, lest the two overlap."""
    for k in range(out.shape[0]):
        out[k] = values[k]


@bare_kernel
def _append(tree, state, tip, time, parent):
    """Append a node; returns its index."""
    k = tree.counts[0]
    tree.counts[0] = k + 1
    _copy(state, tree.states[k])
    _copy(tip, tree.tips[k])
    tree.times[k] = time
    tree.parents[k] = parent
    tree.failures[k] = 0
    return k


@bare_kernel
def _stand(q, time, body, world, stack):
    """Lay out arcs and clearances at ``q`` in row 0 of the stack."""
    section_arcs(q, body.section_length, stack.arcs[0])
    arc_clearances(stack.arcs[0], time, body.radius, world, stack.gaps[0])


@bare_kernel
def _gap(stack):
    """Clearance of the state in row 0 of the stack [m]."""
    gap = math.inf
    for i in range(stack.gaps.shape[1]):
        gap = min(gap, stack.gaps[0, i])
    return gap


@bare_kernel
def _is_free(tree, node, change, time, margin, body, world, stack):
    """Whether the step from ``node`` to ``time``, laid out in the stack, is free; counts what it took.

    An arm that stands closer than the margin to where obstacles may be has to get out without coming closer.
    """
    gap = _gap(stack)
    if gap <= margin + CONTACT_M:
        margin = gap - CONTACT_M - ESCAPE_M
    free, states = is_clear(
        tree.states[node], tree.times[node], change, time, margin, body.section_length, body.radius, world, stack
    )
    tree.counts[1] += states
    tree.counts[2] += 1
    return free


@bare_kernel
def plant(tree, times, states, margin, body, world, step, stack):
    """Start the tree with the leading part of a path, times (k,) [s] and states (k, 2n) [rad], that is still free."""
    tip_of, last = stack.arcs[:, :, 12:15], stack.arcs.shape[1] - 1
    tree.counts[0] = 0
    _stand(states[0], times[0], body, world, stack)
    _append(tree, states[0], tip_of[0, last], times[0], -1)
    for k in range(1, times.shape[0]):
        for c in range(step.change.shape[0]):
            step.change[c] = states[k, c] - states[k - 1, c]
        section_arcs(states[k], body.section_length, stack.arcs[1])
        if not _is_free(tree, k - 1, step.change, times[k], margin, body, world, stack):
            break
        _append(tree, states[k], tip_of[1, last], times[k], k - 1)


@bare_kernel
def grow(tree, node, target, stop, steps, end_time, bounces, budget, rng, body, world, step, stack):
    """Grow a branch of at most ``steps`` from ``node`` to ``target``; returns how it ended and its last node.

    The tip stops within ``stop`` [m] of its target, which ends the branch; with 0 the tip stays there while the body
    turns. A blocked branch goes back a little and tries another posture, up to ``bounces`` times.
    """
    first, standing = node, False
    tip = stack.arcs[1, stack.arcs.shape[1] - 1, 12:15]
    while steps > 0:
        if tree.counts[0] >= tree.times.shape[0]:
            return FULL, node
        if not standing:
            _stand(tree.states[node], tree.times[node], body, world, stack)
            tip_jacobian(stack.arcs[0], body.section_length, step.jacobian)
            standing = True
        steer(tree.states[node], tree.tips[node], target, stop, budget.duration, body, step)
        section_arcs(step.state, body.section_length, stack.arcs[1])
        tip_jacobian(stack.arcs[1], body.section_length, step.jacobian_after)
        duration = least_duration(tree.tips[node], tip, body, step)
        left = _distance(tip, target.point) - stop if stop > 0.0 else 0.0
        reached = stop > 0.0 and left <= ARRIVED_M
        if not reached:
            duration = max(duration, budget.duration)
        time = tree.times[node] + duration
        if time + max(0.0, left) / body.tip_speed > end_time:  # at best it would arrive too late
            return RAN, node
        if not _is_free(tree, node, step.change, time, budget.margin, body, world, stack):
            if node == first:
                tree.failures[node] += 1
            if bounces == 0:
                return BLOCKED, node
            bounces -= 1
            for _ in range(int(BOUNCE_BACK * uniform(rng))):
                node = tree.parents[node] if node != first else node
            random_posture(rng, body.max_bend, target.posture)
            standing = False
            continue
        node = _append(tree, step.state, tip, time, node)
        for r in range(3):
            _copy(step.jacobian_after[r], step.jacobian[r])
        steps -= 1
        if reached:
            return BLOCKED if _gap(stack) <= budget.margin + CONTACT_M else REACHED, node
    return RAN, node


@bare_kernel
def _distance(a, b):
    """Distance between two points (3,) [m]."""
    return math.sqrt((a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2 + (a[2] - b[2]) ** 2)


@bare_kernel
def near_node(tree, target, before, goal, stop, bound, rng, body):
    """A node not later than ``before`` [s] that is near ``target``; -1 when there is none.

    Distance is time: that of the tip's way and those of the bends at their limits, as the root of their squares. Nodes
    from which the goal cannot be reached before ``bound`` [s] are passed over. In a large tree a share is looked at.
    """
    best, found = math.inf, -1
    stride = 1 + tree.counts[0] // COMPARED
    per_tip, per_bend = 1.0 / body.tip_speed**2, 1.0 / body.bend_rate**2
    for k in range(int(stride * uniform(rng)), tree.counts[0], stride):
        if tree.times[k] > before:
            continue
        way = turn = 0.0
        for r in range(3):
            way += (tree.tips[k, r] - target.point[r]) ** 2
        shunned = (1.0 + FAILURE_WEIGHT * tree.failures[k]) ** 2
        if per_tip * way * shunned >= best:  # the posture can only add to that
            continue
        for c in range(target.posture.shape[0]):
            turn += (tree.states[k, c] - target.posture[c]) ** 2
        far = (per_tip * way + per_bend * turn) * shunned
        if far >= best:
            continue
        if bound < math.inf and tree.times[k] + (_distance(tree.tips[k], goal) - stop) / body.tip_speed >= bound:
            continue
        best, found = far, k
    return found


@bare_kernel
def _depth(tree, node):
    """Number of nodes from the root to ``node``, both counted."""
    length = 0
    while node >= 0:
        length, node = length + 1, tree.parents[node]
    return length


@kernel
def nodes_to(tree, node):
    """The nodes from the root to ``node``, in this order."""
    nodes = np.empty(_depth(tree, node), np.int64)
    for k in range(nodes.shape[0] - 1, -1, -1):
        nodes[k] = node
        node = tree.parents[node]
    return nodes


@bare_kernel
def _ancestor(tree, node, rng):
    """A node drawn from the path to ``node``."""
    for _ in range(int(_depth(tree, node) * uniform(rng))):
        node = tree.parents[node]
    return node


@bare_kernel
def _choose(tree, tried, trunk, best, goal, stop, end_time, rng, body, target, stack):
    """Where the next branch leaves the tree (-1: nowhere) and how it runs: node, stop [m], steps; sets ``target``."""
    random_posture(rng, body.max_bend, target.posture)
    _copy(goal, target.point)
    unlimited = tree.times.shape[0]
    if best < 0 and tried < DIRECT_RUNS:
        node = 0 if tried < DIRECT_RUNS // 2 else int(trunk * uniform(rng))
        if tried == 0:
            _copy(tree.states[0], target.posture)
        return node, stop, unlimited
    if best >= 0 and uniform(rng) < REFINING_SHARE:
        return _ancestor(tree, best, rng), stop, unlimited
    kind, bound = uniform(rng), math.inf if best < 0 else tree.times[best]
    before = tree.times[0] + (min(bound, end_time) - tree.times[0]) * uniform(rng)
    if kind < GOAL_SHARE:
        return near_node(tree, target, before, goal, stop, bound, rng, body), stop, unlimited
    steps = 1 + int(LONGEST_DETOUR * uniform(rng))
    if kind < GOAL_SHARE + EXPLORING_SHARE:
        section_arcs(target.posture, body.section_length, stack.arcs[1])
        _copy(stack.arcs[1, stack.arcs.shape[1] - 1, 12:15], target.point)
        return near_node(tree, target, before, goal, stop, bound, rng, body), 0.0, steps
    node = int(tree.counts[0] * uniform(rng))
    _copy(tree.tips[node], target.point)
    if uniform(rng) < 0.5:
        _copy(tree.states[node], target.posture)
    return node, 0.0, steps


@bare_kernel
def search(goal, stop, end_time, budget, rng, body, world, tree, target, step, stack):
    """Grow the planted tree until its tip is within ``stop`` [m] of ``goal`` (3,), then refine the way there.

    Returns:
        The node with the earliest arrival (-1: none), and the node that stays safe longest.
    """
    root_time, trunk, best = tree.times[0], tree.counts[0], -1
    soonest = max(0.0, _distance(tree.tips[0], goal) - stop) / body.tip_speed
    tried, left = 0, budget.iterations
    while left > 0:
        node, reach, steps = _choose(tree, tried, trunk, best, goal, stop, end_time, rng, body, target, stack)
        tried, left = tried + 1, left - 1
        if node < 0:
            continue
        latest = end_time if best < 0 else tree.times[best]
        bounces = budget.bounces if best < 0 else 0
        ended, last = grow(tree, node, target, reach, steps, latest, bounces, budget, rng, body, world, step, stack)
        if ended == FULL:
            break
        if ended == REACHED and (best < 0 or tree.times[last] < tree.times[best]):
            left = left if best >= 0 else budget.refinements
            best = last
            if tree.times[best] - root_time <= budget.enough * soonest:
                break
    return best, _latest(tree)


@bare_kernel
def _latest(tree):
    """The node at the latest time, the first of several."""
    latest = 0
    for k in range(1, tree.counts[0]):
        latest = k if tree.times[k] > tree.times[latest] else latest
    return latest
