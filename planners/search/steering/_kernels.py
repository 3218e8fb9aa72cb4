"""Steering of a redundant arm, within its limits.

With more sections than its tip needs, an arm can run straight with its tip at the speed limit while the body, in the
null space of the tip's Jacobian, turns towards any posture (Liegeois 1977). A step of such a run is a motion linear in
bending vectors. Its duration is what the limits ask for, so that every step can be executed. The steps are our own.
"""

import math
from typing import NamedTuple

import numpy as np

from scenarios.kernels.jit import bare_kernel

DAMPING = (
    1e-5  # of the pseudo-inverse [m^2/rad^2]: the tip still follows to about 1 % at a tenth of a straight arm's reach
)
ARRIVED_M = 1e-4  # the tip stops this far outside a goal ball at most


class Body(NamedTuple):
    """The arm's numbers as kernels take them, its limits with what is held in reserve."""

    section_length: float
    radius: float
    max_bend: float
    bend_rate: float
    tip_speed: float


class Target(NamedTuple):
    """Where a run is going."""

    point: np.ndarray
    """For the tip, shape (3,), [m]."""
    posture: np.ndarray
    """For the body, shape (2n,), [rad]."""


class Step(NamedTuple):
    """A step and the work space to choose it in."""

    state: np.ndarray
    """The next configuration, shape (2n,), [rad]."""
    change: np.ndarray
    """The change to it, shape (2n,), [rad]."""
    pull: np.ndarray
    """Work space, shape (2n,), [rad]."""
    jacobian: np.ndarray
    """Of the tip before the step, shape (3, 2n), [m/rad]."""
    jacobian_after: np.ndarray
    """The same after it."""


@bare_kernel
def _solve3(a00, a01, a02, a11, a12, a22, x, y, z):
    """Solve the symmetric 3 x 3 system."""
    c00, c01, c02 = a11 * a22 - a12 * a12, a02 * a12 - a01 * a22, a01 * a12 - a02 * a11
    c11, c12, c22 = a00 * a22 - a02 * a02, a01 * a02 - a00 * a12, a00 * a11 - a01 * a01
    scale = 1.0 / (a00 * c00 + a01 * c01 + a02 * c02)
    return (
        (c00 * x + c01 * y + c02 * z) * scale,
        (c01 * x + c11 * y + c12 * z) * scale,
        (c02 * x + c12 * y + c22 * z) * scale,
    )


@bare_kernel
def steer(q, tip, target, stop, duration, body, step):
    """Choose a step of about ``duration`` [s] from ``q`` (2n,) [rad] into ``step``, whose Jacobian is that at ``q``.

    The tip, at ``tip`` (3,) [m], goes straight to within ``stop`` [m] of its target, as far as its limit allows; the
    body turns to its posture with what that leaves of the bends' limits.
    """
    change, pull, jac = step.change, step.pull, step.jacobian
    dx, dy, dz = target.point[0] - tip[0], target.point[1] - tip[1], target.point[2] - tip[2]
    distance = math.sqrt(dx * dx + dy * dy + dz * dz)
    share = min(max(0.0, distance - stop), body.tip_speed * duration) / max(distance, 1e-12)
    turn = body.bend_rate * duration
    a00 = a11 = a22 = DAMPING
    a01 = a02 = a12 = bx = by = bz = 0.0
    for i in range(0, q.shape[0], 2):
        u, v = target.posture[i] - q[i], target.posture[i + 1] - q[i + 1]
        ease = min(1.0, turn / max(math.sqrt(u * u + v * v), 1e-12))
        pull[i], pull[i + 1] = ease * u, ease * v
        for k in range(i, i + 2):
            jx, jy, jz = jac[0, k], jac[1, k], jac[2, k]
            a00, a11, a22 = a00 + jx * jx, a11 + jy * jy, a22 + jz * jz
            a01, a02, a12 = a01 + jx * jy, a02 + jx * jz, a12 + jy * jz
            bx, by, bz = bx + jx * pull[k], by + jy * pull[k], bz + jz * pull[k]
    wx, wy, wz = _solve3(a00, a01, a02, a11, a12, a22, share * dx, share * dy, share * dz)
    nx, ny, nz = _solve3(a00, a01, a02, a11, a12, a22, bx, by, bz)
    for k in range(q.shape[0]):
        change[k] = jac[0, k] * wx + jac[1, k] * wy + jac[2, k] * wz
        pull[k] -= jac[0, k] * nx + jac[1, k] * ny + jac[2, k] * nz
    spare = 1.0
    for i in range(0, q.shape[0], 2):
        left = max(0.0, turn - math.sqrt(change[i] ** 2 + change[i + 1] ** 2))
        spare = min(spare, left / max(math.sqrt(pull[i] ** 2 + pull[i + 1] ** 2), 1e-12))
    for i in range(0, q.shape[0], 2):
        u, v = q[i] + change[i] + spare * pull[i], q[i + 1] + change[i + 1] + spare * pull[i + 1]
        shrink = min(1.0, body.max_bend / max(math.sqrt(u * u + v * v), 1e-12))
        step.state[i], step.state[i + 1] = shrink * u, shrink * v
        change[i], change[i + 1] = step.state[i] - q[i], step.state[i + 1] - q[i + 1]


@bare_kernel
def least_duration(start, end, body, step):
    """Shortest time [s] in which ``step``, between tips ``start`` and ``end`` (3,) [m], keeps to the arm's rates.

    The tip's speed is looked at at both ends and in the middle, where Simpson's rule gives it from the way travelled.
    """
    change, before, after = step.change, step.jacobian, step.jacobian_after
    turned = 0.0
    for i in range(0, change.shape[0], 2):
        turned = max(turned, change[i] ** 2 + change[i + 1] ** 2)
    first = second = third = 0.0
    for r in range(3):
        v0 = v1 = 0.0
        for k in range(change.shape[0]):
            v0 += before[r, k] * change[k]
            v1 += after[r, k] * change[k]
        middle = 0.25 * (6.0 * (end[r] - start[r]) - v0 - v1)
        first, second, third = first + v0 * v0, second + middle * middle, third + v1 * v1
    return max(math.sqrt(turned) / body.bend_rate, math.sqrt(max(first, second, third)) / body.tip_speed)
