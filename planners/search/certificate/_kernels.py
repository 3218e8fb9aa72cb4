"""Certificate of short motions from both ends: docs/temporal-ct.md derives it, our own.

A section is at distance a from an obstacle before a motion and b after it. A point of it that goes straight keeps at
least (a + b - w) / 2 off in between, with w the way from its place before to its place after plus the obstacle's way.
One that strays from straight keeps that much less; it strays by an eighth of its greatest acceleration at most. Where
this proves nothing the motion is halved. Advancement from one end counts the turns of all sections; this counts ways,
which are short where the sections' turns cancel, as they do when the tip is steered.
"""

import math
from typing import NamedTuple

import numpy as np

from scenarios.kernels.clearance import arc_clearances, motion_clear_until
from scenarios.kernels.jit import bare_kernel, kernel
from scenarios.kernels.kinematics import section_arcs

CONTACT_M = 1e-4  # closer than this is a touch to the shared motion validator
HALVINGS = 8  # of a motion, after which what is not proven counts as not free


class Stack(NamedTuple):
    """States of a motion: row 0 is the last one reached by the proof, the others lie ever nearer ahead of it."""

    shares: np.ndarray
    """Of the motion, shape (HALVINGS + 2,)."""
    arcs: np.ndarray
    """Shape (HALVINGS + 2, n, ARC_SIZE)."""
    gaps: np.ndarray
    """Clearance of each section, shape (HALVINGS + 2, n), [m]."""
    state: np.ndarray
    """Work space, shape (2n,), [rad]."""


@bare_kernel
def is_clear(q0, t0, change, t1, margin, section_length, arm_radius, world, stack):
    """Whether a motion, linear in bending vectors, keeps ``margin`` [m] off every obstacle.

    Args:
        q0: Bending vectors before, shape (2n,), [rad].
        t0: Time before [s].
        change: To the bending vectors after, shape (2n,), [rad].
        t1: Time after [s].
        margin: Clearance to keep [m].
        section_length: Length of each section [m].
        arm_radius: Radius of the body [m].
        world: The obstacles.
        stack: Row 0 holds arcs and clearances before the motion, row 1 the arcs after it. If the motion is free, row 0
            holds arcs and clearances after it in the end.

    Returns:
        The answer and the number of states looked at.
    """
    shares, arcs, gaps, state = stack.shares, stack.arcs, stack.gaps, stack.state
    least, states, top = margin + CONTACT_M, 1, 1
    shares[0], shares[1] = 0.0, 1.0
    if arc_clearances(arcs[1], t1, arm_radius, world, gaps[1]) <= least:
        return False, states
    while top > 0:
        share = shares[top] - shares[0]
        open_m = 2.0 * least + share * (t1 - t0) * world.speed_m_s
        if _is_proven(arcs[0], gaps[0], arcs[top], gaps[top], change, share, open_m, section_length):
            shares[0] = shares[top]
            for i in range(arcs.shape[1]):
                gaps[0, i] = gaps[top, i]
                for c in range(arcs.shape[2]):
                    arcs[0, i, c] = arcs[top, i, c]
            top -= 1
            continue
        if top > HALVINGS:
            return False, states
        top += 1
        shares[top] = 0.5 * (shares[0] + shares[top - 1])
        for k in range(change.shape[0]):
            state[k] = q0[k] + shares[top] * change[k]
        section_arcs(state, section_length, arcs[top])
        states += 1
        if arc_clearances(arcs[top], t0 + shares[top] * (t1 - t0), arm_radius, world, gaps[top]) <= least:
            return False, states
    return True, states


@bare_kernel
def _is_proven(before, gaps_before, after, gaps_after, change, share, open_m, section_length):
    """Whether clearances at both ends add up to more than ``open_m`` and what points of the sections move.

    ``share`` of ``change`` (2n,) [rad] turns the bending vectors from one end to the other.
    """
    turned = stray = way = 0.0
    for i in range(before.shape[0]):
        turn = share * math.sqrt(change[2 * i] ** 2 + change[2 * i + 1] ** 2)
        last, turned = turned, turned + turn
        stray += section_length * (turned * turned + turned * last + last * last) / 24.0
        base_way = way
        x, y, z = after[i, 12] - before[i, 12], after[i, 13] - before[i, 13], after[i, 14] - before[i, 14]
        way = math.sqrt(x * x + y * y + z * z)
        # Along the section ways are linear between its ends but for an eighth of the change of its curvature.
        between = section_length * (turn + section_length / before[i, 15] * turned) / 8.0
        if gaps_before[i] + gaps_after[i] <= open_m + max(base_way, way) + between + 2.0 * stray:
            return False
    return True


@kernel
def is_motion_free(q0, t0, q1, t1, change, section_length, arm_radius, world, stack):
    """Whether the shared motion validator finds no obstacle on a motion, linear in bending vectors; mostly sooner.

    What is certified is free to the validator, which advances until it comes within ``CONTACT_M``; what touches at an
    instant is not. The rest, a few motions that graze, it is asked about.

    Args:
        q0: Bending vectors before, shape (2n,), [rad].
        t0: Time before [s].
        q1: Bending vectors after, shape (2n,), [rad].
        t1: Time after [s].
        change: Work space for the change between them, shape (2n,), [rad].
        section_length: Length of each section [m].
        arm_radius: Radius of the body [m].
        world: The obstacles.
        stack: Rows 0 and 1 hold arcs and clearances before and after the motion; changed.
    """
    for k in range(change.shape[0]):
        change[k] = q1[k] - q0[k]
    for i in range(stack.gaps.shape[1]):
        if stack.gaps[0, i] <= CONTACT_M:
            return False
    open_m = 2.0 * CONTACT_M + (t1 - t0) * world.speed_m_s
    if _is_proven(stack.arcs[0], stack.gaps[0], stack.arcs[1], stack.gaps[1], change, 1.0, open_m, section_length):
        return True
    for share in (0.5, 0.25, 0.75):
        for k in range(change.shape[0]):
            stack.state[k] = q0[k] + share * change[k]
        section_arcs(stack.state, section_length, stack.arcs[2])
        if arc_clearances(stack.arcs[2], t0 + share * (t1 - t0), arm_radius, world, stack.gaps[2]) <= 0.0:
            return False
    free, _ = is_clear(q0, t0, change, t1, 0.0, section_length, arm_radius, world, stack)
    if free:
        return True
    until, _ = motion_clear_until(q0, t0, q1, t1, 0.0, CONTACT_M, section_length, arm_radius, world)
    return until >= 1.0
