"""ST-RRT*: bidirectional trees in space-time, asymptotically optimal in the time of arrival.

Algorithm 1 of Grothe, Hartmann, Orthey and Toussaint, ICRA 2022 (arXiv 2203.02176), and what it calls; Algorithms 2
to 5 are in ``region``. ``docs/strrt.md`` says where and why they differ.
"""

import math

import numpy as np

from planners.search.randomness._kernels import uniform
from planners.strrt.region._kernels import (
    Bound,
    count_sample,
    sample_conditionally,
    sample_goal,
    update_goal_region,
)
from planners.strrt.trees._kernels import (
    ADVANCED,
    TRAPPED,
    distance,
    grow,
    is_free,
    keep_nodes,
    least_time,
    near_nodes,
)
from scenarios.kernels.jit import kernel

HALVINGS = 3  # of a blocked motion
K_RRT = math.e * (1.0 + 1.0 / 7.0)  # near nodes per logarithm of the tree's size: RRT*'s k for six bends and time


@kernel
def try_near(tree, forward, time, limit, p, arm, world, work):
    """Grow towards ``work.state`` at ``time`` [s] from one near node after another; how it ended, and the new node."""
    count = math.ceil(K_RRT * math.log(tree.size[0] + 1.0)) if p.rewiring else 1
    for i in range(near_nodes(tree, forward, time, count, p.weight, arm, work)):
        ended, new = grow(tree, forward, work.near[i], time, limit, p.reach, p.weight, arm, world, work)
        if ended != TRAPPED:
            return ended, new
    return TRAPPED, -1


@kernel
def extend(tree, forward, time, limit, p, arm, world, work):
    """EXTEND: ``try_near``, and where all is blocked half of the nearest motion, a quarter and so on."""
    ended, new = try_near(tree, forward, time, limit, p, arm, world, work)
    if ended == TRAPPED and near_nodes(tree, forward, time, 1, p.weight, arm, work) > 0:
        k, reach = work.near[0], p.reach
        least = least_time(tree.states[k], tree.tips[k], work.state, work.tip, arm)
        reach = min(reach, distance(least, abs(time - tree.times[k]), p.weight))
        for _ in range(HALVINGS):
            reach *= 0.5
            ended, new = grow(tree, forward, k, time, limit, reach, p.weight, arm, world, work)
            if ended != TRAPPED:
                break
    return ended, new


@kernel
def connect(tree, forward, other, node, p, arm, world, work):
    """CONNECT ``tree`` to ``node`` of the ``other``: grow until it is reached or trapped; its node, -1 if trapped."""
    work.state[:] = other.states[node]
    work.tip[:] = other.tips[node]
    time = other.times[node]
    ended, new = try_near(tree, forward, time, time, p, arm, world, work)
    while ended == ADVANCED:
        ended, new = grow(tree, forward, new, time, time, p.reach, p.weight, arm, world, work)
    return new


@kernel
def rewire(goal_tree, new, p, arm, world, work):
    """Simplified rewiring: near nodes of the goal tree go on through ``new`` where they then arrive earlier."""
    work.state[:] = goal_tree.states[new]
    work.tip[:] = goal_tree.tips[new]
    time = goal_tree.times[new]
    count = math.ceil(K_RRT * math.log(goal_tree.size[0] + 1.0))
    for i in range(near_nodes(goal_tree, True, time, count, p.weight, arm, work)):
        k = work.near[i]
        if goal_tree.arrivals[new] < goal_tree.arrivals[k] and is_free(
            goal_tree.states[k], goal_tree.times[k], work.state, time, arm, world, work
        ):
            goal_tree.parents[k] = new
    # Arrivals of whole branches follow, latest nodes first: a parent is later than its children.
    order = np.argsort(-goal_tree.times[: goal_tree.size[0]])
    for k in order:
        if goal_tree.parents[k] >= 0:
            goal_tree.arrivals[k] = goal_tree.arrivals[goal_tree.parents[k]]


@kernel
def best_join(goal_tree):
    """The node of the goal tree through which a path from the start arrives first; -1 when no path has been found."""
    best = -1
    for k in range(goal_tree.size[0]):
        if goal_tree.joined[k] >= 0 and (best < 0 or goal_tree.arrivals[k] < goal_tree.arrivals[best]):
            best = k
    return best


@kernel
def prune(t_max, goals, arm, start_tree, goal_tree, work):
    """PRUNETREES: drop what cannot be part of a path that arrives by ``t_max`` [s]."""
    kept, index = np.zeros(goal_tree.times.shape[0], np.bool_), work.near
    for k in range(start_tree.size[0]):
        for g in range(goals.least.shape[0]):
            least = least_time(start_tree.states[k], start_tree.tips[k], goals.states[g], goals.tips[g], arm)
            if start_tree.times[k] + least <= t_max + 1e-9:
                kept[k] = True
                break
    keep_nodes(start_tree, kept, index)
    for k in range(goal_tree.size[0]):
        if goal_tree.joined[k] >= 0:
            goal_tree.joined[k] = index[goal_tree.joined[k]]
        kept[k] = goal_tree.arrivals[k] <= t_max
    keep_nodes(goal_tree, kept, index)


@kernel
def update_solution(b, goals, arm, start_tree, goal_tree, work):
    """UPDATESOLUTION and what follows: an earlier arrival bounds all times from now on, and the trees are pruned."""
    best = best_join(goal_tree)
    if best < 0 or goal_tree.arrivals[best] >= b.t_max:
        return b
    t_max = goal_tree.arrivals[best]
    goal_tree.fresh[: goal_tree.size[0]] = False
    prune(t_max, goals, arm, start_tree, goal_tree, work)
    return Bound(b.time_range, b.new_time_range, b.batch_size, b.samples_in_batch, b.total_samples, 1.0, t_max)


@kernel
def search(first, last, b, p, rng, goals, arm, world, start_tree, goal_tree, work):
    """Algorithm 1, its iterations ``first`` <= i < ``last``, no further than the first path; the trees swap at each.

    Returns:
        The bound B, and the iteration to go on with.
    """
    found = b.t_max < math.inf
    for i in range(first, last):
        if b.t_max < math.inf and not found:
            return b, i
        b = update_goal_region(b, p, goal_tree)
        b = count_sample(b)
        if goal_tree.size[0] == 0 or uniform(rng) <= p.p_goal:
            root = sample_goal(b, p, rng, goals, arm, world, start_tree, goal_tree, work)
            if root >= 0:
                goal_tree.joined[root] = connect(start_tree, True, goal_tree, root, p, arm, world, work)
                b = update_solution(b, goals, arm, start_tree, goal_tree, work)
        if goal_tree.size[0] == 0:
            continue
        earliest, time, latest = sample_conditionally(b, rng, arm, start_tree, goal_tree, work)
        if math.isnan(time):
            continue
        if i % 2 == 0:  # even: the start tree's turn
            ended, new = extend(start_tree, True, time, latest, p, arm, world, work)
            if ended != TRAPPED:
                there = connect(goal_tree, False, start_tree, new, p, arm, world, work)
                if there >= 0:
                    goal_tree.joined[there] = new
        else:
            ended, new = extend(goal_tree, False, time, earliest, p, arm, world, work)
            if ended != TRAPPED:
                if p.rewiring:
                    rewire(goal_tree, new, p, arm, world, work)
                goal_tree.joined[new] = connect(start_tree, True, goal_tree, new, p, arm, world, work)
        b = update_solution(b, goals, arm, start_tree, goal_tree, work)
    return b, last
