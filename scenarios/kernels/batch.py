"""Validity of many configurations at one instant, laid out so that the compiler works on several at a time.

The mathematics is that of ``kinematics`` and ``clearance``. What differs: states are taken in blocks, every quantity is
a row over the block, the loops over a block have neither branches nor calls, and sine and cosine of a bend in [0, pi]
are polynomials. All rows lie in one array at constant distances: only then can the compiler prove that they do not
overlap, without which it takes one state at a time.
"""

import math

import numpy as np

from scenarios.kernels.jit import kernel
from scenarios.kernels.kinematics import MIN_BEND_RAD

B = 64  # states in a block: its rows stay in the first-level cache
HALF_PI = 0.5 * math.pi

# Rows of the work array. Of this section and the last: cosine and sine of theta, sine and cosine of phi; the arc's
# radius; the frame's bending direction, normal and tangent; where the section begins and ends; and the result.
C, S, SIN, COS, LAST_C, LAST_S, LAST_SIN, LAST_COS, RADIUS = (k * B for k in range(9))
DX, DY, DZ, EX, EY, EZ, ZX, ZY, ZZ, PX, PY, PZ, QX, QY, QZ, EXCESS = (k * B for k in range(9, 25))
ROWS = 25 * B

# Taylor series about pi / 2: sin x = cos y and cos x = -sin y with y = x - pi / 2, |y| <= pi / 2; what is cut off is
# below 1e-12.
C0, C1, C2, C3, C4, C5, C6, C7, C8 = ((-1.0) ** k / math.factorial(2 * k) for k in range(9))
S0, S1, S2, S3, S4, S5, S6, S7, S8 = ((-1.0) ** k / math.factorial(2 * k + 1) for k in range(9))


@kernel
def _bend(u, v, length, w):
    """The section's theta, phi and radius from its bending vectors ``u``, ``v`` (B,)."""
    for i in range(B):
        w[LAST_C + i], w[LAST_S + i] = w[C + i], w[S + i]
        w[LAST_SIN + i], w[LAST_COS + i] = w[SIN + i], w[COS + i]
    for i in range(B):
        bend = math.sqrt(u[i] * u[i] + v[i] * v[i])
        straight = bend < MIN_BEND_RAD
        bend = MIN_BEND_RAD if straight else bend
        w[C + i] = 1.0 if straight else u[i] / bend
        w[S + i] = 0.0 if straight else v[i] / bend
        w[RADIUS + i] = length / bend
        y = bend - HALF_PI
        z = y * y
        w[SIN + i] = C0 + z * (C1 + z * (C2 + z * (C3 + z * (C4 + z * (C5 + z * (C6 + z * (C7 + z * C8)))))))
        w[COS + i] = -y * (S0 + z * (S1 + z * (S2 + z * (S3 + z * (S4 + z * (S5 + z * (S6 + z * (S7 + z * S8))))))))


@kernel
def _place(w):
    """Turn the frame from the last section's base to this one's, and find where this one begins and ends."""
    for i in range(B):
        sin, cos = w[LAST_SIN + i], w[LAST_COS + i]
        turn_cos = w[C + i] * w[LAST_C + i] + w[S + i] * w[LAST_S + i]
        turn_sin = w[S + i] * w[LAST_C + i] - w[C + i] * w[LAST_S + i]
        dx, dy, dz = w[DX + i], w[DY + i], w[DZ + i]
        ex, ey, ez = w[EX + i], w[EY + i], w[EZ + i]
        zx, zy, zz = w[ZX + i], w[ZY + i], w[ZZ + i]
        tx, ty, tz = cos * dx - sin * zx, cos * dy - sin * zy, cos * dz - sin * zz
        zx, zy, zz = cos * zx + sin * dx, cos * zy + sin * dy, cos * zz + sin * dz
        dx, dy, dz = turn_cos * tx + turn_sin * ex, turn_cos * ty + turn_sin * ey, turn_cos * tz + turn_sin * ez
        w[EX + i], w[EY + i] = turn_cos * ex - turn_sin * tx, turn_cos * ey - turn_sin * ty
        w[EZ + i] = turn_cos * ez - turn_sin * tz
        w[DX + i], w[DY + i], w[DZ + i] = dx, dy, dz
        w[ZX + i], w[ZY + i], w[ZZ + i] = zx, zy, zz
        a, b = w[RADIUS + i] * (1.0 - w[COS + i]), w[RADIUS + i] * w[SIN + i]
        px, py, pz = w[QX + i], w[QY + i], w[QZ + i]
        w[PX + i], w[PY + i], w[PZ + i] = px, py, pz
        w[QX + i], w[QY + i], w[QZ + i] = px + a * dx + b * zx, py + a * dy + b * zy, pz + a * dz + b * zz


@kernel
def _lower_excess(x, y, z, reach, w):
    """Lower EXCESS to the section's squared distance from the sphere at (x, y, z), less ``reach`` squared [m^2]."""
    for i in range(B):
        wx, wy, wz = x - w[PX + i], y - w[PY + i], z - w[PZ + i]
        a = wx * w[DX + i] + wy * w[DY + i] + wz * w[DZ + i]
        b = wx * w[EX + i] + wy * w[EY + i] + wz * w[EZ + i]
        h = wx * w[ZX + i] + wy * w[ZY + i] + wz * w[ZZ + i]
        inward = w[RADIUS + i] - a
        off = math.sqrt(inward * inward + h * h) - w[RADIUS + i]
        qx, qy, qz = x - w[QX + i], y - w[QY + i], z - w[QZ + i]
        at_base, at_end = wx * wx + wy * wy + wz * wz, qx * qx + qy * qy + qz * qz
        at_ends = at_base if at_base < at_end else at_end
        beside = (h >= 0.0) & (w[SIN + i] * inward >= w[COS + i] * h)
        excess = (off * off + b * b if beside else at_ends) - reach * reach
        w[EXCESS + i] = excess if excess < w[EXCESS + i] else w[EXCESS + i]


@kernel
def within_bends(configurations, max_bend):
    """Whether every section's bend is at most ``max_bend`` [rad], which no bend that is not a number is: (N,)."""
    out = np.empty(configurations.shape[0], np.bool_)
    limit = max_bend * max_bend
    for i in range(configurations.shape[0]):
        inside = True
        for k in range(0, configurations.shape[1], 2):
            u, v = configurations[i, k], configurations[i, k + 1]
            inside &= u * u + v * v <= limit
        out[i] = inside
    return out


@kernel
def states_free(configurations, section_length, centers, reach):
    """Whether each configuration is free of the spheres: (N, 2n) [rad] -> (N,).

    Args:
        configurations: Bending vectors, shape (N, 2n), [rad].
        section_length: Length of each section [m].
        centers: Sphere centres, shape (m, 3), [m].
        reach: Sphere radius plus arm radius, shape (m,), [m]; a touch is a collision.
    """
    total, dof = configurations.shape
    out = np.empty(total, np.bool_)
    w, bending = np.zeros(ROWS), np.zeros((dof, B))
    for first in range(0, total, B):
        count = min(B, total - first)
        for i in range(count):  # what a last, shorter block leaves over is worked on and ignored
            for k in range(dof):
                bending[k, i] = configurations[first + i, k]
        # Before the first section lies one of no bend and no length along +z, with theta 0.
        w[:] = 0.0
        for i in range(B):
            w[C + i], w[COS + i], w[DX + i], w[EY + i], w[ZZ + i] = 1.0, 1.0, 1.0, 1.0, 1.0
            w[EXCESS + i] = math.inf
        for section in range(dof // 2):
            _bend(bending[2 * section], bending[2 * section + 1], section_length, w)
            _place(w)
            for j in range(centers.shape[0]):
                _lower_excess(centers[j, 0], centers[j, 1], centers[j, 2], reach[j], w)
        for i in range(count):
            out[first + i] = w[EXCESS + i] > 0.0
    return out
