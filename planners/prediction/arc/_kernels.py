"""Maximum a posteriori fit of a constant turn, grown from short histories to long ones.

State of the motion: position ``p``, velocity ``v`` and curvature vector ``c`` (towards the turn's centre, one over its
radius long, at right angles to ``v``). In the frame of ``v`` and ``c`` the errors in the turn's plane (5 unknowns) and
across it (3) decouple, so a Gauss-Newton step solves a 5 x 5 and a 3 x 3 system.
"""

import math

import numpy as np

from planners.prediction._kernels import invert, line_through, window_start
from scenarios.kernels.jit import kernel

STEPS = 12
"""Gauss-Newton steps on one history at the most; a start from a shorter history takes two or three."""
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
def turn(t, speed, curvature, rows):
    """Place along (u) and towards the centre (w) after ``t``, and its derivatives into ``rows`` (3, 5).

    Rows 0 and 1: of u and w by the two in-plane position components, the two of velocity, and curvature. Row 2: of the
    place across the plane by position, velocity and curvature across it, in the first three entries.
    """
    x = curvature * speed * t
    if abs(x) < SMALL_RAD:
        sine, cosine = math.sin(x), math.cos(x)
        x2 = x * x
        a, b = 1.0 - x2 / 6.0 + x2 * x2 / 120.0, x * (0.5 - x2 / 24.0)
        du, dw, e = -x / 3.0 + x * x2 / 30.0, 0.5 - x2 / 8.0 + x2 * x2 / 144.0, 0.5 - x2 / 24.0 + x2 * x2 / 720.0
    else:
        sine, cosine = math.sin(x), math.cos(x)
        a, b = sine / x, (1.0 - cosine) / x
        du, dw, e = (cosine - a) / x, (sine - b) / x, b / x
    square = (speed * t) ** 2
    rows[0, 0], rows[0, 1], rows[0, 2], rows[0, 3], rows[0, 4] = 1.0, 0.0, t * cosine, -t * b, square * du
    rows[1, 0], rows[1, 1], rows[1, 2], rows[1, 3], rows[1, 4] = 0.0, 1.0, t * sine, t * a, square * dw
    rows[2, 0], rows[2, 1], rows[2, 2] = 1.0, t * a, square * e
    return speed * t * a, speed * t * b


@kernel
def normal_equations(times, positions, first, last, now, state, axes, inside, across, rows):
    """Sum ``inside`` (5, 6) and ``across`` (3, 4), matrix and right side, over the observations first..last.

    Returns the sum of squared residuals and the number of observations that were not lost.
    """
    speed, curvature = frame_of(state[1], state[2], axes)
    inside[:], across[:] = 0.0, 0.0
    squares, seen = 0.0, 0
    for i in range(first, last + 1):
        if math.isnan(positions[i, 0]):
            continue
        seen += 1
        u, w = turn(times[i] - now, speed, curvature, rows)
        dx, dy, dz = positions[i, 0] - state[0, 0], positions[i, 1] - state[0, 1], positions[i, 2] - state[0, 2]
        along = dx * axes[0, 0] + dy * axes[0, 1] + dz * axes[0, 2] - u
        inward = dx * axes[1, 0] + dy * axes[1, 1] + dz * axes[1, 2] - w
        off = dx * axes[2, 0] + dy * axes[2, 1] + dz * axes[2, 2]
        squares += along * along + inward * inward + off * off
        for a in range(5):
            for b in range(a + 1):
                inside[a, b] += rows[0, a] * rows[0, b] + rows[1, a] * rows[1, b]
            inside[a, 5] += rows[0, a] * along + rows[1, a] * inward
        for a in range(3):
            for b in range(a + 1):
                across[a, b] += rows[2, a] * rows[2, b]
            across[a, 3] += rows[2, a] * off
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
    axes, rows = np.empty((3, 3)), np.empty((3, 5))
    speed, curvature = frame_of(state[1], state[2], axes)
    u, w = turn(t, speed, curvature, rows)
    angle = curvature * speed * t
    sine, cosine = math.sin(angle), math.cos(angle)
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
    now = times[last]
    axes, rows, trial = np.empty((3, 3)), np.empty((3, 5)), state.copy()
    best_inside, best_across = np.empty((5, 6)), np.empty((3, 4))
    d, e = np.zeros(5), np.zeros(3)
    variance, freedom, damping = 0.0, 1.0, 0.0
    best_squares, best_prior, gain = math.inf, 0.0, math.inf
    for step in range(STEPS):
        squares, seen = normal_equations(times, positions, first, last, now, trial, axes, inside, across, rows)
        speed, curvature = frame_of(trial[1], trial[2], axes)
        prior = (speed / speed_scale) ** 2 + (curvature / curvature_scale) ** 2
        better = step == 0 or squares + variance * prior <= best_squares + variance * best_prior
        if better:
            state[:] = trial
            best_inside[:], best_across[:] = inside, across
            best_squares, best_prior = squares, prior
            freedom = max(1.0, 3.0 * seen - 8.0)
            variance = max(squares / freedom, floor * floor)
            damping *= 0.1
            if gain < 1e-3 * variance:
                break
        else:
            damping = max(10.0 * damping, 1e-3)
        inside[:], across[:] = best_inside, best_across
        speed, curvature = frame_of(state[1], state[2], axes)
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
        moved(state, axes, speed, curvature, d, e, trial)
    inside[:], across[:] = best_inside, best_across
    speed, curvature = frame_of(state[1], state[2], axes)
    weigh_prior(variance, speed, curvature, speed_scale, curvature_scale, inside, across)
    invert(inside, 5)
    invert(across, 3)
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
def spread(t, speed, curvature, inside, across, rows):
    """Variance of the place after ``t`` per unit of noise, as ``circular`` counts it; and the place."""
    u, w = turn(t, speed, curvature, rows)
    uu, uw, ww, off = 0.0, 0.0, 0.0, 0.0
    for a in range(5):
        left, right = 0.0, 0.0
        for b in range(5):
            left += inside[a, b] * rows[0, b]
            right += inside[a, b] * rows[1, b]
        uu += left * rows[0, a]
        uw += left * rows[1, a]
        ww += right * rows[1, a]
    for a in range(3):
        for b in range(3):
            off += across[a, b] * rows[2, a] * rows[2, b]
    largest = max(0.5 * (uu + ww) + math.sqrt(0.25 * (uu - ww) ** 2 + uw * uw), off)
    return u, w, 0.5 * (uu + ww + off + largest)


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
    state, axes, rows = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 5))
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
                        u, w, v = spread(times[i] - times[last], speed, curvature, inside, across, rows)
                        past[o, h, j] = state[0] + u * axes[0] + w * axes[1]
                        past_var[o, h, j] = scale * v
            else:
                for h in range(ahead.shape[0]):
                    u, w, v = spread(ahead[h], speed, curvature, inside, across, rows)
                    for k in range(3):
                        centers[h, j, k] = state[0, k] + u * axes[0, k] + w * axes[1, k]
                    var[h, j] = scale * v
    return past, past_var, centers, var, noise
