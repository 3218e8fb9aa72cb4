"""The compiled half of the shared checker and motion validator."""

import math

import numpy as np

from planners.search.rates._kernels import fastest_tip, largest_bend_change, within_rates
from scenarios.kernels.clearance import motion_clear_until, section_clearances
from scenarios.kernels.jit import kernel
from scenarios.kernels.kinematics import ARC_SIZE, section_arcs

GLANCE_S = 2.0  # a motion longer than this is looked at here and there before it is proven free


@kernel
def within_bends(q, max_bend):
    """Whether every section's bend is at most ``max_bend`` [rad]."""
    for i in range(q.shape[0] // 2):
        if not math.hypot(q[2 * i], q[2 * i + 1]) <= max_bend + 1e-9:
            return False
    return True


@kernel
def clearance(q, t, section_length, arm_radius, max_bend, world):
    """Signed distance [m] of the body at ``q`` (2n,) [rad] from the nearest obstacle at ``t``; -inf past the bends."""
    n = q.shape[0] // 2
    if not within_bends(q, max_bend):
        return -math.inf
    return section_clearances(q, t, section_length, arm_radius, world, np.empty((n, ARC_SIZE)), np.empty(n))


@kernel
def tip_distance(q, section_length, point):
    """Distance [m] of the tip from ``point`` (3,) [m]."""
    n = q.shape[0] // 2
    arcs = np.empty((n, ARC_SIZE))
    section_arcs(q, section_length, arcs)
    tip = arcs[n - 1]
    return math.sqrt((tip[12] - point[0]) ** 2 + (tip[13] - point[1]) ** 2 + (tip[14] - point[2]) ** 2)


@kernel
def least_duration(q0, q1, section_length, bend_rate, tip_speed):
    """Shortest time [s] of the straight motion q0 -> q1 at the given rates."""
    return max(largest_bend_change(q0, q1) / bend_rate, fastest_tip(q0, q1, section_length, math.inf) / tip_speed)


@kernel
def least_durations(q, goals, section_length, bend_rate, tip_speed):
    """``least_duration`` from ``q`` (2n,) to each of ``goals`` (K, 2n): (K,) [s]."""
    out = np.empty(goals.shape[0])
    for k in range(goals.shape[0]):
        out[k] = least_duration(q, goals[k], section_length, bend_rate, tip_speed)
    return out


@kernel
def touches_at_a_glance(q0, t0, q1, t1, section_length, arm_radius, world):
    """Whether the motion touches an obstacle at its end or at an instant between, looked at from coarse to fine.

    Most collisions of a long motion are found so, in a fraction of the states that advancing up to them takes.
    """
    n, duration = q0.shape[0] // 2, t1 - t0
    arcs, gaps, q = np.empty((n, ARC_SIZE)), np.empty(n), np.empty(2 * n)
    first, apart = 1.0, 1.0
    while apart * duration > GLANCE_S:
        share = first
        while share <= 1.0:
            for i in range(2 * n):
                q[i] = q0[i] + share * (q1[i] - q0[i])
            if section_clearances(q, t0 + share * duration, section_length, arm_radius, world, arcs, gaps) <= 0.0:
                return True
            share += apart
        first, apart = 0.5 * first, first
    return False


@kernel
def motion_valid(q0, t0, q1, t1, section_length, arm_radius, max_bend, bend_rate, tip_speed, tolerance, world):
    """Whether the motion goes forward in time, within bends and rates, and is free of obstacles at every instant.

    Cheap refusals come first: nine motions of ten that a space-time tree proposes are backward or too fast.
    """
    if not t1 > t0:
        return False
    if not within_bends(q1, max_bend):  # the start was an end before; discs are convex
        return False
    if not within_rates(q0, q1, t1 - t0, section_length, bend_rate, tip_speed):
        return False
    if touches_at_a_glance(q0, t0, q1, t1, section_length, arm_radius, world):
        return False
    share, _ = motion_clear_until(q0, t0, q1, t1, 0.0, tolerance, section_length, arm_radius, world)
    return share >= 1.0
