"""What the models of motion share: small linear algebra, and what hindsight says about their errors."""

import math

import numpy as np

from scenarios.kernels.jit import kernel


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
            line[0] += positions[i]
    if count == 0:
        return 0, 0.0, 0.0, 0.0
    mean /= count
    line[0] /= count
    about = 0.0
    for i in range(first, last + 1):
        if not math.isnan(positions[i, 0]):
            t = times[i] - now - mean
            about += t * t
            for k in range(3):
                line[1, k] += t * (positions[i, k] - line[0, k])
    if about > 0.0:
        line[1] /= about
    squares = 0.0
    for i in range(first, last + 1):
        if not math.isnan(positions[i, 0]):
            t = times[i] - now - mean
            for k in range(3):
                squares += (positions[i, k] - line[0, k] - t * line[1, k]) ** 2
    line[0] -= mean * line[1]
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

    Arguments and results are those of ``arc._kernels.follow``.
    """
    n_origins, m = origins.shape[0], positions.shape[1]
    past, past_var = np.zeros((*targets.shape, m, 3)), np.zeros((*targets.shape, m))
    centers, var = np.empty((ahead.shape[0], m, 3)), np.empty((ahead.shape[0], m))
    noise = np.empty((n_origins, m))
    line = np.empty((2, 3))
    for j in range(m):
        seen = positions[:, j]
        for o in range(n_origins):
            now = times[origins[o]]
            first = window_start(seen, origins[o], window)
            count, mean, about, squares = line_through(times, seen, first, origins[o], now, line)
            freedom = 3.0 * count - 6.0
            variance = max(squares / max(freedom, 1.0), floor * floor)
            noise[o, j] = variance
            scale = 2.0 * variance * (freedom / (freedom - 2.0) if freedom > 4.0 else 2.0)
            unknown = (speed_radii * radii[j]) ** 2 if about == 0.0 else 0.0
            spread = 1.0 / about if about > 0.0 else 0.0
            if o < n_origins - 1:
                for h in range(targets.shape[1]):
                    i = targets[o, h]
                    if i >= 0:
                        t = times[i] - now
                        past[o, h, j] = line[0] + t * line[1]
                        past_var[o, h, j] = scale * (1.0 / count + (t - mean) ** 2 * spread) + unknown * t * t
            else:
                for h in range(ahead.shape[0]):
                    t = ahead[h]
                    for k in range(3):
                        centers[h, j, k] = line[0, k] + t * line[1, k]
                    var[h, j] = scale * (1.0 / count + (t - mean) ** 2 * spread) + unknown * t * t
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
            dx, dy, dz = positions[i] - positions[k]
            top = max(top, math.sqrt(dx * dx + dy * dy + dz * dz) / (times[i] - times[k]))
    return top


@kernel
def judge(times, positions, origins, targets, past, past_var, noise, ahead, var, gap):
    """Bounds that hold in hindsight, and how wrong the model has been.

    What a model's own variance does not explain of its past errors is put down to an acceleration that it does not
    know; the error cannot outgrow the fastest that the obstacle was seen to go, though.

    Returns:
        Bounds, shape (T, m), [m], and scores, shape (m,), mean square of the past errors per second ahead.
    """
    m = positions.shape[1]
    bounds, scores = np.empty(var.shape), np.zeros(m)
    for j in range(m):
        excess, weight, pairs = 0.0, 0.0, 0
        for o in range(targets.shape[0]):
            for h in range(targets.shape[1]):
                i = targets[o, h]
                if i < 0 or math.isnan(positions[i, j, 0]):
                    continue
                dx, dy, dz = positions[i, j] - past[o, h, j]
                square = dx * dx + dy * dy + dz * dz
                t2 = (times[i] - times[origins[o]]) ** 2
                pairs += 1
                scores[j] += square / t2
                excess += (square - 1.5 * (past_var[o, h, j] + 2.0 * noise[-1, j])) / t2
                weight += 0.25 * t2
        acceleration2 = max(0.0, excess / weight) if weight > 0.0 else 0.0
        scores[j] /= max(1, pairs)
        speed2 = fastest(times, positions[:, j], gap) ** 2
        for h in range(ahead.shape[0]):
            t2 = ahead[h] * ahead[h]
            own = var[h, j] + 0.25 * acceleration2 * t2 * t2
            bounds[h, j] = math.sqrt(min(own, var[0, j] + speed2 * t2))
    return bounds, scores
