"""Signed distances to convex shapes, and from an arc to them, by code that neither FCL nor a planner shares.

A signed distance changes by no more than its point moves. So the piece of an arc about a looked-at point can be nearer
than that point by half the piece's length at most: halving pieces bounds the distance from below, whatever the shape.
"""

import math

from scenarios.kernels.jit import kernel

SPHERE, BOX, CAPSULE, CYLINDER, MESH = range(5)

SLACK = 0.1  # share of a gap by which it may be understated
FINE_M = 5e-6  # or by this much, where that is more


@kernel
def _outside(x, y):
    """Signed distance to a right-angled corner from the signed distances to its two sides."""
    return math.hypot(max(x, 0.0), max(y, 0.0)) + min(max(x, y), 0.0)


@kernel
def _to_segment(a, b, x, y, z):
    """Distance from (x, y, z) to the segment between points ``a`` and ``b`` (3,)."""
    ux, uy, uz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    wx, wy, wz = x - a[0], y - a[1], z - a[2]
    along = (wx * ux + wy * uy + wz * uz) / (ux * ux + uy * uy + uz * uz)
    along = min(1.0, max(0.0, along))
    return math.sqrt((wx - along * ux) ** 2 + (wy - along * uy) ** 2 + (wz - along * uz) ** 2)


@kernel
def _is_over(plane, a, b, x, y, z):
    """Whether (x, y, z) is on the inner side of edge ``a`` to ``b`` of a face, counter-clockwise from outside."""
    ux, uy, uz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    wx, wy, wz = x - a[0], y - a[1], z - a[2]
    across_x, across_y, across_z = uy * wz - uz * wy, uz * wx - ux * wz, ux * wy - uy * wx
    return plane[0] * across_x + plane[1] * across_y + plane[2] * across_z >= 0.0


@kernel
def _to_mesh(planes, faces, x, y, z):
    """Signed distance to a convex polyhedron: to the nearest face that can be seen, or to the nearest plane inside."""
    inside, nearest = -math.inf, math.inf
    for f in range(planes.shape[0]):
        plane, face = planes[f], faces[f]
        over = plane[0] * x + plane[1] * y + plane[2] * z + plane[3]
        inside = max(inside, over)
        if over <= 0.0 or over >= nearest:
            continue
        a, b, c = face[0], face[1], face[2]
        if _is_over(plane, a, b, x, y, z) and _is_over(plane, b, c, x, y, z) and _is_over(plane, c, a, x, y, z):
            nearest = over
        else:
            to_edges = min(_to_segment(a, b, x, y, z), _to_segment(b, c, x, y, z))
            nearest = min(nearest, to_edges, _to_segment(c, a, x, y, z))
    return inside if inside <= 0.0 else nearest


@kernel
def signed_distance(bodies, j, wx, wy, wz):
    """Signed distance from (wx, wy, wz), given about the centre of shape ``j`` in the world's axes."""
    turn, size = bodies.turns[j], bodies.sizes_m[j]
    x = turn[0, 0] * wx + turn[1, 0] * wy + turn[2, 0] * wz
    y = turn[0, 1] * wx + turn[1, 1] * wy + turn[2, 1] * wz
    z = turn[0, 2] * wx + turn[1, 2] * wy + turn[2, 2] * wz
    kind = bodies.kinds[j]
    if kind == BOX:
        x, y, z = abs(x) - size[0], abs(y) - size[1], abs(z) - size[2]
        away = math.sqrt(max(x, 0.0) ** 2 + max(y, 0.0) ** 2 + max(z, 0.0) ** 2)
        return away + min(max(x, y, z), 0.0)
    if kind == CAPSULE:
        z -= min(max(z, -size[1]), size[1])
        return math.sqrt(x * x + y * y + z * z) - size[0]
    if kind == CYLINDER:
        return _outside(math.hypot(x, y) - size[0], abs(z) - size[1])
    if kind == MESH:
        first, end = bodies.spans[j, 0], bodies.spans[j, 1]
        return _to_mesh(bodies.planes[first:end], bodies.faces_m[first:end], x, y, z)
    return math.sqrt(x * x + y * y + z * z) - size[0]


@kernel
def arc_gap(start, bend, length, reach, bodies, j, x, y, z):
    """Signed distance from an arc to shape ``j`` at (x, y, z), less ``reach``; understated by SLACK or FINE_M at most.

    ``start`` is the arc's first point, tangent and direction of bending (9,).
    """
    least, seen = math.inf, math.inf
    share, width = 0.0, 1.0
    while share < 1.0:
        width = min(width, 1.0 - share)
        half = 0.5 * bend * (share + 0.5 * width)
        chord = length * (share + 0.5 * width) * (math.sin(half) / half if half > 1e-9 else 1.0)
        along, aside = chord * math.cos(half), chord * math.sin(half)
        gap = signed_distance(
            bodies,
            j,
            start[0] + along * start[3] + aside * start[6] - x,
            start[1] + along * start[4] + aside * start[7] - y,
            start[2] + along * start[5] + aside * start[8] - z,
        )
        gap -= reach
        seen = min(seen, gap)
        bound = gap - 0.5 * width * length
        if bound >= seen - max(SLACK * abs(seen), FINE_M):
            least = min(least, bound)
            share, width = share + width, 2.0 * width
        else:
            width *= 0.5
    return least
