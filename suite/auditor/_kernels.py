"""Compiled geometry of the audit: its own kinematics and distances, shared with no planner. docs/audit.md derives all.

The backbone is walked chord by chord. The part of an arc that a chord of bend a and arc length s cuts off stays within
s * a / 8 of the chord, so the capsule of the chord with that pad holds the true piece. No distance is overstated.
"""

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from scenarios.kernels.jit import kernel
from suite.auditor.shapes._kernels import SPHERE, arc_gap

CHORDS = 8  # per section
SUB_CHORDS = 16  # per chord, where a distance is too small for the pad
REFINE_RATIO = 10.0  # too small: below this many pads

CONTACT_M = 1e-4
KEPT_SHARE = 0.75  # of the smallest clearance seen: advancing proves that no instant has less
DEEPER_SHARE = 0.25  # of the depth seen, CONTACT_M at least: advancing proves that no instant is deeper by more
MAX_LOOKS = 1_000_000  # beyond one per timed state; seconds of work. What is not proven by then counts as contact

SMOOTH, TRACK = range(2)

FloatArray = npt.NDArray[np.float64]


class Work(NamedTuple):
    """Work space of a look at n sections."""

    q: FloatArray
    nodes: FloatArray
    bends: FloatArray
    fine: FloatArray
    arm_speeds: FloatArray
    nearest: npt.NDArray[np.int64]  # obstacle and section with the smallest clearance of the last look
    touching: npt.NDArray[np.int64]  # those of the first contact; -1 until then
    looks_left: npt.NDArray[np.int64]


@kernel
def make_work(n):
    """Work space for n sections."""
    return Work(
        np.empty(2 * n),
        np.empty((n * (CHORDS + 1), 9)),
        np.empty(n),
        np.empty((SUB_CHORDS + 1, 9)),
        np.zeros(n * CHORDS),
        np.zeros(2, dtype=np.int64),
        np.full(2, -1, dtype=np.int64),
        np.full(1, MAX_LOOKS, dtype=np.int64),
    )


@kernel
def _roll(nodes, first, bend, length, chords):
    """Walk along an arc in equal chords from row ``first`` of ``nodes``, and write the ``chords`` rows after it.

    A row is point 0:3, tangent 3:6 and the direction of bending 6:9. Each chord leaves its node at half its own bend.
    """
    half = 0.5 * bend / chords
    sin, cos = math.sin(half), math.cos(half)
    chord = length / chords * (sin / half if half > 1e-9 else 1.0)
    turn_sin, turn_cos = 2.0 * sin * cos, 1.0 - 2.0 * sin * sin
    px, py, pz = nodes[first, 0], nodes[first, 1], nodes[first, 2]
    zx, zy, zz = nodes[first, 3], nodes[first, 4], nodes[first, 5]
    dx, dy, dz = nodes[first, 6], nodes[first, 7], nodes[first, 8]
    for i in range(first + 1, first + chords + 1):
        px += chord * (cos * zx + sin * dx)
        py += chord * (cos * zy + sin * dy)
        pz += chord * (cos * zz + sin * dz)
        zx, dx = turn_cos * zx + turn_sin * dx, turn_cos * dx - turn_sin * zx
        zy, dy = turn_cos * zy + turn_sin * dy, turn_cos * dy - turn_sin * zy
        zz, dz = turn_cos * zz + turn_sin * dz, turn_cos * dz - turn_sin * zz
        nodes[i, 0], nodes[i, 1], nodes[i, 2] = px, py, pz
        nodes[i, 3], nodes[i, 4], nodes[i, 5] = zx, zy, zz
        nodes[i, 6], nodes[i, 7], nodes[i, 8] = dx, dy, dz


@kernel
def lay_out(q, section_length, chords, nodes, bends):
    """Walk the whole backbone, ``chords`` to a section: rows of ``nodes`` (n * (chords + 1), 9), ``bends`` (n,)."""
    across = np.empty(3)  # unit vector across the plane of bending: a section turns about it
    c_before, s_before = 1.0, 0.0
    for i in range(bends.shape[0]):
        u, v = q[2 * i], q[2 * i + 1]
        bend = math.sqrt(u * u + v * v)
        c, s = (u / bend, v / bend) if bend > 0.0 else (1.0, 0.0)
        first = i * (chords + 1)
        row = nodes[first]
        if i == 0:
            row[:] = 0.0
            row[5], row[6], row[7] = 1.0, c, s
            across[0], across[1], across[2] = -s, c, 0.0
        else:
            # From the plane of the section before, by the angle between the two about the tangent.
            end = nodes[first - 1]
            along, aside = c * c_before + s * s_before, s * c_before - c * s_before
            for k in range(3):
                row[k], row[3 + k] = end[k], end[3 + k]
                row[6 + k] = along * end[6 + k] + aside * across[k]
                across[k] = along * across[k] - aside * end[6 + k]
        _roll(nodes, first, bend, section_length, chords)
        bends[i], c_before, s_before = bend, c, s


@kernel
def tip(q, section_length, nodes, bends):
    """Tip position; one chord per section suffices, since an arc's chord is exact."""
    lay_out(q, section_length, 1, nodes, bends)
    last = 2 * bends.shape[0] - 1
    return nodes[last, 0], nodes[last, 1], nodes[last, 2]


@kernel
def _to_chord(a, b, x, y, z):
    """Distance from (x, y, z) to the segment between the points of two nodes."""
    ux, uy, uz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    wx, wy, wz = x - a[0], y - a[1], z - a[2]
    along = (wx * ux + wy * uy + wz * uz) / (ux * ux + uy * uy + uz * uz)
    along = min(1.0, max(0.0, along))
    wx, wy, wz = wx - along * ux, wy - along * uy, wz - along * uz
    return math.sqrt(wx * wx + wy * wy + wz * wz)


@kernel
def _to_arc(start, bend, length, x, y, z, fine):
    """Distance from (x, y, z) to an arc by sub-chords, less their pad; ``fine`` (SUB_CHORDS + 1, 9) is work space."""
    for k in range(9):
        fine[0, k] = start[k]
    _roll(fine, 0, bend, length, SUB_CHORDS)
    nearest = math.inf
    for k in range(SUB_CHORDS):
        nearest = min(nearest, _to_chord(fine[k], fine[k + 1], x, y, z))
    return nearest - length * bend / (8.0 * SUB_CHORDS * SUB_CHORDS)


@kernel
def _last_by(times, t):
    """Index of the last of ``times`` (k,) that is not after ``t``; 0 if there is none."""
    low, high = 0, times.shape[0]
    while high - low > 1:
        middle = (low + high) // 2
        if times[middle] <= t:
            low = middle
        else:
            high = middle
    return low


@kernel
def obstacle_at(j, t, truth):
    """Centre of obstacle ``j`` at time ``t``, its speed from then on, and how long that speed holds: x, y, z, v, s."""
    if truth.laws[j] == SMOOTH:
        course = truth.courses[j]
        x, y, z = course[0] + t * course[3], course[1] + t * course[4], course[2] + t * course[5]
        for w in range(truth.spans[j, 0], truth.spans[j, 1]):
            wave = truth.waves[w]
            c, s = math.cos(wave[6] * t), math.sin(wave[6] * t)
            x += c * wave[0] + s * wave[3]
            y += c * wave[1] + s * wave[4]
            z += c * wave[2] + s * wave[5]
        return x, y, z, truth.speeds_m_s[j], math.inf
    points = truth.points[truth.spans[j, 0] : truth.spans[j, 1]]
    last = points.shape[0] - 1
    if t < points[0, 0]:
        return points[0, 1], points[0, 2], points[0, 3], 0.0, points[0, 0] - t
    if t >= points[last, 0]:
        return points[last, 1], points[last, 2], points[last, 3], 0.0, math.inf
    low = _last_by(points[:, 0], t)
    a, b = points[low], points[low + 1]
    span = b[0] - a[0]
    share = (t - a[0]) / span
    dx, dy, dz = b[1] - a[1], b[2] - a[2], b[3] - a[3]
    speed = math.sqrt(dx * dx + dy * dy + dz * dz) / span
    return a[1] + share * dx, a[2] + share * dy, a[3] + share * dz, speed, b[0] - t


@kernel
def kept(smallest):
    """The clearance above which advancing keeps all instants, once ``smallest`` has been seen."""
    if smallest >= CONTACT_M:
        return KEPT_SHARE * smallest
    return smallest - max(CONTACT_M, DEEPER_SHARE * abs(smallest))


@kernel
def _look(q, t, soonest, smallest_before, section_length, arm_radius, truth, work):
    """Clearance at an instant, and a time within which no clearance falls to what is ``kept`` of the smallest seen.

    That time is at most ``soonest``: inf for all there is, 0 to spare the work where only the clearance is wanted.
    """
    lay_out(q, section_length, CHORDS, work.nodes, work.bends)
    work.looks_left[0] -= 1
    sections, obstacles = work.bends.shape[0], truth.radii_m.shape[0]
    # What was nearest at the last look comes first: next to it the rest hardly ever matters, and a bound suffices.
    smallest, first = math.inf, work.nearest[0]
    for turn in range(obstacles):
        j = (first + turn) % obstacles
        x, y, z, speed, holds = obstacle_at(j, t, truth)
        reach = arm_radius + truth.radii_m[j]
        for i in range(sections):
            middle = work.nodes[i * (CHORDS + 1) + CHORDS // 2]
            apart = math.sqrt((middle[0] - x) ** 2 + (middle[1] - y) ** 2 + (middle[2] - z) ** 2)
            bound = apart - 0.5 * section_length - reach
            fastest = work.arm_speeds[(i + 1) * CHORDS - 1] + truth.speeds_m_s[j]
            if bound >= smallest and bound - kept(min(smallest, smallest_before)) >= soonest * fastest:
                continue
            bend, length = work.bends[i] / CHORDS, section_length / CHORDS
            pad = length * bend / 8.0
            for k in range(CHORDS):
                node = i * (CHORDS + 1) + k
                if truth.bodies.kinds[j] == SPHERE:
                    gap = _to_chord(work.nodes[node], work.nodes[node + 1], x, y, z) - reach - pad
                    if gap < REFINE_RATIO * pad:
                        gap = _to_arc(work.nodes[node], bend, length, x, y, z, work.fine) - reach
                else:
                    gap = arc_gap(
                        work.nodes[node], bend, length, arm_radius + truth.pads_m[j], truth.bodies, j, x, y, z
                    )
                if gap < smallest:
                    smallest = gap
                    work.nearest[0], work.nearest[1] = j, i
                spare, arm_speed = gap - kept(min(smallest, smallest_before)), work.arm_speeds[i * CHORDS + k]
                # At the obstacle's largest speed for as long as it takes, or at its present one while that holds.
                by_present = min(spare / (arm_speed + speed), holds)
                soonest = min(soonest, max(spare / (arm_speed + truth.speeds_m_s[j]), by_present))
    return smallest, soonest


@kernel
def speed_bounds(q0, q1, duration, section_length, chords, out):
    """Bound the speed of every body point, chord by chord, on the way from ``q0`` to ``q1``: ``out`` (n * chords,)."""
    carried, turned = 0.0, 0.0  # speed of the section's base, and of its frame's rotation
    for i in range(q0.shape[0] // 2):
        rate = math.hypot(q1[2 * i] - q0[2 * i], q1[2 * i + 1] - q0[2 * i + 1]) / duration
        for k in range(chords):
            share = (k + 1.0) / chords
            out[i * chords + k] = carried + section_length * share * (turned + 0.5 * share * rate)
        carried += section_length * (turned + 0.5 * rate)
        turned += rate


@kernel
def interpolate(q0, q1, share, q):
    """Write the configuration at ``share`` of the way from ``q0`` to ``q1`` into ``q``."""
    for c in range(q.shape[0]):
        q[c] = q0[c] + share * (q1[c] - q0[c])


@kernel
def look_at(times, configurations, t, section_length, arm_radius, truth, work):
    """Clearance at time ``t`` of a motion that is free of lies; before its first state and after its last it rests."""
    k = _last_by(times, t)
    after = min(k + 1, times.shape[0] - 1)
    span = times[after] - times[k]
    share = min(1.0, max(0.0, (t - times[k]) / span)) if span > 0.0 else 0.0
    interpolate(configurations[k], configurations[after], share, work.q)
    return _look(work.q, t, 0.0, math.inf, section_length, arm_radius, truth, work)[0]


@kernel
def _touch(work):
    """Keep what is nearest at the first contact."""
    if work.touching[0] < 0:
        work.touching[0], work.touching[1] = work.nearest[0], work.nearest[1]


@kernel
def _advance(q0, q1, t0, duration, start, stop, smallest, section_length, arm_radius, truth, work):
    """Conservative advancement over [start, stop) of the motion from (q0, t0) to (q1, t0 + duration).

    Returns the time of the first contact (nan: none), the clearance at ``start`` and the smallest seen.
    """
    share, until = (start - t0) / duration, (stop - t0) / duration
    touched, at_start = math.nan, math.nan
    while True:
        t = t0 + share * duration
        interpolate(q0, q1, share, work.q)
        gap, safe = _look(work.q, t, math.inf, smallest, section_length, arm_radius, truth, work)
        smallest = min(smallest, gap)
        if math.isnan(at_start):
            at_start = gap
        ahead = share + safe / duration
        unproven = ahead == share or work.looks_left[0] < 0  # not even a tick of the clock is proven
        if math.isnan(touched) and (gap < CONTACT_M or unproven):
            touched = t
            _touch(work)
        share = ahead
        if share >= until or unproven:
            return touched, at_start, smallest


@kernel
def contacts(times, configurations, end, section_length, arm_radius, truth):
    """Look for contacts over [times[0], end], a motion free of lies, at whole seconds and at every instant.

    Returns the time of the first contact at a whole second, of the first at any instant (nan: none), the smallest
    clearance of all, and which obstacle and section touched first (-1: none). Once the work that is allowed is done,
    only whole seconds are still looked at.
    """
    work = make_work(configurations.shape[1] // 2)
    work.looks_left[0] += times.shape[0]
    per_step, swept, smallest = math.nan, math.nan, math.inf
    for k in range(times.shape[0] - 1):
        duration = times[k + 1] - times[k]
        if duration <= 0.0:
            continue
        q0, q1 = configurations[k], configurations[k + 1]
        speed_bounds(q0, q1, duration, section_length, CHORDS, work.arm_speeds)
        start, last = times[k], min(times[k + 1], end)
        while start < last:
            # Advancing starts anew at whole seconds, so that swept is never more lenient than per step.
            stop = min(last, math.floor(start) + 1.0)
            whole = start == math.floor(start)
            gap = math.inf
            if work.looks_left[0] >= 0:
                touched, gap, smallest = _advance(
                    q0, q1, times[k], duration, start, stop, smallest, section_length, arm_radius, truth, work
                )
                swept = touched if math.isnan(swept) else swept
            elif whole:
                interpolate(q0, q1, (start - times[k]) / duration, work.q)
                gap = _look(work.q, start, 0.0, smallest, section_length, arm_radius, truth, work)[0]
                smallest = min(smallest, gap)
            if whole and gap <= 0.0 and math.isnan(per_step):
                per_step = start
            start = stop
    gap = look_at(times, configurations, end, section_length, arm_radius, truth, work)
    smallest = min(smallest, gap)
    if gap < CONTACT_M and math.isnan(swept):
        swept = end
        _touch(work)
    if gap <= 0.0 and end == math.floor(end) and math.isnan(per_step):
        per_step = end
    return per_step, swept, smallest, work.touching[0], work.touching[1]
