"""What the models of motion share: small linear algebra, and what hindsight says about their errors."""

import math

import numpy as np

from scenarios.kernels.jit import kernel

LEAST_BOUND_M = 1e-9
LEAST_SCORE = 1e-18
"""Bounds [m] and scores [m^2/s^2] below these are as good as none."""
SPURT = 2.0
"""Times the fastest speed seen: what an obstacle may yet reach."""


@kernel
def copy_into(target, source):
    """Write a matrix into another of its shape.

    In loops, here as in all kernels: numba gives every ``target[:] = source`` code that would write out both shapes in
    an error, and it takes longer to compile than most kernels.
    """
    for i in range(source.shape[0]):
        for j in range(source.shape[1]):
            target[i, j] = source[i, j]


@kernel
def invert(a, n):
    """Invert the symmetric positive definite ``a[:n, :n]``, of which the lower half counts, in place (Gauss-Jordan)."""
    for i in range(n):
        for j in range(i):
            a[j, i] = a[i, j]
    for p in range(n):
        pivot = 1.0 / a[p, p] if a[p, p] > 0.0 else 0.0
        a[p, p] = 1.0
        for j in range(n):
            a[p, j] *= pivot
        for i in range(n):
            if i != p:
                factor = a[i, p]
                a[i, p] = 0.0
                for j in range(n):
                    a[i, j] -= factor * a[p, j]


@kernel
def solve(a, n, damping, factor, x):
    """Solve ``a[:n, :n] x = a[:n, n]``, the matrix symmetric by its lower half, its diagonal grown by the damping.

    ``factor`` (n, n) is work space. Returns the product of ``x`` and the right side.
    """
    for i in range(n):
        for j in range(i + 1):
            entry = a[i, j] if i > j else a[i, i] * (1.0 + damping)
            for k in range(j):
                entry -= factor[i, k] * factor[j, k]
            if i > j:
                factor[i, j] = entry * factor[j, j]
            else:  # its reciprocal; nothing where nothing was seen
                factor[i, i] = 1.0 / math.sqrt(entry) if entry > 0.0 else 0.0
    product = 0.0
    for i in range(n):
        x[i] = a[i, n]
        for k in range(i):
            x[i] -= factor[i, k] * x[k]
        x[i] *= factor[i, i]
        product += x[i] * x[i]
    for i in range(n - 1, -1, -1):
        for k in range(i + 1, n):
            x[i] -= factor[k, i] * x[k]
        x[i] *= factor[i, i]
    return product


@kernel
def line_through(times, positions, first, last, now, line):
    """Least-squares line through the observations first..last: place at ``now`` and velocity into ``line`` (2, 3).

    Returns:
        Number of observations not lost, their mean time after ``now``, the sum of squared times about that mean, and
        the sum of squared residuals.
    """
    count, mean = 0, 0.0
    line[0], line[1] = 0.0, 0.0
    for i in range(first, last + 1):
        if not math.isnan(positions[i, 0]):
            count += 1
            mean += times[i] - now
            for k in range(3):
                line[0, k] += positions[i, k]
    if count == 0:
        return 0, 0.0, 0.0, 0.0
    mean /= count
    for k in range(3):
        line[0, k] /= count
    about = 0.0
    for i in range(first, last + 1):
        if not math.isnan(positions[i, 0]):
            t = times[i] - now - mean
            about += t * t
            for k in range(3):
                line[1, k] += t * (positions[i, k] - line[0, k])
    if about > 0.0:
        for k in range(3):
            line[1, k] /= about
    squares = 0.0
    for i in range(first, last + 1):
        if not math.isnan(positions[i, 0]):
            t = times[i] - now - mean
            for k in range(3):
                squares += (positions[i, k] - line[0, k] - t * line[1, k]) ** 2
    for k in range(3):
        line[0, k] -= mean * line[1, k]
    return count, mean, about, squares


@kernel
def window_start(positions, last, window):
    """Index of the first of the last ``window`` observations up to ``last`` that were not lost; 0 if fewer."""
    first, count = last, 0
    while first >= 0:
        if not math.isnan(positions[first, 0]):
            count += 1
            if count == window:
                return first
        first -= 1
    return 0


@kernel
def follow_lines(times, positions, radii, origins, targets, ahead, window, floor, speed_radii):
    """Straight lines through the last ``window`` observations at each of ``origins``.

    The other arguments and the results are those of ``arc._kernels.follow``.
    """
    n_past, m = targets.shape[0], positions.shape[1]
    past, past_var = np.zeros((m, *targets.shape, 3)), np.zeros((m, *targets.shape))
    centers, var, noise = np.empty((m, ahead.shape[0], 3)), np.empty((m, ahead.shape[0])), np.empty(m)
    line = np.empty((2, 3))
    for j in range(m):
        seen = positions[:, j]
        for o in range(n_past + 1):
            now = times[origins[o]]
            first = window_start(seen, origins[o], window)
            count, mean, about, squares = line_through(times, seen, first, origins[o], now, line)
            freedom = 3.0 * count - 6.0
            noise[j] = max(squares / max(freedom, 1.0), floor * floor)
            scale = 2.0 * noise[j] * (freedom / (freedom - 2.0) if freedom > 4.0 else 2.0)
            speed = (speed_radii * radii[j]) ** 2 if about == 0.0 else scale / about
            n_targets = targets.shape[1] if o < n_past else ahead.shape[0]
            for h in range(n_targets):
                if o == n_past:
                    t = ahead[h]
                    for k in range(3):
                        centers[j, h, k] = line[0, k] + t * line[1, k]
                    var[j, h] = scale / count + (t - mean) ** 2 * speed
                elif targets[o, h] >= 0:
                    t = times[targets[o, h]] - now
                    for k in range(3):
                        past[j, o, h, k] = line[0, k] + t * line[1, k]
                    past_var[j, o, h] = scale / count + (t - mean) ** 2 * speed
    return past, past_var, centers, var, noise


@kernel
def weigh(weights, positions, last, j, noise, places, variances):
    """Weighted sums (T, 3) of the observations up to ``last`` by ``weights`` (T, r); variances of their errors (T,)."""
    first = last + 1 - weights.shape[1]
    for h in range(weights.shape[0]):
        gain = 0.0
        for i in range(weights.shape[1]):
            if first + i >= 0:  # an early origin has fewer, the weights of the others are none
                gain += weights[h, i] * weights[h, i]
                for k in range(3):
                    places[h, k] += weights[h, i] * positions[first + i, j, k]
        variances[h] = 2.0 * gain * noise


@kernel
def follow_weights(positions, origins, past_weights, weights, noise):
    """Weighted sums of the last observations at each of ``origins``.

    Args:
        positions: Observed centres, shape (r, m, 3), [m], none lost.
        origins: Ascending indices of observations to forecast from, shape (O,); the last is the present.
        past_weights: Weights of the last observations at each past origin, shape (O - 1, H, s).
        weights: Weights of the last observations now, shape (T, s).
        noise: Variance of the noise, shape (m,), [m^2].

    Returns:
        The results of ``arc._kernels.follow``.
    """
    m, n_times = positions.shape[1], weights.shape[0]
    past, past_var = np.zeros((m, *past_weights.shape[:2], 3)), np.zeros((m, *past_weights.shape[:2]))
    centers, var = np.zeros((m, n_times, 3)), np.zeros((m, n_times))
    for j in range(m):
        for o in range(past_weights.shape[0]):
            weigh(past_weights[o], positions, origins[o], j, noise[j], past[j, o], past_var[j, o])
        weigh(weights, positions, origins[-1], j, noise[j], centers[j], var[j])
    return past, past_var, centers, var, noise


@kernel
def fastest(times, positions, gap):
    """Largest mean speed [m/s] over about ``gap`` observations, of one obstacle's (r, 3)."""
    top = 0.0
    for i in range(positions.shape[0]):
        k = max(0, i - gap)
        while k < i and math.isnan(positions[k, 0]):
            k += 1
        if k < i and not math.isnan(positions[i, 0]):
            square = 0.0
            for c in range(3):
                square += (positions[i, c] - positions[k, c]) ** 2
            top = max(top, math.sqrt(square) / (times[i] - times[k]))
    return top


@kernel
def growth(t, step, order):
    """Error after ``t`` of a polynomial through points ``step`` apart, per unit of the lowest derivative left out."""
    product = 1.0
    for k in range(order):
        product *= t + k * step
    return product / (1.0, 1.0, 2.0, 6.0, 24.0)[order]


@kernel
def judge(
    times, positions, radii, origins, targets, past, past_var, centers, var, noise, ahead, order, turn_radii, gap
):
    """Bounds that hold in hindsight, and how wrong the model has been.

    What a model's own variance does not explain of its past errors is put down to a lag, seen one step ahead, and to a
    derivative of the motion that it leaves out, the ``order``-th. Where noise may hide that derivative from hindsight,
    that of a plausible turn is added, whose radius is ``turn_radii`` obstacle radii (none if infinite). No error can
    outgrow what the obstacle does at the fastest that it was seen to go, and what the prediction does.

    Returns:
        Bounds, shape (m, T), [m], and scores, shape (m,), mean square of the past errors per second ahead.
    """
    m = positions.shape[1]
    bounds, scores = np.empty(var.shape), np.zeros(m)
    step = (times[-1] - times[0]) / (times.shape[0] - 1) if times.shape[0] > 1 else 1.0
    grown = np.empty(ahead.shape[0])
    for h in range(ahead.shape[0]):
        grown[h] = growth(ahead[h], step, order) ** 2
    for j in range(m):
        lag, excess, hidden, weight, pairs, judged = 0.0, 0.0, 0.0, 0.0, 0, 0
        for o in range(targets.shape[0]):
            for h in range(targets.shape[1]):
                i = targets[o, h]
                if i < 0 or math.isnan(positions[i, j, 0]):
                    continue
                square = 0.0
                for k in range(3):
                    square += (positions[i, j, k] - past[j, o, h, k]) ** 2
                t = times[i] - times[origins[o]]
                expected = 1.5 * (past_var[j, o, h] + 2.0 * noise[j])
                pairs += 1
                scores[j] += square / (t * t)
                if h == 0:
                    lag += square - expected
                    judged += 1
                else:
                    excess += (square - expected) / (t * t)
                    hidden += (expected / (t * t)) ** 2
                    weight += (growth(t, step, order) / t) ** 2
        scores[j] /= max(1, pairs)
        speed = fastest(times, positions[:, j], gap)
        few = 1.0 + 2.0 / max(1, judged)
        lag = few * max(0.0, lag / max(1, judged))
        missing = (speed**order * (1.0 / (turn_radii * radii[j])) ** (order - 1)) ** 2
        if weight > 0.0:
            missing = few * max(0.0, excess / weight) + min(missing, math.sqrt(hidden) / weight)
        for h in range(ahead.shape[0]):
            own = var[j, h] + lag + missing * grown[h]
            half = 0.5 * speed * ahead[h]
            if own > var[j, 0] + lag + half * half:
                square = 0.0
                for k in range(3):
                    square += (centers[j, h, k] - centers[j, 0, k]) ** 2
                own = min(own, var[j, 0] + lag + (half + 0.5 * math.sqrt(square)) ** 2)
            bounds[j, h] = math.sqrt(own)
    return bounds, scores


@kernel
def blend(centers, bounds, scores):
    """Forecasts of several models in one, each weighed by 1 / (its bound there * cube of its score).

    Args:
        centers: Per model, shape (m, T, 3), [m].
        bounds: Per model, shape (m, T), [m].
        scores: Per model, shape (m,), [m^2/s^2].

    Returns:
        Centres (m, T, 3) and bounds (m, T) [m]: the mean of the models' variances, and half of that between them.
    """
    out_centers, out_bounds = np.zeros(centers[0].shape), np.zeros(bounds[0].shape)
    m, n_times = bounds[0].shape
    weights = np.empty(len(centers))
    for j in range(m):
        least = math.inf
        for k in range(len(centers)):
            least = min(least, scores[k][j])
        for h in range(n_times):
            total = 0.0
            for k in range(len(centers)):
                share = (least + LEAST_SCORE) / (scores[k][j] + LEAST_SCORE)
                weights[k] = share**3 / (bounds[k][j, h] + LEAST_BOUND_M)
                total += weights[k]
            for k in range(len(centers)):
                weights[k] /= total
                for c in range(3):
                    out_centers[j, h, c] += weights[k] * centers[k][j, h, c]
            for k in range(len(centers)):
                apart = 0.0
                for c in range(3):
                    apart += (centers[k][j, h, c] - out_centers[j, h, c]) ** 2
                out_bounds[j, h] += weights[k] * (bounds[k][j, h] ** 2 + 0.5 * apart)
            out_bounds[j, h] = math.sqrt(out_bounds[j, h])
    return out_centers, out_bounds


@kernel
def keep_within_reach(times, positions, gap, ahead, bounds, centers):
    """Pull forecasts back to where an obstacle can get from where it was last seen.

    Polynomials run away: what accelerates now would be metres off in a minute.

    Args:
        times: Of the observations, shape (N,), [s].
        positions: Observed centres, shape (N, m, 3), [m]; nan where lost.
        gap: Steps over which the fastest speed is looked for.
        ahead: Times after the last observation, shape (T,), [s].
        bounds: On the forecasts' errors, shape (m, T), [m].
        centers: The forecasts, shape (m, T, 3), [m]; changed.
    """
    for j in range(positions.shape[1]):
        last = times.shape[0] - 1
        while last > 0 and math.isnan(positions[last, j, 0]):
            last -= 1
        speed = SPURT * fastest(times, positions[:, j], gap)
        for h in range(ahead.shape[0]):
            reach = bounds[j, 0] + speed * (times[-1] - times[last] + ahead[h])
            away = 0.0
            for c in range(3):
                away += (centers[j, h, c] - positions[last, j, c]) ** 2
            if away > reach * reach:
                share = reach / math.sqrt(away)
                for c in range(3):
                    centers[j, h, c] = positions[last, j, c] + share * (centers[j, h, c] - positions[last, j, c])
