"""Rates of a motion that is linear in bending vectors."""

import math

import numpy as np

from scenarios.kernels.jit import kernel
from scenarios.kernels.kinematics import ARC_SIZE, section_arcs

# Tip speed is looked at on pieces of a motion that bend by no more than this in all sections together: over such a
# piece the tip's speed varies by less than 2 % (second derivative of the tip, at most 0.45 m per rad^2 bent).
PIECE_RAD = 0.05


@kernel
def fastest_tip(q0, q1, section_length, enough):
    """Largest tip displacement per share of the motion q0 -> q1, linear in bending vectors [m].

    Past ``enough`` [m] it no longer matters by how much: the first value beyond is returned.
    """
    n = q0.shape[0] // 2
    change = 0.0
    for i in range(n):
        change += math.hypot(q1[2 * i] - q0[2 * i], q1[2 * i + 1] - q0[2 * i + 1])
    pieces = max(1, math.ceil(change / PIECE_RAD))
    arcs, q = np.empty((n, ARC_SIZE)), np.empty(2 * n)
    fastest, x, y, z = 0.0, 0.0, 0.0, 0.0
    for k in range(pieces + 1):
        for i in range(2 * n):
            q[i] = q0[i] + (q1[i] - q0[i]) * k / pieces
        section_arcs(q, section_length, arcs)
        tip = arcs[n - 1]
        if k > 0:
            moved = math.sqrt((tip[12] - x) ** 2 + (tip[13] - y) ** 2 + (tip[14] - z) ** 2)
            fastest = max(fastest, moved * pieces)
            if fastest > enough:
                break
        x, y, z = tip[12], tip[13], tip[14]
    return fastest


@kernel
def largest_bend_change(q0, q1):
    """Largest change of a section's bending vector [rad]."""
    largest = 0.0
    for i in range(q0.shape[0] // 2):
        largest = max(largest, math.hypot(q1[2 * i] - q0[2 * i], q1[2 * i + 1] - q0[2 * i + 1]))
    return largest


@kernel
def within_rates(q0, q1, duration, section_length, bend_rate, tip_speed):
    """Whether the motion q0 -> q1 in ``duration`` [s] keeps to the bending rate and the tip speed."""
    if largest_bend_change(q0, q1) > bend_rate * duration * (1.0 + 1e-9):
        return False
    # A bound first, which spares most motions the tip itself: ``motion_bounds`` of the last section's end.
    n, bound = q0.shape[0] // 2, 0.0
    for i in range(n):
        change = math.hypot(q1[2 * i] - q0[2 * i], q1[2 * i + 1] - q0[2 * i + 1])
        bound += (n - i - 0.5) * section_length * change
    if bound <= tip_speed * duration:
        return True
    allowed = tip_speed * duration * (1.0 + 1e-9)
    return fastest_tip(q0, q1, section_length, allowed) <= allowed
