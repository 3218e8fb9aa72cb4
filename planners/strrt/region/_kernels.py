"""Progressive expansion of the goal region and conditional sampling.

Algorithms 2 to 5 of Grothe, Hartmann, Orthey and Toussaint, ICRA 2022 (arXiv 2203.02176).
"""

import math
from typing import NamedTuple

import numpy as np

from planners.problem._kernels import clearance, least_duration
from planners.search.randomness._kernels import random_posture, uniform
from planners.strrt.trees._kernels import add_node, least_time, place_tip
from scenarios.kernels.jit import kernel

DRAWS = 100  # configurations drawn until one can lie on a path


class Parameters(NamedTuple):
    """The paper's p_goal, P and lambda, and what else steers a search."""

    p_goal: float
    range_factor: float
    initial_batch_size: float
    sample_ratio: float
    weight: float
    reach: float
    rewiring: bool
    t_limit: float
    """Latest arrival considered [s]."""


class Bound(NamedTuple):
    """The paper's B: how far the goal region has been expanded."""

    time_range: float
    new_time_range: float
    batch_size: float
    samples_in_batch: float
    total_samples: float
    batch_probability: float
    """Share of samples for the region before its last expansion."""
    t_max: float
    """Arrival of the best path [s], infinite before there is one."""


class Goals(NamedTuple):
    """The goal configurations."""

    states: np.ndarray
    """Shape (K, 2n), [rad]."""
    tips: np.ndarray
    """Shape (K, 3), [m]."""
    least: np.ndarray
    """Least duration of the straight motion from the start, shape (K,), [s]; NaN until it is first needed."""


@kernel
def initialize_bound(p):
    """Algorithm 2."""
    return Bound(p.range_factor, p.range_factor, p.initial_batch_size, 0.0, 0.0, 1.0, math.inf)


@kernel
def count_sample(b):
    """One more sample in this batch and in all."""
    return Bound(
        b.time_range,
        b.new_time_range,
        b.batch_size,
        b.samples_in_batch + 1.0,
        b.total_samples + 1.0,
        b.batch_probability,
        b.t_max,
    )


@kernel
def update_goal_region(b, p, goal_tree):
    """Algorithm 3: a full batch without a path expands the goal region."""
    if b.t_max < math.inf or b.samples_in_batch < b.batch_size:
        return b
    goal_tree.fresh[: goal_tree.size[0]] = False
    return Bound(
        b.new_time_range,
        b.new_time_range * p.range_factor,
        (p.range_factor - 1.0) * b.total_samples / p.sample_ratio,
        0.0,
        b.total_samples,
        (1.0 - p.sample_ratio) / p.range_factor,
        b.t_max,
    )


@kernel
def sample_goal(b, p, rng, goals, arm, world, start_tree, goal_tree, work):
    """Algorithm 4: a goal at a time of arrival becomes a root of the goal tree; returns it, -1 where it is not free."""
    g = int(goals.least.shape[0] * uniform(rng))
    if math.isnan(goals.least[g]):
        q = start_tree.states[0]
        goals.least[g] = least_duration(q, goals.states[g], arm.section_length, arm.bend_rate, arm.tip_speed)
    t_start, least, old = start_tree.times[0], goals.least[g], uniform(rng) < b.batch_probability
    from_s, until_s = least, least * b.time_range
    if b.t_max < math.inf:
        until_s = b.t_max - t_start
    elif not old:
        from_s, until_s = until_s, least * b.new_time_range
    until_s = min(until_s, p.t_limit - t_start)
    if from_s > until_s:
        return -1
    time = t_start + from_s + (until_s - from_s) * uniform(rng)
    work.checks[0] += 1
    if clearance(goals.states[g], time, arm.section_length, arm.radius, arm.max_bend, world) <= 0.0:
        return -1
    root = add_node(goal_tree, goals.states[g], time, -1, arm, work)
    if root >= 0:
        goal_tree.fresh[root] = not old and b.t_max == math.inf
    return root


@kernel
def max_valid_time(q, tip, fresh, arm, goal_tree):
    """Equation (2): the latest time [s] to leave ``q`` (2n,) [rad] for one of the goals; -inf without goals."""
    latest = -math.inf
    for k in range(goal_tree.size[0]):
        if goal_tree.parents[k] < 0 and goal_tree.fresh[k] == fresh:
            latest = max(latest, goal_tree.times[k] - least_time(q, tip, goal_tree.states[k], goal_tree.tips[k], arm))
    return latest


@kernel
def sample_conditionally(b, rng, arm, start_tree, goal_tree, work):
    """Algorithm 5: a state that can lie on a path into ``work``; returns (earliest, drawn, latest) time [s].

    The drawn time is NaN when no configuration of ``DRAWS`` has one.
    """
    for _ in range(DRAWS):
        random_posture(rng, arm.max_bend, work.state)
        place_tip(work.state, arm.section_length, work.arcs, work.tip)
        earliest = start_tree.times[0] + least_time(start_tree.states[0], start_tree.tips[0], work.state, work.tip, arm)
        latest = max_valid_time(work.state, work.tip, False, arm, goal_tree)
        if uniform(rng) >= b.batch_probability:
            earliest = max(earliest, latest)
            latest = max_valid_time(work.state, work.tip, True, arm, goal_tree)
        if earliest < latest:
            return earliest, earliest + (latest - earliest) * uniform(rng), latest
    return math.nan, math.nan, math.nan
