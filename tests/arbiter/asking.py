"""What asks the court where a planner's kernel decides; the arguments are those of the kernel whose place it takes."""

from typing import Any

import numba
from numba import types

from planners.paper.potential_field import _kernels as field
from planners.search.certificate import _kernels as certificate
from scenarios.kernels.clearance import arc_clearances
from scenarios.kernels.kinematics import section_arcs

from .court import COURT, UNLIMITED

njit: Any = numba.njit(error_model="numpy", _nrt=True)  # even where the caller has no arrays made
own_is_clear, own_is_motion_free = certificate.is_clear, certificate.is_motion_free
own_nearest = field.nearest_on_body


@njit
def is_free(q, section_length, centers, reach, arcs):
    with numba.objmode(free=types.boolean):
        free = COURT.is_free(q, centers)
    return free


@njit
def is_code_free(code, n, table, centers, reach, memo, arcs):
    with numba.objmode(free=types.boolean):
        free = COURT.is_code_free(code, centers)
    return free


@njit
def is_motion_free(q0, t0, q1, t1, change, section_length, arm_radius, world, stack):
    with numba.objmode(free=types.boolean):
        free = COURT.is_motion_free(q0, t0, q1, t1, world, rates=UNLIMITED)
    own = own_is_motion_free(q0, t0, q1, t1, change, section_length, arm_radius, world, stack)
    with numba.objmode():
        COURT.compare(own, free)
    return free


@njit
def is_clear(q0, t0, change, t1, margin, section_length, arm_radius, world, stack):
    own, states = own_is_clear(q0, t0, change, t1, margin, section_length, arm_radius, world, stack)
    q1 = q0 + change
    with numba.objmode(free=types.boolean):
        free = COURT.is_motion_free(q0, t0, q1, t1, world, margin_m=margin)
        COURT.compare(own, free)
    if free and not own:
        section_arcs(q1, section_length, stack.arcs[0])
        arc_clearances(stack.arcs[0], t1, arm_radius, world, stack.gaps[0])
    return free, states


@njit
def motion_valid(q0, t0, q1, t1, section_length, arm_radius, max_bend, bend_rate, tip_speed, tolerance, world):
    with numba.objmode(free=types.boolean):
        free = COURT.is_motion_free(q0, t0, q1, t1, world, rates=(bend_rate, tip_speed))
    return free


@njit
def clearance(q, t, section_length, arm_radius, max_bend, world):
    with numba.objmode(gap=types.float64):
        gap = COURT.clearance(q, t, world)
    return gap


@njit
def nearest_on_body(q, section_length, arcs, center, point):
    """No answer but a distance, and what follows from it is chaotic: it is compared, not replaced."""
    length, distance = own_nearest(q, section_length, arcs, center, point)
    with numba.objmode():
        COURT.compare_distances(distance, q, center)
    return length, distance
