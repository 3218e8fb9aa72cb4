"""Compiled checks of a motion by itself: states that cannot be, arrival, limits. docs/audit.md derives the bounds."""

import math

import numpy as np

from scenarios.kernels.jit import kernel
from suite.auditor._kernels import interpolate, tip

SAME_TIME_S = 1e-9
SAME_CONFIGURATION_RAD = 1e-9
SAME_START_RAD = 1e-6
BEND_SLACK_RAD = 1e-6
ARRIVAL_SLACK_M = 1e-9
LIMIT_SLACK = 1e-3
FOUND_WIDTH = 1e-3  # of a motion: how closely the first excess of the tip's speed is located
LEAST_WIDTH = 1e-6  # what is not proven at this width counts as excess

OK, NOT_FINITE, WRONG_START, BACKWARD_TIME, JUMP, BEND_LIMIT, BEND_RATE, TIP_SPEED = range(8)


@kernel
def _is_finite(q):
    for c in range(q.shape[0]):
        if not math.isfinite(q[c]):
            return False
    return True


@kernel
def _difference(a, b):
    """Largest difference between two configurations in any number."""
    largest = 0.0
    for c in range(a.shape[0]):
        largest = max(largest, abs(a[c] - b[c]))
    return largest


@kernel
def first_lie(times, configurations, start, max_bend):
    """Number of timed states before the first that cannot be, and what is wrong with that one (OK: nothing)."""
    for k in range(times.shape[0]):
        q = configurations[k]
        if not (math.isfinite(times[k]) and _is_finite(q)):
            return k, NOT_FINITE
        if k == 0 and (times[0] != 0.0 or _difference(q, start) > SAME_START_RAD):
            return k, WRONG_START
        for i in range(0, q.shape[0], 2):
            if math.hypot(q[i], q[i + 1]) > max_bend + BEND_SLACK_RAD:
                return k, BEND_LIMIT
        if k > 0:
            passed = times[k] - times[k - 1]
            if passed < 0.0:
                return k, BACKWARD_TIME
            if passed < SAME_TIME_S and _difference(q, configurations[k - 1]) > SAME_CONFIGURATION_RAD:
                return k, JUMP
    return times.shape[0], OK


@kernel
def arrival(times, configurations, limit, goal, tolerance, section_length):
    """Index of the first timed state by ``limit`` whose tip is within ``tolerance`` of ``goal``; -1 if none is."""
    nodes, bends = np.empty((configurations.shape[1], 9)), np.empty(configurations.shape[1] // 2)
    for k in range(times.shape[0]):
        if times[k] > limit + SAME_TIME_S:
            return -1
        x, y, z = tip(configurations[k], section_length, nodes, bends)
        if math.sqrt((x - goal[0]) ** 2 + (y - goal[1]) ** 2 + (z - goal[2]) ** 2) <= tolerance + ARRIVAL_SLACK_M:
            return k
    return -1


@kernel
def _tip_speed(q0, q1, share, step, section_length, q, nodes, bends):
    """Tip speed per unit of share at ``share`` of the way from ``q0`` to ``q1``, as a central difference."""
    interpolate(q0, q1, share - step, q)
    ax, ay, az = tip(q, section_length, nodes, bends)
    interpolate(q0, q1, share + step, q)
    bx, by, bz = tip(q, section_length, nodes, bends)
    return math.sqrt((bx - ax) ** 2 + (by - ay) ** 2 + (bz - az) ** 2) / (2.0 * step)


@kernel
def _tip_too_fast(q0, q1, until, allowed, section_length, q, nodes, bends):
    """Share in [0, until] of the way from ``q0`` to ``q1`` at which the tip exceeds ``allowed`` [m per unit of share].

    nan is a proof that it never exceeds it by more than twice the slack.
    """
    first, second, third, turned = 0.0, 0.0, 0.0, 0.0  # bounds on the tip's derivatives
    for i in range(bends.shape[0]):
        before = turned
        turned += math.hypot(q1[2 * i] - q0[2 * i], q1[2 * i + 1] - q0[2 * i + 1])
        first += section_length * (turned + before) / 2.0
        second += section_length * (turned**2 + turned * before + before**2) / 3.0
        third += section_length * (turned**3 + turned**2 * before + turned * before**2 + before**3) / 4.0
    sure, seen = (1.0 + 2.0 * LIMIT_SLACK) * allowed, (1.0 + LIMIT_SLACK) * allowed
    if first <= sure:
        return math.nan
    step = 1e-4 / turned  # a bend of 1e-4 rad, whatever the share: truncation and rounding are then both negligible
    error = third * step * step / 6.0
    bow = (second * second + first * third) / 4.0  # of the squared speed over its chord, per squared share
    share, width = 0.0, until
    here = _tip_speed(q0, q1, 0.0, step, section_length, q, nodes, bends)
    if here - error > seen:
        return 0.0
    while share < until:
        width = min(width, until - share)
        there = _tip_speed(q0, q1, share + width, step, section_length, q, nodes, bends)
        if (max(here, there) + error) ** 2 + bow * width * width <= sure * sure:
            share, here, width = share + width, there, 2.0 * width
        elif width < LEAST_WIDTH or (width < FOUND_WIDTH and there - error > seen):
            return share + width
        else:
            width *= 0.5
    return math.nan


@kernel
def first_excess(times, configurations, end, section_length, max_rate, max_speed):
    """Time by ``end`` at which a section bends faster than ``max_rate`` or the tip exceeds ``max_speed``, and which."""
    n = configurations.shape[1] // 2
    nodes, bends, q = np.empty((2 * n, 9)), np.empty(n), np.empty(2 * n)
    for k in range(times.shape[0] - 1):
        if times[k] >= end:
            break
        duration = times[k + 1] - times[k]
        if duration < SAME_TIME_S:
            continue
        q0, q1 = configurations[k], configurations[k + 1]
        for i in range(n):
            change = math.hypot(q1[2 * i] - q0[2 * i], q1[2 * i + 1] - q0[2 * i + 1])
            if change > (1.0 + LIMIT_SLACK) * max_rate * duration:
                return times[k], BEND_RATE
        until = min(1.0, (end - times[k]) / duration)
        share = _tip_too_fast(q0, q1, until, max_speed * duration, section_length, q, nodes, bends)
        if not math.isnan(share):
            return times[k] + share * duration, TIP_SPEED
    return math.nan, OK
