"""Maximum a posteriori fit of a constant turn, grown from short histories to long ones.

State of the motion: position ``p``, velocity ``v`` and curvature vector ``c`` (towards the turn's centre, one over its
radius long, at right angles to ``v``). In the frame of ``v`` and ``c`` the errors in the turn's plane (5 unknowns) and
across it (3) decouple, so a Gauss-Newton step solves a 5 x 5 and a 3 x 3 system.
"""

import math

import numpy as np

from planners.prediction._kernels import copy_into, invert, line_through, solve
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
    for k in range(3):
        axes[0, k] = v[k] / speed if speed > 0.0 else (1.0 if k == 0 else 0.0)
    along = c[0] * axes[0, 0] + c[1] * axes[0, 1] + c[2] * axes[0, 2]
    curvature = 0.0
    for k in range(3):
        axes[1, k] = c[k] - along * axes[0, k]
        curvature += axes[1, k] * axes[1, k]
    curvature = math.sqrt(curvature)
    length = curvature
    if curvature < 1e-9:  # straight: any direction across will do, best from the axis that ``v`` is least along
        curvature, least = 0.0, 0
        for k in range(1, 3):
            if abs(axes[0, k]) < abs(axes[0, least]):
                least = k
        for k in range(3):
            axes[1, k] = (1.0 if k == least else 0.0) - axes[0, least] * axes[0, k]
        length = math.sqrt(1.0 - axes[0, least] ** 2)
    for k in range(3):
        axes[1, k] /= length
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
        over = 1.0 / x
        a, b = sine * over, (1.0 - cosine) * over
        c, d, e = (cosine - a) * over, (sine - b) * over, b * over
    way = speed * t
    return way * a, way * b, a, b, way * way * c, way * way * d, way * way * e


@kernel
def add_observations(times, positions, first, last, now, state, axes, speed, curvature, inside, across):
    """Add first..last to the normal equations, matrix (lower half) and right side, of a step from ``state`` at ``now``.

    The unknowns of ``inside`` (5, 6) are, in the turn's plane, two components of position, two of velocity, and
    curvature; those of ``across`` (3, 4) are position, velocity and curvature across it.

    Returns:
        The sum of squared residuals and the number of observations that were not lost.
    """
    rate = speed * curvature
    squares, seen = 0.0, 0
    count = inside[0, 0]
    h20, h21, h22 = inside[2, 0], inside[2, 1], inside[2, 2]
    h30, h31, h32, h33 = inside[3, 0], inside[3, 1], inside[3, 2], inside[3, 3]
    h40, h41, h42, h43, h44 = inside[4, 0], inside[4, 1], inside[4, 2], inside[4, 3], inside[4, 4]
    r0, r1, r2, r3, r4 = inside[0, 5], inside[1, 5], inside[2, 5], inside[3, 5], inside[4, 5]
    g10, g11, g20, g21, g22 = across[1, 0], across[1, 1], across[2, 0], across[2, 1], across[2, 2]
    s0, s1, s2 = across[0, 3], across[1, 3], across[2, 3]
    t, step, step_sine, step_cosine = times[first] - now, 0.0, 0.0, 1.0
    sine, cosine = math.sin(rate * t), math.cos(rate * t)
    for i in range(first, last + 1):
        if i > first:  # the angle's sine and cosine from those before it; times are mostly one step apart
            if times[i] - times[i - 1] != step:
                step = times[i] - times[i - 1]
                step_sine, step_cosine = math.sin(rate * step), math.cos(rate * step)
            sine, cosine = sine * step_cosine + cosine * step_sine, cosine * step_cosine - sine * step_sine
            t = times[i] - now
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
    inside[0, 0], inside[1, 0], inside[1, 1] = count + seen, 0.0, count + seen
    inside[2, 0], inside[2, 1], inside[2, 2] = h20, h21, h22
    inside[3, 0], inside[3, 1], inside[3, 2], inside[3, 3] = h30, h31, h32, h33
    inside[4, 0], inside[4, 1], inside[4, 2], inside[4, 3], inside[4, 4] = h40, h41, h42, h43, h44
    inside[0, 5], inside[1, 5], inside[2, 5], inside[3, 5], inside[4, 5] = r0, r1, r2, r3, r4
    across[0, 0], across[1, 0], across[1, 1] = count + seen, g10, g11
    across[2, 0], across[2, 1], across[2, 2] = g20, g21, g22
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
def refine(times, positions, last, epoch, floor, speed_scale, curvature_scale, state):
    """Fit ``state`` (3, 3) at ``epoch`` to the observations up to ``last`` by damped Gauss-Newton steps.

    The noise is estimated from the residuals as the fit goes on, never below ``floor`` [m].

    Returns:
        The noise's variance per coordinate and the degrees of freedom it was estimated from.
    """
    axes, before = np.empty((3, 3)), state.copy()
    inside, across, kept_inside, kept_across = np.empty((5, 6)), np.empty((3, 4)), np.empty((5, 6)), np.empty((3, 4))
    factor, d, e = np.empty((5, 5)), np.empty(5), np.empty(3)
    variance, freedom, damping, kept_squares, kept_prior = 0.0, 1.0, 0.0, math.inf, 0.0
    for step in range(STEPS):
        speed, curvature = frame_of(state[1], state[2], axes)
        inside[:], across[:] = 0.0, 0.0
        squares, seen = add_observations(
            times, positions, 0, last, epoch, state, axes, speed, curvature, inside, across
        )
        prior = (speed / speed_scale) ** 2 + (curvature / curvature_scale) ** 2
        if step == 0 or squares + variance * prior <= kept_squares + variance * kept_prior:
            copy_into(before, state)
            copy_into(kept_inside, inside)
            copy_into(kept_across, across)
            kept_squares, kept_prior = squares, prior
            freedom = max(1.0, 3.0 * seen - 8.0)
            variance = max(squares / freedom, floor * floor)
            damping = 0.1 * damping if damping > 1e-3 else 0.0
        else:  # a step too far
            copy_into(state, before)
            copy_into(inside, kept_inside)
            copy_into(across, kept_across)
            speed, curvature = frame_of(state[1], state[2], axes)
            damping = max(10.0 * damping, 0.1)
        weigh_prior(variance, speed, curvature, speed_scale, curvature_scale, inside, across)
        gain = solve(inside, 5, damping, factor, d) + solve(across, 3, damping, factor, e)
        moved(before, axes, speed, curvature, d, e, state)
        if gain < ENOUGH * variance:  # a step this small needs no second look
            break
    return variance, freedom


@kernel
def start_state(times, positions, last, epoch, floor, curvature_scale, state):
    """A first guess at ``epoch``: a parabola through what was seen up to ``last``; a line where noise explains it."""
    fit = np.zeros((3, 6))
    seen = 0
    for i in range(last + 1):
        if math.isnan(positions[i, 0]):
            continue
        seen += 1
        t = times[i] - epoch
        for a in range(3):
            for b in range(a + 1):
                fit[a, b] += t ** (a + b)
            for k in range(3):
                fit[a, 3 + k] += t**a * positions[i, k]
    line_through(times, positions, 0, last, epoch, state)
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
    for i in range(last + 1):
        if not math.isnan(positions[i, 0]):
            t = times[i] - epoch
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
        for k in range(3):
            state[0, k], state[1, k] = c[0, k], c[1, k]
            state[2, k] = 2.0 * keep * (c[2, k] - along * c[1, k]) / speed2


@kernel
def spread(t, sine, cosine, speed, curvature, inside, across):
    """The place after ``t`` along and towards the centre, and the variance of its error per unit of noise.

    That variance is the mean of the error's mean square length and its variance in the worst direction: twice its root
    holds 95 % of normal errors whether they spread in one, two or three directions.
    """
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
def fit(times, positions, floor, speed_scale, curvature_scale, state):
    """Fit ``state`` (3, 3) to all observations, to the first six first: a long fit needs a near start.

    Returns:
        The noise's variance per coordinate, its degrees of freedom, and the state's epoch: the middle of what is
        fitted, where the unknowns are least entangled.
    """
    last = min(5, times.shape[0] - 1)
    epoch = 0.5 * (times[0] + times[last])
    start_state(times, positions, last, epoch, floor, curvature_scale, state)
    while True:
        variance, freedom = refine(times, positions, last, epoch, floor, speed_scale, curvature_scale, state)
        if last == times.shape[0] - 1:
            return variance, freedom, epoch
        last = min(2 * last, times.shape[0] - 1)
        middle = 0.5 * (times[0] + times[last])
        advance(state, middle - epoch)
        epoch = middle


@kernel
def look_back(times, targets, epoch, state, inside, across, places, variances):
    """Where ``state`` (3, 3) was at ``targets``, observations (H,) or -1 for none, into (H, 3); variances into (H,)."""
    axes = np.empty((3, 3))
    speed, curvature = frame_of(state[1], state[2], axes)
    for h in range(targets.shape[0]):
        if targets[h] >= 0:
            t = times[targets[h]] - epoch
            angle = curvature * speed * t
            u, w, variances[h] = spread(t, math.sin(angle), math.cos(angle), speed, curvature, inside, across)
            for k in range(3):
                places[h, k] = state[0, k] + u * axes[0, k] + w * axes[1, k]


@kernel
def look_ahead(start, ahead, state, inside, across, places, variances):
    """Where ``state`` (3, 3) will be at ``start`` after its epoch and ``ahead`` (T,) later: (T, 3); variances (T,)."""
    axes = np.empty((3, 3))
    speed, curvature = frame_of(state[1], state[2], axes)
    sine, cosine, step, step_sine, step_cosine = 0.0, 1.0, 0.0, 0.0, 1.0
    for h in range(ahead.shape[0]):
        change = ahead[h] - ahead[h - 1] if h > 0 else start + ahead[0]
        if change != step:
            step = change
            step_sine, step_cosine = math.sin(curvature * speed * step), math.cos(curvature * speed * step)
        sine, cosine = sine * step_cosine + cosine * step_sine, cosine * step_cosine - sine * step_sine
        u, w, variances[h] = spread(start + ahead[h], sine, cosine, speed, curvature, inside, across)
        for k in range(3):
            places[h, k] = state[0, k] + u * axes[0, k] + w * axes[1, k]


@kernel
def follow(times, positions, radii, origins, targets, ahead, floor, speed_radii, turn_radii):
    """Constant turns fitted to what was seen up to each of ``origins``; the last origin is the present.

    The fit to everything is a Gauss-Newton step away from the fits to less, whose normal equations are partial sums.

    Args:
        times: Observation times, shape (r,), [s].
        positions: Observed centres, shape (r, m, 3), [m]; NaN where lost.
        radii: Shape (m,), [m].
        origins: Ascending indices of observations to forecast from, shape (O,).
        targets: Observations to forecast from each origin but the last, shape (O - 1, H); -1 for none.
        ahead: Times to forecast from the present, shape (T,), [s] after it.
        floor: Least noise [m].
        speed_radii: Scale of plausible speeds, in the obstacle's radius per second.
        turn_radii: Scale of plausible turns: their radius in the obstacle's.

    Returns:
        Past forecasts (m, O - 1, H, 3) and their variances, forecasts (m, T, 3) and their variances (m, T), and the
        noise's variance (m,).
    """
    n_past, m = targets.shape[0], positions.shape[1]
    past, past_var = np.zeros((m, *targets.shape, 3)), np.zeros((m, *targets.shape))
    centers, var, noise = np.empty((m, ahead.shape[0], 3)), np.empty((m, ahead.shape[0])), np.empty(m)
    state, then, axes = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    inside, across, sum_inside, sum_across = np.empty((5, 6)), np.empty((3, 4)), np.empty((5, 6)), np.empty((3, 4))
    factor, d, e = np.empty((5, 5)), np.empty(5), np.empty(3)
    for j in range(m):
        seen = positions[:, j]
        scales = (speed_radii * radii[j], 1.0 / (turn_radii * radii[j]))
        noise[j], freedom, epoch = fit(times, seen, floor, *scales, state)
        speed, curvature = frame_of(state[1], state[2], axes)
        sum_inside[:], sum_across[:] = 0.0, 0.0
        for o in range(n_past + 1):
            first = origins[o - 1] + 1 if o > 0 else 0
            add_observations(
                times, seen, first, origins[o], epoch, state, axes, speed, curvature, sum_inside, sum_across
            )
            copy_into(inside, sum_inside)
            copy_into(across, sum_across)
            weigh_prior(noise[j], speed, curvature, *scales, inside, across)
            solve(inside, 5, 0.0, factor, d)
            solve(across, 3, 0.0, factor, e)
            invert(inside, 5)
            invert(across, 3)
            if o < n_past:
                moved(state, axes, speed, curvature, d, e, then)
                look_back(times, targets[o], epoch, then, inside, across, past[j, o], past_var[j, o])
            else:
                look_ahead(times[-1] - epoch, ahead, state, inside, across, centers[j], var[j])
        scale = noise[j] * (freedom / (freedom - 2.0) if freedom > 4.0 else 2.0)  # noise known from few residuals
        for o in range(n_past):
            for h in range(targets.shape[1]):
                past_var[j, o, h] *= scale
        for h in range(ahead.shape[0]):
            var[j, h] *= scale
    return past, past_var, centers, var, noise
