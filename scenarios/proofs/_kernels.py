"""Compiled steps of the proofs: where contact is certain, and what bends are left. docs/possible.md derives them."""

import math

import numpy as np

from scenarios.kernels.jit import bare_kernel, kernel

NEAR_TRIES = 64  # a hull that is not shown to be near by then counts as far: nothing is proven by it
HALVINGS = 40
WHILE_S = 2.0  # obstacles that cannot be at section 1 for this long are not looked at
LONGEST_S = 1.5  # a pair whose part was free is looked at again after this: that part may be gone


@bare_kernel
def hull_distance(hulls, j, x, y, z, enough):
    """Bounds on the distance [m] of the hull of obstacle ``j``'s vertices from (x, y, z), given about its centre.

    Frank and Wolfe's method with exact line search: every iterate is a point of the hull, and a plane across its
    direction parts the hull from what is nearer. It ends when the upper bound is below ``enough`` or the lower is not;
    where ``enough`` is 0, when both agree.

    Returns:
        The upper and the lower bound.
    """
    first, end = hulls.spans[j, 0], hulls.spans[j, 1]
    vertices = hulls.vertices_m
    px, py, pz = hulls.middles_m[j, 0] - x, hulls.middles_m[j, 1] - y, hulls.middles_m[j, 2] - z
    lower, distance = 0.0, math.sqrt(px * px + py * py + pz * pz)
    if end - first == 1:
        return distance, distance
    for _ in range(NEAR_TRIES):
        if distance < enough or distance == 0.0:
            break
        least, best = math.inf, first
        for k in range(first, end):
            along = px * (vertices[k, 0] - x) + py * (vertices[k, 1] - y) + pz * (vertices[k, 2] - z)
            if along < least:
                least, best = along, k
        lower = max(lower, least / distance)
        if lower >= (enough if enough > 0.0 else (1.0 - 1e-9) * distance):
            break
        dx, dy, dz = vertices[best, 0] - x - px, vertices[best, 1] - y - py, vertices[best, 2] - z - pz
        length = dx * dx + dy * dy + dz * dz
        share = min(1.0, -(px * dx + py * dy + pz * dz) / length)
        px, py, pz = px + share * dx, py + share * dy, pz + share * dz
        distance = math.sqrt(px * px + py * py + pz * pz)
    return distance, lower


@kernel
def first_near(point, centers, j, hulls):
    """Number of the first of the ``centers`` (T, 3) of obstacle ``j`` at which it is over ``point`` (3,); -1: none."""
    reach = hulls.reaches_m[j]
    for k in range(centers.shape[0]):
        x, y, z = point[0] - centers[k, 0], point[1] - centers[k, 1], point[2] - centers[k, 2]
        if hull_distance(hulls, j, x, y, z, reach)[0] < reach:
            return k
    return -1


@kernel
def goal_covered_for(goal, radius, centers, hulls):
    """How long some obstacle at ``centers`` (m, 3) goes on to cover the ball about ``goal`` (3,) [s]; 0: none does."""
    longest = 0.0
    for j in range(centers.shape[0]):
        x, y, z = goal[0] - centers[j, 0], goal[1] - centers[j, 1], goal[2] - centers[j, 2]
        spare = hulls.reaches_m[j] - radius - hull_distance(hulls, j, x, y, z, 0.0)[0]
        longest = max(longest, spare / hulls.speeds_m_s[j])
    return longest


@bare_kernel
def _covers_lens(hulls, j, center, start, goal, start_radius, goal_radius):
    """Whether obstacle ``j`` covers what balls about ``start`` and ``goal`` (3,) have in common.

    That is within a ball: about the middle of the circle in which the spheres meet, when it lies between the centres;
    else the smaller ball.
    """
    dx, dy, dz = goal[0] - start[0], goal[1] - start[1], goal[2] - start[2]
    apart = math.sqrt(dx * dx + dy * dy + dz * dz)
    if start_radius + goal_radius < apart:
        return True
    along, radius = 0.0, start_radius
    if apart > 0.0:
        along = 0.5 * (apart + (start_radius * start_radius - goal_radius * goal_radius) / apart)
        if along >= apart:
            along, radius = apart, goal_radius
        elif along <= 0.0:
            along, radius = 0.0, start_radius
        else:
            radius = math.sqrt(max(0.0, start_radius * start_radius - along * along))
        along /= apart
    elif goal_radius < start_radius:
        radius = goal_radius
    reach = hulls.reaches_m[j] - radius
    x = start[0] + along * dx - center[0]
    y = start[1] + along * dy - center[1]
    z = start[2] + along * dz - center[2]
    return hull_distance(hulls, j, x, y, z, reach)[0] < reach


@kernel
def way_blocked_until(earliest, end, times, centers, hulls, start, goal, start_radius, goal_radius, speed):
    """Time by ``end`` [s] before which no tip arrives, seen that none arrives before ``earliest`` [s].

    Args:
        earliest: A time before which none arrives.
        end: What lies behind is not looked at.
        times: When to look, none after ``earliest``, shape (T,), [s].
        centers: Obstacles' centres at ``times``, shape (T, m, 3), [m].
        hulls: The obstacles.
        start: Where the tip starts, shape (3,), [m].
        goal: The goal, shape (3,), [m].
        start_radius: How far from ``start`` the tip may be at t = 0 [m].
        goal_radius: How far from ``goal`` it may be on arrival [m].
        speed: The tip's largest [m/s].
    """
    for k in range(times.shape[0]):
        t = times[k]
        for j in range(centers.shape[1]):
            near, low, high = start_radius + speed * t, earliest, end
            # The later the arrival, the larger the lens: what is covered for one is covered for all before.
            if not _covers_lens(hulls, j, centers[k, j], start, goal, near, goal_radius + speed * (low - t)):
                continue
            for _ in range(HALVINGS):
                middle = 0.5 * (low + high)
                if _covers_lens(hulls, j, centers[k, j], start, goal, near, goal_radius + speed * (middle - t)):
                    low = middle
                else:
                    high = middle
            earliest = low
    return earliest


@kernel
def spread(alive, allowed, offsets, out):
    """Set ``out`` (N, N) to the allowed cells that are alive or at one of ``offsets`` (O, 2) from one that is.

    ``offsets`` hold with each (i, j) every one nearer to (0, 0) along rows and columns, so only cells at the rim of
    ``alive`` have anything to add.
    """
    n = alive.shape[0]
    out[:] = alive
    for i in range(1, n - 1):  # the outermost cells are beyond the largest bend
        for j in range(1, n - 1):
            if not alive[i, j] or (
                alive[i - 1, j]
                and alive[i + 1, j]
                and alive[i, j - 1]
                and alive[i, j + 1]
                and alive[i - 1, j - 1]
                and alive[i - 1, j + 1]
                and alive[i + 1, j - 1]
                and alive[i + 1, j + 1]
            ):
                continue
            for o in range(offsets.shape[0]):
                a, b = i + offsets[o, 0], j + offsets[o, 1]
                if 0 <= a < n and 0 <= b < n and allowed[a, b]:
                    out[a, b] = True


@kernel
def strike(alive, until, culprits, now, points, spacing, shifts, centers, hulls):
    """Drop from ``alive`` (N, N) the cells all of whose bends are hit at time ``now``.

    Args:
        alive: Cells that may be had; changed.
        until: Time before which a cell need not be looked at, shape (N, N), [s]; changed.
        culprits: Which of the obstacles looked at hit a cell last: the first to look at; shape (N, N); changed.
        now: The time [s].
        points: Backbone points at the cells' middles, shape (N, N, S, 3), [m].
        spacing: How far one is from the next along the backbone [m].
        shifts: How far each of these may be from there within a cell, increasing, shape (S,), [m].
        centers: Obstacle centres now, shape (m, 3), [m].
        hulls: The obstacles.
    """
    # Obstacles that no bend will bring into touch for a while are left to a later look at everything.
    frame, near, count, later = np.eye(3), np.empty(centers.shape[0], np.int64), 0, math.inf
    for j in range(centers.shape[0]):
        apart = math.sqrt(centers[j, 0] ** 2 + centers[j, 1] ** 2 + centers[j, 2] ** 2)
        gap = apart - spacing * points.shape[2] - hulls.extents_m[j] - hulls.reaches_m[j]
        if gap > WHILE_S * hulls.speeds_m_s[j]:
            later = min(later, gap / hulls.speeds_m_s[j])
        else:
            near[count] = j
            count += 1
    for i in range(alive.shape[0]):
        for j in range(alive.shape[1]):
            if alive[i, j] and until[i, j] <= now:
                free, culprits[i, j] = _free_for(
                    points[i, j], spacing, shifts, centers, near[:count], frame, hulls, culprits[i, j]
                )
                until[i, j] = now + min(free, later)
                alive[i, j] = free >= 0.0


@bare_kernel
def _free_for(points, spacing, shifts, centers, near, frame, hulls, first):
    """How long ``points`` (S, 3), each anywhere within its shift (S,), will not all be hit for certain [s].

    Points and centres (m, 3) are given in a frame (3, 3). Negative when the points are hit now: one of them, wherever
    it is, is in touch with one of the obstacles ``near``. Of these number ``first`` is looked at first; returns as well
    which one it is.
    """
    free = math.inf
    for turn in range(near.shape[0]):
        number = (first + turn) % near.shape[0]
        j = near[number]
        s = 0
        while s < points.shape[0]:
            x, y, z = points[s, 0] - centers[j, 0], points[s, 1] - centers[j, 1], points[s, 2] - centers[j, 2]
            reach = hulls.reaches_m[j] - shifts[s]
            gap = math.sqrt(x * x + y * y + z * z) - hulls.extents_m[j] - reach
            if gap < 0.0 and reach > 0.0:
                wx = frame[0, 0] * x + frame[0, 1] * y + frame[0, 2] * z
                wy = frame[1, 0] * x + frame[1, 1] * y + frame[1, 2] * z
                wz = frame[2, 0] * x + frame[2, 1] * y + frame[2, 2] * z
                upper, lower = hull_distance(hulls, j, wx, wy, wz, reach)
                if upper < reach:
                    return -1.0, number
                gap = lower - reach
            # The gap shrinks no faster than the backbone goes on: points for which half of it is left are passed over.
            half = max(0.5 * gap, 0.0)
            free = min(free, half / hulls.speeds_m_s[j])
            s += 1 + int(min(half / spacing, points.shape[0]))
    return free, first


@kernel
def spread_pairs(alive, rows, neighbours, out):
    """Set ``out`` (K, K) to the pairs of cells that are alive or next to one that is, both sections apart.

    Args:
        alive: Pairs of cells of sections 1 and 2, shape (K, K).
        rows: Cells of section 1 that may be had, shape (K,).
        neighbours: Cells that either section may bend to from a cell, itself first, -1 behind the last; shape (K, M).
        out: The result.
    """
    count = alive.shape[0]
    has_pairs, row = np.empty(count, np.bool_), np.empty(count, np.bool_)
    for a in range(count):
        has_pairs[a] = alive[a].any()
    for a in range(count):
        out[a] = False
        if not rows[a]:
            continue
        row[:] = False
        for b in neighbours[a]:
            if b >= 0 and has_pairs[b]:
                row |= alive[b]
        for c in range(count):
            for d in neighbours[c]:
                if d < 0 or row[d]:
                    out[a, c] = d >= 0
                    break


@bare_kernel
def _seen_from(frame, origin, point):
    """Coordinates of ``point`` (3,) in a frame (3, 3) at ``origin`` (3,)."""
    x, y, z = point[0] - origin[0], point[1] - origin[1], point[2] - origin[2]
    return (
        frame[0, 0] * x + frame[1, 0] * y + frame[2, 0] * z,
        frame[0, 1] * x + frame[1, 1] * y + frame[2, 1] * z,
        frame[0, 2] * x + frame[1, 2] * y + frame[2, 2] * z,
    )


@kernel
def strike_pairs(
    alive, until, culprits, now, parts, frames, ends, points, spacing, shifts, centers, hulls, start, goal, far
):
    """Drop from ``alive`` (K, K) the pairs of cells all of whose bends are hit, or too far from start or goal.

    A cell of section 1 is looked at in parts, the one in the middle first; the pair is hit when all of them are.

    Args:
        alive: Pairs of cells of sections 1 and 2; changed.
        until: Time before which a pair need not be looked at, shape (K, K), [s]; changed.
        culprits: Obstacle that hit a pair last: the first to look at; shape (K, K); changed.
        now: The time [s].
        parts: Parts of the cells of section 1 that may be had, shape (K, P).
        frames: Frames at the end of section 1 in the middle of each part, shape (K, P, 3, 3).
        ends: Where it ends there, shape (K, P, 3), [m].
        points: Points of section 2 at its cells' middles, in its base frame, shape (K, S, 3), [m].
        spacing: How far one is from the next along the backbone [m].
        shifts: How far each of these may be from there, section 1 within a part, increasing, shape (S,), [m].
        centers: Obstacle centres now, shape (m, 3), [m].
        hulls: The obstacles.
        start: Where the tip starts, shape (3,), [m].
        goal: The goal, shape (3,), [m].
        far: How far the end of section 2, cells' middles taken, may be from start and goal, and from the goal to
            arrive before the next look, shape (3,), [m].

    Returns:
        The number of pairs left, and whether one of them may arrive before the next look.
    """
    count, last = alive.shape[0], points.shape[1] - 1
    middle = parts.shape[1] // 2
    looked, local = np.empty(parts.shape[1], np.int64), np.empty((parts.shape[1], centers.shape[0], 3))
    everyone, left, may_arrive = np.arange(centers.shape[0]), 0, False
    for a in range(count):
        if not alive[a].any():
            continue
        used = 0
        for k in range(parts.shape[1]):
            p = (middle + k) % parts.shape[1]
            if parts[a, p]:
                looked[used] = p
                for j in range(centers.shape[0]):
                    local[used, j, 0], local[used, j, 1], local[used, j, 2] = _seen_from(
                        frames[a, p], ends[a, p], centers[j]
                    )
                used += 1
        start_x, start_y, start_z = _seen_from(frames[a, middle], ends[a, middle], start)
        goal_x, goal_y, goal_z = _seen_from(frames[a, middle], ends[a, middle], goal)
        for c in range(count):
            if not alive[a, c]:
                continue
            x, y, z = points[c, last, 0], points[c, last, 1], points[c, last, 2]
            from_start = math.sqrt((x - start_x) ** 2 + (y - start_y) ** 2 + (z - start_z) ** 2)
            from_goal = math.sqrt((x - goal_x) ** 2 + (y - goal_y) ** 2 + (z - goal_z) ** 2)
            if from_start > far[0] or from_goal > far[1]:
                alive[a, c] = False
                continue
            if until[a, c] <= now:
                free = -1.0
                for k in range(used):
                    frame = frames[a, looked[k]]
                    free, culprits[a, c] = _free_for(
                        points[c], spacing, shifts, local[k], everyone, frame, hulls, culprits[a, c]
                    )
                    if free >= 0.0:
                        break
                if free < 0.0:
                    alive[a, c] = False
                    continue
                until[a, c] = now + min(free, LONGEST_S)
            left += 1
            may_arrive |= from_goal <= far[2]
    return left, may_arrive
