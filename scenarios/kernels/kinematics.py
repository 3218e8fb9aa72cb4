"""Constant-curvature kinematics of a chain of inextensible sections, in bending vectors.

A section of length L with bending vector (u, v) = phi (cos theta, sin theta) is a circular arc of radius L / phi that
starts along its base z axis and bends towards (u, v). Its end frame is Rz(theta) Ry(phi) Rz(-theta) in its base frame:
Arachchige and Godage, RoboSoft 2022, eq. (3), with the section's own length as arc parameter.
"""

import math

import numpy as np

from scenarios.kernels.jit import bare_kernel, kernel

# Below this bend the arc is computed as if bent by it: the tip moves by less than L * 1e-6 / 2, and no branch for the
# straight section is needed anywhere.
MIN_BEND_RAD = 1e-6

# One row of ``arcs``, all that a distance to the arc needs: base point 0:3, unit bending direction d 3:6, unit normal
# of the arc's plane e 6:9, base tangent z 9:12 (d, e, z is a right-handed frame), end point 12:15, radius 15, sine and
# cosine of the bend 16, 17, cosine and sine of theta 18, 19.
ARC_SIZE = 20


@bare_kernel
def place_section(arcs, i, c, s, radius, sin, cos):
    """Lay out section ``i`` of ``arcs`` after section i - 1, from its theta (cosine, sine), radius [m] and bend."""
    if i == 0:
        arcs[0, 0], arcs[0, 1], arcs[0, 2] = 0.0, 0.0, 0.0
        arcs[0, 3], arcs[0, 4], arcs[0, 5] = c, s, 0.0
        arcs[0, 6], arcs[0, 7], arcs[0, 8] = -s, c, 0.0
        arcs[0, 9], arcs[0, 10], arcs[0, 11] = 0.0, 0.0, 1.0
    else:
        # The end frame is the base frame turned by the bend about the arc's normal e, which carries no twist, so the
        # next direction differs from this one's by the difference of the thetas.
        last = i - 1
        bent_sin, bent_cos = arcs[last, 16], arcs[last, 17]
        turn_cos = c * arcs[last, 18] + s * arcs[last, 19]
        turn_sin = s * arcs[last, 18] - c * arcs[last, 19]
        for k in range(3):
            d, e, z = arcs[last, 3 + k], arcs[last, 6 + k], arcs[last, 9 + k]
            t = bent_cos * d - bent_sin * z
            arcs[i, k] = arcs[last, 12 + k]
            arcs[i, 3 + k] = turn_cos * t + turn_sin * e
            arcs[i, 6 + k] = turn_cos * e - turn_sin * t
            arcs[i, 9 + k] = bent_cos * z + bent_sin * d
    a, b = radius * (1.0 - cos), radius * sin
    for k in range(3):
        arcs[i, 12 + k] = arcs[i, k] + a * arcs[i, 3 + k] + b * arcs[i, 9 + k]
    arcs[i, 15], arcs[i, 16], arcs[i, 17], arcs[i, 18], arcs[i, 19] = radius, sin, cos, c, s


@bare_kernel
def section_arcs(q, section_length, arcs):
    """Lay out the backbone's arcs in the base frame.

    Args:
        q: Bending vectors (u1, v1, u2, v2, ...), shape (2n,), [rad].
        section_length: Length of each section [m].
        arcs: Output, shape (n, ARC_SIZE).
    """
    for i in range(arcs.shape[0]):
        u, v = q[2 * i], q[2 * i + 1]
        bend = math.sqrt(u * u + v * v)
        if bend < MIN_BEND_RAD:
            bend = MIN_BEND_RAD
            c, s = 1.0, 0.0
        else:
            c, s = u / bend, v / bend
        place_section(arcs, i, c, s, section_length / bend, math.sin(bend), math.cos(bend))


@bare_kernel
def point_on_arc(arc, fraction_sin, fraction_cos, out):
    """Write the point of ``arc`` whose bend from the base has the given sine and cosine into ``out`` (3,), [m]."""
    a, b = arc[15] * (1.0 - fraction_cos), arc[15] * fraction_sin
    for k in range(3):
        out[k] = arc[k] + a * arc[3 + k] + b * arc[9 + k]


@kernel
def tips(configurations, section_length):
    """Tip position of each configuration: (N, 2n) [rad] -> (N, 3) [m]."""
    n = configurations.shape[1] // 2
    arcs = np.empty((n, ARC_SIZE))
    out = np.empty((configurations.shape[0], 3))
    for i in range(configurations.shape[0]):
        section_arcs(configurations[i], section_length, arcs)
        out[i, 0], out[i, 1], out[i, 2] = arcs[n - 1, 12], arcs[n - 1, 13], arcs[n - 1, 14]
    return out


@kernel
def backbone(q, section_length, points_per_section):
    """Backbone points at equal arc length: (n * points_per_section + 1, 3) [m], the base first."""
    n = q.shape[0] // 2
    arcs = np.empty((n, ARC_SIZE))
    section_arcs(q, section_length, arcs)
    out = np.zeros((n * points_per_section + 1, 3))
    for i in range(n):
        bend = section_length / arcs[i, 15]
        for k in range(1, points_per_section + 1):
            angle = bend * k / points_per_section
            point_on_arc(arcs[i], math.sin(angle), math.cos(angle), out[i * points_per_section + k])
    return out


@kernel
def position_jacobian(q, section_length, arc_length, jacobian):
    """Derivative of the backbone point at ``arc_length`` with respect to the bending vectors.

    Args:
        q: Bending vectors, shape (2n,), [rad].
        section_length: Length of each section [m].
        arc_length: Distance along the backbone from the base, in [0, n * section_length] [m].
        jacobian: Output, shape (3, 2n), [m/rad].

    Returns:
        The point (x, y, z) [m].

    A section's end turns by the rotation vector w = (-v, u, 0) in its base frame, so dw maps to an angular velocity
    through the left Jacobian of SO(3); what lies beyond the section is carried along rigidly.
    """
    n = q.shape[0] // 2
    arcs = np.empty((n, ARC_SIZE))
    section_arcs(q, section_length, arcs)
    last = min(int(arc_length / section_length), n - 1)
    inside = arc_length - last * section_length
    angle = inside / arcs[last, 15]
    point = np.empty(3)
    point_on_arc(arcs[last], math.sin(angle), math.cos(angle), point)
    jacobian[:] = 0.0
    for i in range(last + 1):
        share = 1.0 if i < last else inside / section_length
        if share > 0.0:
            _section_columns(arcs[i], section_length, share, point, i, jacobian)
    return point[0], point[1], point[2]


@bare_kernel
def tip_jacobian(arcs, section_length, jacobian):
    """Derivative of the end of ``arcs``, laid out by ``section_arcs``, into ``jacobian`` (3, 2n) [m/rad]."""
    n = arcs.shape[0]
    for i in range(n):
        _section_columns(arcs[i], section_length, 1.0, arcs[n - 1, 12:15], i, jacobian)


@bare_kernel
def _section_columns(arc, section_length, share, point, i, jacobian):
    """Write the two columns of section ``i``, cut at ``share`` of its length: how ``point`` moves with (u, v)."""
    c, s = arc[18], arc[19]
    phi, length = section_length / arc[15] * share, section_length * share
    sin, cos = (arc[16], arc[17]) if share == 1.0 else (math.sin(phi), math.cos(phi))
    # The cut section ends at length * (f d + g z); f, g and their derivatives by series where they cancel.
    if phi < 1e-3:
        f_by_phi, g = 0.5 - phi * phi / 24.0, 1.0 - phi * phi / 6.0
        df, dg = 0.5 - phi * phi / 8.0, -phi / 3.0
    else:
        f_by_phi, g = (1.0 - cos) / (phi * phi), sin / phi
        df, dg = g - f_by_phi, (cos - g) / phi
    f = f_by_phi * phi
    lever_x = point[0] - arc[0] - length * (f * arc[3] + g * arc[9])
    lever_y = point[1] - arc[1] - length * (f * arc[4] + g * arc[10])
    lever_z = point[2] - arc[2] - length * (f * arc[5] + g * arc[11])
    for k in range(2):
        bending = (c if k == 0 else s) * share  # d(phi)
        turning = (-s if k == 0 else c) * share  # phi d(theta)
        along, lift, side = length * df * bending, length * dg * bending, length * f_by_phi * turning
        # Angular velocity: the left Jacobian of SO(3) applied to dw = bending * e - turning * d.
        on_e, on_d, on_z = bending, -g * turning, f * turning
        wx = on_e * arc[6] + on_d * arc[3] + on_z * arc[9]
        wy = on_e * arc[7] + on_d * arc[4] + on_z * arc[10]
        wz = on_e * arc[8] + on_d * arc[5] + on_z * arc[11]
        column = 2 * i + k
        jacobian[0, column] = along * arc[3] + lift * arc[9] + side * arc[6] + wy * lever_z - wz * lever_y
        jacobian[1, column] = along * arc[4] + lift * arc[10] + side * arc[7] + wz * lever_x - wx * lever_z
        jacobian[2, column] = along * arc[5] + lift * arc[11] + side * arc[8] + wx * lever_y - wy * lever_x
