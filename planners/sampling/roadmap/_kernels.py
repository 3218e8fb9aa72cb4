"""Timed motions along the edges of a roadmap."""

import math

import numpy as np

from planners.problem._kernels import motion_valid
from planners.search.rates._kernels import fastest_tip, largest_bend_change
from scenarios.kernels.jit import kernel

PIECE_RAD = 0.2  # an edge is cut into pieces of at most this bend, each as fast as the rates allow
CHORDS = 16  # per piece, on which the tip's speed is measured; it varies by up to 3 % over one
RESERVE = 1.02  # on every duration, for what the chords leave out


@kernel
def pieces_of(q0, q1):
    """Number of pieces that the edge is cut into."""
    return max(1, math.ceil(largest_bend_change(q0, q1) / PIECE_RAD))


@kernel
def edge_durations(q0, q1, section_length, bend_rate, tip_speed):
    """Least time [s] of every piece of the straight edge q0 -> q1."""
    n = pieces_of(q0, q1)
    out = np.empty(n)
    for k in range(n):
        a, b = q0 + (q1 - q0) * (k / n), q0 + (q1 - q0) * ((k + 1) / n)
        tip = 0.0
        for c in range(CHORDS):
            chord = fastest_tip(a + (b - a) * (c / CHORDS), a + (b - a) * ((c + 1) / CHORDS), section_length, math.inf)
            tip = max(tip, chord * CHORDS / tip_speed)
        out[k] = RESERVE * max(largest_bend_change(a, b) / bend_rate, tip)
    return out


@kernel
def edge_valid(q0, q1, t0, durations, section_length, arm_radius, max_bend, bend_rate, tip_speed, tolerance, world):
    """Whether the edge, begun at ``t0`` [s] and run at ``durations``, is free at every instant."""
    n = durations.shape[0]
    t = t0
    for k in range(n):
        a, b = q0 + (q1 - q0) * (k / n), q0 + (q1 - q0) * ((k + 1) / n)
        if not motion_valid(
            a, t, b, t + durations[k], section_length, arm_radius, max_bend, bend_rate, tip_speed, tolerance, world
        ):
            return False
        t += durations[k]
    return True
