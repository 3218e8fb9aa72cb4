"""Distance between the arm's body and moving spheres, at an instant and over a motion.

The body is every point within the arm's radius of the backbone. A backbone section is a circular arc, to which a
point's distance has a closed form; nothing is sampled and nothing needs a pad. The closed form is our own.

``world`` is a ``scenarios.world.SampledWorld``: centres and radii linear in time between samples, held outside them.
"""

import math

import numpy as np

from scenarios.kernels.jit import bare_kernel, kernel
from scenarios.kernels.kinematics import ARC_SIZE, section_arcs


@bare_kernel
def distance_to_arc(arc, x, y, z):
    """Distance [m] from the point (x, y, z) to the backbone section ``arc`` (a row of ``section_arcs``)."""
    wx, wy, wz = x - arc[0], y - arc[1], z - arc[2]
    a = wx * arc[3] + wy * arc[4] + wz * arc[5]
    b = wx * arc[6] + wy * arc[7] + wz * arc[8]
    h = wx * arc[9] + wy * arc[10] + wz * arc[11]
    inward = arc[15] - a
    # Seen from the circle's centre, the point lies between the arc's two ends (both bends are within [0, pi]).
    if h >= 0.0 and arc[16] * inward >= arc[17] * h:
        off = math.sqrt(inward * inward + h * h) - arc[15]
        return math.sqrt(off * off + b * b)
    ex, ey, ez = x - arc[12], y - arc[13], z - arc[14]
    return math.sqrt(min(wx * wx + wy * wy + wz * wz, ex * ex + ey * ey + ez * ez))


@bare_kernel
def _bracket(t, world):
    """Index of the sample at or before ``t`` and the share of the interval that has passed."""
    passed = (t - world.start_s) / world.step_s
    last = world.centers_m.shape[0] - 1
    if passed <= 0.0:
        return 0, 0.0
    if passed >= last:
        return last - 1, 1.0
    k = int(passed)
    return k, passed - k


@bare_kernel
def arc_clearances(arcs, t, arm_radius, world, out):
    """Signed distance of each section to the nearest obstacle at time ``t`` into ``out`` (n,) [m]; inf without any.

    ``arcs`` are laid out by ``section_arcs``. Returns the smallest entry.
    """
    k, share = _bracket(t, world)
    centers, radii = world.centers_m, world.radii_m
    out[:] = math.inf
    smallest = math.inf
    for j in range(centers.shape[1]):
        x = centers[k, j, 0] + share * (centers[k + 1, j, 0] - centers[k, j, 0])
        y = centers[k, j, 1] + share * (centers[k + 1, j, 1] - centers[k, j, 1])
        z = centers[k, j, 2] + share * (centers[k + 1, j, 2] - centers[k, j, 2])
        reach = arm_radius + radii[k, j] + share * (radii[k + 1, j] - radii[k, j])
        for i in range(arcs.shape[0]):
            gap = distance_to_arc(arcs[i], x, y, z) - reach
            out[i] = min(out[i], gap)
            smallest = min(smallest, gap)
    return smallest


@bare_kernel
def section_clearances(q, t, section_length, arm_radius, world, arcs, out):
    """``arc_clearances`` of the body at ``q`` (2n,) [rad]; ``arcs`` (n, ARC_SIZE) is work space."""
    section_arcs(q, section_length, arcs)
    return arc_clearances(arcs, t, arm_radius, world, out)


@bare_kernel
def motion_bounds(q0, q1, duration, section_length, speed, out):
    """Bound on how far each section and any obstacle may approach each other over a motion, into ``out`` (n,) [m].

    A point of section i moves at most sum_{j<i} (L/2 + (i-j) L) |dq_j| + (L/2) |dq_i|: docs/audit.md derives it; an
    obstacle's surface approaches at most at ``speed`` [m/s] for ``duration`` [s].
    """
    carried = 0.0  # displacement bound of the section's base over the whole motion
    turned = 0.0  # bound on its rotation
    for i in range(out.shape[0]):
        change = math.hypot(q1[2 * i] - q0[2 * i], q1[2 * i + 1] - q0[2 * i + 1])
        carried += section_length * turned
        out[i] = carried + 0.5 * section_length * change + speed * duration
        carried += 0.5 * section_length * change
        turned += change


@kernel
def clearances(configurations, times, section_length, arm_radius, world):
    """Signed distance of the body to the nearest obstacle: (N, 2n) [rad] and (N,) [s] -> (N,) [m]."""
    n = configurations.shape[1] // 2
    arcs, sections = np.empty((n, ARC_SIZE)), np.empty(n)
    out = np.empty(configurations.shape[0])
    for i in range(configurations.shape[0]):
        out[i] = section_clearances(configurations[i], times[i], section_length, arm_radius, world, arcs, sections)
    return out


@kernel
def motion_clear_until(q0, t0, q1, t1, margin, tolerance, section_length, arm_radius, world):
    """Share of the motion from (q0, t0) to (q1, t1), linear in bending vectors, that is proven collision-free.

    Conservative advancement (Mirtich 1996): a section at distance d cannot touch before d / (its speed bound +
    obstacle speed: ``motion_bounds``), so time may advance by the smallest such quotient over the sections.

    Args:
        q0: Bending vectors at the start, shape (2n,), [rad].
        t0: Time of the start [s].
        q1: Bending vectors at the end, shape (2n,), [rad].
        t1: Time of the end [s], not before t0.
        margin: Clearance to keep at every instant [m].
        tolerance: Clearance beyond the margin below which advancing stops and a collision is reported [m].
        section_length: Length of each section [m].
        arm_radius: Radius of the body [m].
        world: The obstacles.

    Returns:
        The proven share in [0, 1] (1: the whole motion is free) and the number of states looked at.
    """
    n = q0.shape[0] // 2
    arcs, gaps, bounds, q = np.empty((n, ARC_SIZE)), np.empty(n), np.empty(n), np.empty(2 * n)
    duration = t1 - t0
    motion_bounds(q0, q1, duration, section_length, world.speed_m_s, bounds)
    share, states = 0.0, 0
    while True:
        for k in range(2 * n):
            q[k] = q0[k] + share * (q1[k] - q0[k])
        t = t0 + share * duration
        section_clearances(q, t, section_length, arm_radius, world, arcs, gaps)
        states += 1
        advance = math.inf
        for i in range(n):
            gap = gaps[i] - margin
            if gap <= tolerance:
                return share, states
            if bounds[i] > 0.0:
                advance = min(advance, gap / bounds[i])
        if share >= 1.0:
            return 1.0, states
        share = min(1.0, share + advance)
