"""Maximum a posteriori fit of a constant turn, grown from short histories to long ones.

State of the motion: position ``p``, velocity ``v`` and curvature vector ``c`` (towards the turn's centre, one over its
radius long, at right angles to ``v``). In the frame of ``v`` and ``c`` the errors in the turn's plane (5 unknowns) and
across it (3) decouple, so a Gauss-Newton step solves a 5 x 5 and a 3 x 3 system.
"""

import math

import numpy as np

from planners.prediction._kernels import invert, line_through, window_start
from scenarios.kernels.jit import kernel

STEPS = 5
"""Gauss-Newton steps on one history at the most; a start from a shorter history takes about two."""
ENOUGH = 0.02
"""A fit has converged when a step lowers the sum of squares by no more than this share of the noise's variance."""
SMALL_RAD = 1e-2
"""Turned angle below which the turn is written as a series."""


@kernel
def frame_of(v, c, axes):
    """Unit vectors along ``v``, ``c`` and across into the rows of ``axes`` (3, 3); returns speed and curvature."""
    speed = math.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
    if speed > 0.0:
        axes[0] = v / speed
    else:
        axes[0] = np.array((1.0, 0.0, 0.0))
    along = c[0] * axes[0, 0] + c[1] * axes[0, 1] + c[2] * axes[0, 2]
    axes[1] = c - along * axes[0]
    curvature = math.sqrt(axes[1, 0] ** 2 + axes[1, 1] ** 2 + axes[1, 2] ** 2)
    if curvature > 1e-9:
        axes[1] /= curvature
    else:  # straight: any direction across will do
        curvature = 0.0
        least = np.argmin(np.abs(axes[0]))
        axes[1] = -axes[0, least] * axes[0]
        axes[1, least] += 1.0
        axes[1] /= math.sqrt(axes[1, 0] ** 2 + axes[1, 1] ** 2 + axes[1, 2] ** 2)
    axes[2, 0] = axes[0, 1] * axes[1, 2] - axes[0, 2] * axes[1, 1]
    axes[2, 1] = axes[0, 2] * axes[1, 0] - axes[0, 0] * axes[1, 2]
    axes[2, 2] = axes[0, 0] * axes[1, 1] - axes[0, 1] * axes[1, 0]
    return speed, curvature


@kernel
def turn(t, speed, curvature, sine, cosine):
    """The turn after ``t``, whose angle has the given sine and cosine.

    Returns:
        Place along (u) and towards the centre (w); per unit of speed (a, b); derivatives of u and w by curvature (c, d)
        and of the place across the plane by curvature across it (e). The other derivatives of (u, w) are
        ``t * (cosine, sine)`` by speed and ``t * (-b, a)`` by velocity inwards; ``t * a`` by velocity across.
    """
    x = curvature * speed * t
    if abs(x) < SMALL_RAD:
        x2 = x * x
        a, b = 1.0 - x2 / 6.0 + x2 * x2 / 120.0, x * (0.5 - x2 / 24.0)
        c, d, e = x * (x2 / 30.0 - 1.0 / 3.0), 0.5 - x2 / 8.0 + x2 * x2 / 144.0, 0.5 - x2 / 24.0 + x2 * x2 / 720.0
    else:
        a, b = sine / x, (1.0 - cosine) / x
        c, d, e = (cosine - a) / x, (sine - b) / x, b / x
    way = speed * t
    return way * a, way * b, a, b, way * way * c, way * way * d, way * way * e


@kernel
def normal_equations(times, positions, first, last, state, axes, inside, across):
    """Matrix (its lower half) and right side of ``inside`` (5, 6) and ``across`` (3, 4) from observations first..last.

    The unknowns are, in the plane, two components of position, two of velocity and curvature; across it position,
    velocity and curvature. Returns the sum of squared residuals and the number of observations that were not lost.
    """
    speed, curvature = frame_of(state[1], state[2], axes)
    rate = speed * curvature
    squares, seen = 0.0, 0
    r0 = r1 = r2 = r3 = r4 = 0.0
    h20 = h21 = h22 = h30 = h31 = h32 = h33 = h40 = h41 = h42 = h43 = h44 = 0.0
    s0 = s1 = s2 = g10 = g11 = g20 = g21 = g22 = 0.0
    t, step, sine, cosine, step_sine, step_cosine = 0.0, 0.0, 0.0, 1.0, 0.0, 1.0
    for i in range(last, first - 1, -1):
        if i < last:  # the angle's sine and cosine from those before it; times are mostly one step apart
            if times[i] - times[i + 1] != step:
                step = times[i] - times[i + 1]
                step_sine, step_cosine = math.sin(rate * step), math.cos(rate * step)
            sine, cosine = sine * step_cosine + cosine * step_sine, cosine * step_cosine - sine * step_sine
            t = times[i] - times[last]
        if math.isnan(positions[i, 0]):
            continue
        seen += 1
        u, w, a, b, c, d, e = turn(t, speed, curvature, sine, cosine)
        dx, dy, dz = positions[i, 0] - state[0, 0], positions[i, 1] - state[0, 1], positions[i, 2] - state[0, 2]
        along = dx * axes[0, 0] + dy * axes[0, 1] + dz * axes[0, 2] - u
        inward = dx * axes[1, 0] + dy * axes[1, 1] + dz * axes[1, 2] - w
        off = dx * axes[2, 0] + dy * axes[2, 1] + dz * axes[2, 2]
        squares += along * along + inward * inward + off * off
        p0, p1, q0, q1 = t * cosine, t * sine, -t * b, t * a
        h20, h21, h22 = h20 + p0, h21 + p1, h22 + t * t
        h30, h31, h32, h33 = h30 + q0, h31 + q1, h32 + p0 * q0 + p1 * q1, h33 + q0 * q0 + q1 * q1
        h40, h41, h42, h43, h44 = h40 + c, h41 + d, h42 + p0 * c + p1 * d, h43 + q0 * c + q1 * d, h44 + c * c + d * d
        r0, r1, r2 = r0 + along, r1 + inward, r2 + p0 * along + p1 * inward
        r3, r4 = r3 + q0 * along + q1 * inward, r4 + c * along + d * inward
        g10, g11, g20, g21, g22 = g10 + q1, g11 + q1 * q1, g20 + e, g21 + q1 * e, g22 + e * e
        s0, s1, s2 = s0 + off, s1 + q1 * off, s2 + e * off
    inside[0, 0] = inside[1, 1] = seen
    inside[1, 0] = 0.0
    inside[2, 0], inside[2, 1], inside[2, 2] = h20, h21, h22
    inside[3, 0], inside[3, 1], inside[3, 2], inside[3, 3] = h30, h31, h32, h33
    inside[4, 0], inside[4, 1], inside[4, 2], inside[4, 3], inside[4, 4] = h40, h41, h42, h43, h44
    inside[0, 5], inside[1, 5], inside[2, 5], inside[3, 5], inside[4, 5] = r0, r1, r2, r3, r4
    across[0, 0], across[1, 0], across[1, 1], across[2, 0], across[2, 1], across[2, 2] = seen, g10, g11, g20, g21, g22
    across[0, 3], across[1, 3], across[2, 3] = s0, s1, s2
    return squares, seen


@kernel
def weigh_prior(variance, speed, curvature, speed_scale, curvature_scale, inside, across):
    """Add the prior, zero-mean normal in velocity and curvature, to the normal equations."""
    of_speed, of_curvature = variance / speed_scale**2, variance / curvature_scale**2
    inside[2, 2] += of_speed
    inside[3, 3] += of_speed
    inside[4, 4] += of_curvature
    across[1, 1] += of_speed
    across[2, 2] += of_curvature
    inside[2, 5] -= of_speed * speed
    inside[4, 5] -= of_curvature * curvature


@kernel
def moved(state, axes, speed, curvature, d, e, out):
    """The state after the in-plane step ``d`` (5,) and the step across ``e`` (3,); curvature turns with velocity."""
    scale = 1.0 / speed if speed > 1e-12 else 0.0
    for k in range(3):
        out[0, k] = state[0, k] + d[0] * axes[0, k] + d[1] * axes[1, k] + e[0] * axes[2, k]
        out[1, k] = (speed + d[2]) * axes[0, k] + d[3] * axes[1, k] + e[1] * axes[2, k]
        out[2, k] = (curvature + d[4]) * (axes[1, k] - scale * d[3] * axes[0, k]) + e[2] * (
            axes[2, k] - scale * e[1] * axes[0, k]
        )


@kernel
def advance(state, t):
    """Let the motion run for ``t`` [s], in place."""
    axes = np.empty((3, 3))
    speed, curvature = frame_of(state[1], state[2], axes)
    angle = curvature * speed * t
    sine, cosine = math.sin(angle), math.cos(angle)
    u, w, _, _, _, _, _ = turn(t, speed, curvature, sine, cosine)
    for k in range(3):
        state[0, k] += u * axes[0, k] + w * axes[1, k]
        state[1, k] = speed * (cosine * axes[0, k] + sine * axes[1, k])
        state[2, k] = curvature * (cosine * axes[1, k] - sine * axes[0, k])


@kernel
def refine(times, positions, first, last, floor, speed_scale, curvature_scale, state, inside, across):
    """Fit ``state`` (3, 3), at ``times[last]``, to the observations first..last by damped Gauss-Newton steps.

    The noise is estimated from the residuals as the fit goes on, never below ``floor`` [m]. Leaves the unscaled
    covariances of the errors in the plane in ``inside[:, :5]`` and across it in ``across[:, :3]``.

    Returns:
        The noise's variance per coordinate and the degrees of freedom it was estimated from.
    """
    axes, before = np.empty((3, 3)), state.copy()
    kept_inside, kept_across = np.empty((5, 6)), np.empty((3, 4))
    d, e = np.zeros(5), np.zeros(3)
    variance, freedom, damping, kept_squares, kept_prior = 0.0, 1.0, 0.0, math.inf, 0.0
    for step in range(STEPS):
        squares, seen = normal_equations(times, positions, first, last, state, axes, inside, across)
        speed, curvature = frame_of(state[1], state[2], axes)
        prior = (speed / speed_scale) ** 2 + (curvature / curvature_scale) ** 2
        if step == 0 or squares + variance * prior <= kept_squares + variance * kept_prior:
            before[:], kept_inside[:], kept_across[:] = state, inside, across
            kept_squares, kept_prior = squares, prior
            freedom = max(1.0, 3.0 * seen - 8.0)
            variance = max(squares / freedom, floor * floor)
            damping = 0.1 * damping if damping > 1e-6 else 0.0
        else:  # a step too far
            state[:], inside[:], across[:] = before, kept_inside, kept_across
            speed, curvature = frame_of(state[1], state[2], axes)
            damping = max(10.0 * damping, 1e-3)
        weigh_prior(variance, speed, curvature, speed_scale, curvature_scale, inside, across)
        for a in range(5):
            inside[a, a] *= 1.0 + damping
        for a in range(3):
            across[a, a] *= 1.0 + damping
        invert(inside, 5)
        invert(across, 3)
        gain = 0.0
        for a in range(5):
            d[a] = 0.0
            for b in range(5):
                d[a] += inside[a, b] * inside[b, 5]
            gain += d[a] * inside[a, 5]
        for a in range(3):
            e[a] = 0.0
            for b in range(3):
                e[a] += across[a, b] * across[b, 3]
            gain += e[a] * across[a, 3]
        moved(before, axes, speed, curvature, d, e, state)
        if gain < ENOUGH * variance:  # a step this small needs no second look
            break
    return variance, freedom


@kernel
def start_state(times, positions, first, last, floor, curvature_scale, state):
    """A first guess at ``times[last]``: a parabola through first..last; a line where noise explains its bend."""
    fit = np.zeros((3, 6))
    now = times[last]
    seen = 0
    for i in range(first, last + 1):
        if math.isnan(positions[i, 0]):
            continue
        seen += 1
        t = times[i] - now
        for a in range(3):
            for b in range(a + 1):
                fit[a, b] += t ** (a + b)
            for k in range(3):
                fit[a, 3 + k] += t**a * positions[i, k]
    line_through(times, positions, first, last, now, state)
    state[2] = 0.0
    if seen < 4:
        return
    invert(fit, 3)
    c = np.zeros((3, 3))
    for a in range(3):
        for b in range(3):
            for k in range(3):
                c[a, k] += fit[a, b] * fit[b, 3 + k]
    squares = 0.0
    for i in range(first, last + 1):
        if not math.isnan(positions[i, 0]):
            t = times[i] - now
            for k in range(3):
                squares += (positions[i, k] - c[0, k] - c[1, k] * t - c[2, k] * t * t) ** 2
    variance = max(squares / (3.0 * seen - 9.0), floor * floor)
    speed2 = c[1, 0] ** 2 + c[1, 1] ** 2 + c[1, 2] ** 2
    if speed2 <= 0.0:
        return
    along = (c[2, 0] * c[1, 0] + c[2, 1] * c[1, 1] + c[2, 2] * c[1, 2]) / speed2
    uncertain = 4.0 * variance * fit[2, 2] / (speed2 * speed2)
    keep = curvature_scale**2 / (curvature_scale**2 + uncertain)
    if keep > 0.5:
        state[0], state[1] = c[0], c[1]
        state[2] = 2.0 * keep * (c[2] - along * c[1]) / speed2


@kernel
def spread(t, speed, curvature, inside, across):
    """The place after ``t`` along and towards the centre, and the variance of its error per unit of noise.

    That variance is the mean of the error's mean square length and its variance in the worst direction: twice its root
    holds 95 % of normal errors whether they spread in one, two or three directions.
    """
    angle = curvature * speed * t
    sine, cosine = math.sin(angle), math.cos(angle)
    u, w, a, b, c, d, e = turn(t, speed, curvature, sine, cosine)
    p0, p1, q0, q1 = t * cosine, t * sine, -t * b, t * a
    i = inside
    uu = i[0, 0] + i[2, 2] * p0 * p0 + i[3, 3] * q0 * q0 + i[4, 4] * c * c
    uu += 2.0 * (i[0, 2] * p0 + i[0, 3] * q0 + i[0, 4] * c + i[2, 3] * p0 * q0 + i[2, 4] * p0 * c + i[3, 4] * q0 * c)
    ww = i[1, 1] + i[2, 2] * p1 * p1 + i[3, 3] * q1 * q1 + i[4, 4] * d * d
    ww += 2.0 * (i[1, 2] * p1 + i[1, 3] * q1 + i[1, 4] * d + i[2, 3] * p1 * q1 + i[2, 4] * p1 * d + i[3, 4] * q1 * d)
    uw = i[0, 1] + i[0, 2] * p1 + i[0, 3] * q1 + i[0, 4] * d + i[1, 2] * p0 + i[1, 3] * q0 + i[1, 4] * c
    uw += i[2, 2] * p0 * p1 + i[3, 3] * q0 * q1 + i[4, 4] * c * d
    uw += i[2, 3] * (p0 * q1 + q0 * p1) + i[2, 4] * (p0 * d + c * p1) + i[3, 4] * (q0 * d + c * q1)
    off = across[0, 0] + across[1, 1] * q1 * q1 + across[2, 2] * e * e
    off += 2.0 * (across[0, 1] * q1 + across[0, 2] * e + across[1, 2] * q1 * e)
    worst = max(0.5 * (uu + ww) + math.sqrt(0.25 * (uu - ww) ** 2 + uw * uw), off)
    return u, w, 0.5 * (uu + ww + off + worst)


@kernel
def follow(times, positions, radii, origins, targets, ahead, window, floor, speed_radii, turn_radii):
    """Constant turns fitted to what was seen up to each of ``origins``; the last origin is the present.

    Args:
        times: Observation times, shape (r,), [s].
        positions: Observed centres, shape (r, m, 3), [m]; NaN where lost.
        radii: Shape (m,), [m].
        origins: Ascending indices of observations to forecast from, shape (O,).
        targets: Observations to forecast from each origin but the last, shape (O - 1, H); -1 for none.
        ahead: Times to forecast from the present, shape (T,), [s] after it.
        window: Number of observations used, counted back from an origin.
        floor: Least noise [m].
        speed_radii: Scale of plausible speeds, in the obstacle's radius per second.
        turn_radii: Scale of plausible turns: their radius in the obstacle's.

    Returns:
        Past forecasts (O - 1, H, m, 3) and their variances, forecasts (T, m, 3) and their variances (T, m), and the
        noise's variance at each origin (O, m).
    """
    n_origins, m = origins.shape[0], positions.shape[1]
    past, past_var = np.zeros((*targets.shape, m, 3)), np.zeros((*targets.shape, m))
    centers, var = np.empty((ahead.shape[0], m, 3)), np.empty((ahead.shape[0], m))
    noise = np.empty((n_origins, m))
    state, axes = np.empty((3, 3)), np.empty((3, 3))
    inside, across = np.empty((5, 6)), np.empty((3, 4))
    for j in range(m):
        seen = positions[:, j]
        speed_scale, curvature_scale = speed_radii * radii[j], 1.0 / (turn_radii * radii[j])
        last = min(5, origins[0])
        first = window_start(seen, last, window)
        start_state(times, seen, first, last, floor, curvature_scale, state)
        for o in range(n_origins):
            while True:  # the long fit needs a near start
                target = min(max(2 * last, last + 4), origins[o]) if last < origins[o] else last
                advance(state, times[target] - times[last])
                last = target
                first = window_start(seen, last, window)
                variance, freedom = refine(
                    times, seen, first, last, floor, speed_scale, curvature_scale, state, inside, across
                )
                if last == origins[o]:
                    break
            noise[o, j] = variance
            scale = variance * freedom / (freedom - 2.0) if freedom > 4.0 else 2.0 * variance
            speed, curvature = frame_of(state[1], state[2], axes)
            if o < n_origins - 1:
                for h in range(targets.shape[1]):
                    i = targets[o, h]
                    if i >= 0:
                        u, w, v = spread(times[i] - times[last], speed, curvature, inside, across)
                        past[o, h, j] = state[0] + u * axes[0] + w * axes[1]
                        past_var[o, h, j] = scale * v
            else:
                for h in range(ahead.shape[0]):
                    u, w, v = spread(ahead[h], speed, curvature, inside, across)
                    for k in range(3):
                        centers[h, j, k] = state[0, k] + u * axes[0, k] + w * axes[1, k]
                    var[h, j] = scale * v
    return past, past_var, centers, var, noise
