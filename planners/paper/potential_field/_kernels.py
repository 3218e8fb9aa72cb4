"""The potential field's velocity in bending space."""

import math

import numpy as np

from planners.search.rates._kernels import fastest_tip, largest_bend_change
from scenarios.kernels.jit import kernel
from scenarios.kernels.kinematics import ARC_SIZE, point_on_arc, position_jacobian, section_arcs

DAMPING = 1e-4  # of the pseudo-inverse [m^2/rad^2]; bounds its gain where the Jacobian loses rank
RESERVE = 0.98  # share of the arm's rates that is used: tip speed is measured on pieces of a motion
NEAREST_M = 1e-3  # clearance below which repulsion no longer grows


@kernel
def nearest_on_body(q, section_length, arcs, center, point):
    """Backbone point nearest to ``center``, written to ``point`` (3,); returns its arc length and distance [m]."""
    section_arcs(q, section_length, arcs)
    best, best_length = math.inf, 0.0
    candidate = np.empty(3)
    for i in range(arcs.shape[0]):
        arc = arcs[i]
        a, h = 0.0, 0.0
        for k in range(3):
            a += (center[k] - arc[k]) * arc[3 + k]
            h += (center[k] - arc[k]) * arc[9 + k]
        bend = section_length / arc[15]
        angle = math.atan2(h, arc[15] - a)
        if angle < 0.0 or angle > bend:  # beyond an end: the nearer end is nearest
            start, end = 0.0, 0.0
            for k in range(3):
                start += (center[k] - arc[k]) ** 2
                end += (center[k] - arc[12 + k]) ** 2
            angle = 0.0 if start <= end else bend
        point_on_arc(arc, math.sin(angle), math.cos(angle), candidate)
        distance = math.sqrt(((candidate - center) ** 2).sum())
        if distance < best:
            best, best_length = distance, (i + angle / bend) * section_length
            for k in range(3):
                point[k] = candidate[k]
    return best_length, best


@kernel
def add_task(jacobian, velocity, rate):
    """Add the damped pseudo-inverse solution of ``jacobian`` (3, 2n) * rate = velocity (3,) to ``rate`` (2n,)."""
    gram = jacobian @ jacobian.T
    for k in range(3):
        gram[k, k] += DAMPING
    rate += jacobian.T @ np.linalg.solve(gram, velocity)


@kernel
def add_limit_potential(q, max_bend, margin, gain, rate):
    """Push each actuator away from the ends of its range (Ataka 2016's potential in actuator space).

    Lengths are taken per actuator offset: l_i / r = -(u cos a_i + v sin a_i), within [-max_bend, max_bend].
    """
    for i in range(q.shape[0] // 2):
        for k in range(3):
            c, s = math.cos(2.0 * math.pi / 3.0 * k), math.sin(2.0 * math.pi / 3.0 * k)
            length = -(c * q[2 * i] + s * q[2 * i + 1])
            room = max(max_bend - abs(length), 0.05 * margin)
            if room < margin:
                push = gain * (1.0 / room - 1.0 / margin) / (room * room)
                sign = 1.0 if length > 0.0 else -1.0
                rate[2 * i] += sign * push * c
                rate[2 * i + 1] += sign * push * s


@kernel
def field_step(q, goal, centers, radii, section_length, arm_radius, max_bend, bend_rate, tip_speed, duration, gains):
    """Follow the field for ``duration`` [s] from ``q`` (2n,), within the rates, inf for none; returns the new q.

    ``gains``: attraction [1/s], repulsion [m^4/s], influence distance [m], the fastest that an obstacle may push [m/s],
    actuator-limit gain and margin [rad].
    """
    attraction, repulsion, influence, fastest_push, limit_gain, limit_margin = gains
    n = q.shape[0] // 2
    jacobian, arcs, point = np.empty((3, 2 * n)), np.empty((n, ARC_SIZE)), np.empty(3)
    rate = np.zeros(2 * n)
    tip = np.array(position_jacobian(q, section_length, n * section_length, jacobian))
    pull = attraction * (goal - tip)
    speed = math.sqrt((pull * pull).sum())
    if speed > tip_speed:
        pull *= tip_speed / speed
    add_task(jacobian, pull, rate)
    for j in range(centers.shape[0]):
        length, distance = nearest_on_body(q, section_length, arcs, centers[j], point)
        rho = max(distance - arm_radius - radii[j], NEAREST_M)
        if rho < influence and distance > 0.0:
            push = repulsion * (1.0 / rho - 1.0 / influence) / (rho * rho)
            push = min(push, fastest_push)  # lest one near obstacle drown every other term
            position_jacobian(q, section_length, length, jacobian)
            add_task(jacobian, (point - centers[j]) * (push / distance), rate)
    add_limit_potential(q, max_bend, limit_margin, limit_gain, rate)
    target = q + rate * duration
    for i in range(n):
        bend = math.hypot(target[2 * i], target[2 * i + 1])
        if bend > max_bend:
            target[2 * i] *= max_bend / bend
            target[2 * i + 1] *= max_bend / bend
    # Rates last: on the way back from a target within the disc of bends every point is within it.
    turn = largest_bend_change(q, target)
    target = q + (target - q) * min(1.0, RESERVE * bend_rate * duration / max(turn, 1e-12))
    moved = fastest_tip(q, target, section_length, math.inf)
    return q + (target - q) * min(1.0, RESERVE * tip_speed * duration / max(moved, 1e-12))


@kernel
def follow_field(
    q, goal, centers, radii, section_length, arm_radius, max_bend, bend_rate, tip_speed, duration, steps, gains
):
    """``field_step`` ``steps`` times over: the states passed, (steps + 1, 2n) [rad], ``q`` first."""
    out = np.empty((steps + 1, q.shape[0]))
    for i in range(q.shape[0]):
        out[0, i] = q[i]
    for k in range(steps):
        following = field_step(
            out[k],
            goal,
            centers,
            radii,
            section_length,
            arm_radius,
            max_bend,
            bend_rate,
            tip_speed,
            duration,
            gains,
        )
        for i in range(q.shape[0]):
            out[k + 1, i] = following[i]
    return out
