"""Regression with several Gaussian processes at once, averaged by their evidence.

With observations in order of time, the Cholesky factor of those up to an earlier moment is the leading block of the
whole factor. Sums along whitened observations, the inverse factor times what was seen, give the regression at each.
"""

import math
from typing import NamedTuple

import numpy as np

from scenarios.kernels.jit import kernel

PRIOR_OBSERVATIONS = 2.0
"""What the plausible excursion counts for."""
NEGLIGIBLE = 1e-3
"""Processes that weigh less than this are left out."""


class Basis(NamedTuple):
    """What follows from when obstacles were seen, r times, for F processes of E lengths."""

    whiteners: np.ndarray
    """Inverse Cholesky factors of the covariances, transposed, shape (F, r, r)."""
    ones: np.ndarray
    """The inverse factors times ones, shape (F, r)."""
    logs: np.ndarray
    """Sums of the logarithms of the factors' diagonals up to each observation, shape (F, r)."""
    past: np.ndarray
    """The inverse factors times covariances with the targets of past origins, shape (F, O - 1, H, r)."""
    crosses: np.ndarray
    """Covariances with the times to forecast, shape (E, r, T)."""
    variances: np.ndarray
    """Variance of the forecasts, the motion's being 1, shape (F, T); (0, T) if left to when they are needed."""
    ratios: np.ndarray
    """Variance of the noise, the motion's being 1, shape (F,)."""


@kernel
def whiten(positions, whitener, ones, white, sums):
    """Fill ``white`` (3, r) with whitened coordinates, ``sums`` (r, 5) with running sums over observations.

    The sums are those of the squared ones, of the products of ones and each coordinate, and of squared coordinates.
    """
    r = positions.shape[0]
    white[:] = 0.0
    for i in range(r):
        for k in range(3):
            away = positions[i, k] - positions[r - 1, k]
            for row in range(i, r):
                white[k, row] += whitener[i, row] * away
    for i in range(r):
        for s in range(5):
            sums[i, s] = sums[i - 1, s] if i > 0 else 0.0
        sums[i, 0] += ones[i] * ones[i]
        for k in range(3):
            sums[i, 1 + k] += ones[i] * white[k, i]
            sums[i, 4] += white[k, i] * white[k, i]


@kernel
def weigh(count, logs, sums, scale, weights, variances):
    """Weights (F,) of the processes after ``count`` observations, and variances (F,) of the motion in each."""
    freedom = 3.0 * (count - 1.0 + PRIOR_OBSERVATIONS)
    for f in range(weights.shape[0]):
        s = sums[f, count - 1]
        squares = max(0.0, s[4] - (s[1] * s[1] + s[2] * s[2] + s[3] * s[3]) / s[0])
        variances[f] = (squares + 3.0 * PRIOR_OBSERVATIONS * scale * scale) / freedom
        weights[f] = -0.5 * freedom * math.log(variances[f]) - 3.0 * logs[f, count - 1] - 1.5 * math.log(s[0])
    largest = weights.max()
    for f in range(weights.shape[0]):
        weights[f] = math.exp(weights[f] - largest)
    weights /= weights.sum()
    weights[weights < NEGLIGIBLE] = 0.0
    weights /= weights.sum()


@kernel
def include(weight, total, place, variance, mean, spread):
    """Add a forecast to the weighted ``mean`` (3,) of forecasts, of weight ``total`` with it.

    Returns:
        The sum of weighted variances, ``spread``, with its own and what it differs by.
    """
    apart = 0.0
    for k in range(3):
        away = place[k] - mean[k]
        mean[k] += away * weight / total
        apart += away * (place[k] - mean[k])
    return spread + weight * (variance + apart / 3.0)


@kernel
def look_back(weight, total, variance, reaches, ones, white, s, place, past, past_var):
    """Add one process's forecasts from a past origin, whose sums are ``s`` (5,), at its targets (H, 3)."""
    for h in range(past.shape[0]):
        explained = known = 0.0
        for k in range(3):
            place[k] = s[1 + k] / s[0]
        for i in range(ones.shape[0]):
            reach = reaches[h, i]
            explained += reach * reach
            known += reach * ones[i]
            for k in range(3):
                place[k] += reach * (white[k, i] - s[1 + k] / s[0] * ones[i])
        unit = max(0.0, 1.0 - explained) + (1.0 - known) ** 2 / s[0]
        past_var[h] = include(weight, total, place, variance * unit, past[h], past_var[h])


@kernel
def left_open(whitener, crosses, ones, precision):
    """Variances (T,) of one process's forecasts, the motion's being 1; ``precision`` is the sum of its squared ones."""
    explained, known = np.zeros(crosses.shape[1]), np.zeros(crosses.shape[1])
    reach, units = np.empty(crosses.shape[1]), np.empty(crosses.shape[1])
    for row in range(ones.shape[0]):
        reach[:] = 0.0
        for i in range(row + 1):
            for h in range(reach.shape[0]):
                reach[h] += whitener[i, row] * crosses[i, h]
        for h in range(reach.shape[0]):
            explained[h] += reach[h] * reach[h]
            known[h] += reach[h] * ones[row]
    for h in range(reach.shape[0]):
        units[h] = max(0.0, 1.0 - explained[h]) + (1.0 - known[h]) ** 2 / precision
    return units


@kernel
def look_ahead(weight, total, variance, whitener, crosses, units, ones, white, s, place, ahead, centers, var):
    """Add one process's forecasts from the present (T, 3); ``ahead`` (3, T) is work space."""
    r = ones.shape[0]
    for k in range(3):
        mean = s[1 + k] / s[0]
        ahead[k] = mean
        for i in range(r):
            slope = 0.0
            for row in range(i, r):
                slope += whitener[i, row] * (white[k, row] - mean * ones[row])
            for h in range(units.shape[0]):
                ahead[k, h] += slope * crosses[i, h]
    for h in range(units.shape[0]):
        for k in range(3):
            place[k] = ahead[k, h]
        var[h] = include(weight, total, place, variance * units[h], centers[h], var[h])


@kernel
def follow(positions, scales, counts, basis, floor):
    """Processes through what was seen up to each of several origins; the last is the present.

    Args:
        positions: Observed centres, shape (r, m, 3), [m], none lost.
        scales: Plausible excursion of each obstacle, shape (m,), [m].
        counts: Number of observations at each origin, ascending, shape (O,).
        basis: What follows from when they were made.
        floor: Least noise [m].

    Returns:
        The results of ``arc._kernels.follow``.
    """
    (n_processes, r), m, present = basis.logs.shape, positions.shape[1], counts.shape[0] - 1
    per_length, remembered = n_processes // basis.crosses.shape[0], basis.variances.shape[0] > 0
    past, past_var = np.zeros((m, *basis.past.shape[1:3], 3)), np.zeros((m, *basis.past.shape[1:3]))
    centers, var = np.zeros((m, basis.crosses.shape[2], 3)), np.zeros((m, basis.crosses.shape[2]))
    noise = np.empty(m)
    white, sums = np.empty((n_processes, 3, r)), np.empty((n_processes, r, 5))
    weights, variances = np.empty(n_processes), np.empty(n_processes)
    place, ahead = np.empty(3), np.empty((3, basis.crosses.shape[2]))
    for j in range(m):
        for f in range(n_processes):
            whiten(positions[:, j], basis.whiteners[f], basis.ones[f], white[f], sums[f])
        for o in range(present + 1):
            count, total = counts[o], 0.0
            weigh(count, basis.logs, sums, scales[j], weights, variances)
            for f in range(n_processes):
                if weights[f] == 0.0:
                    continue
                total += weights[f]
                known, seen, s = basis.ones[f, :count], white[f, :, :count], sums[f, count - 1]
                shares = (weights[f], total, variances[f])
                if o < present:
                    look_back(*shares, basis.past[f, o], known, seen, s, place, past[j, o], past_var[j, o])
                else:
                    crosses = basis.crosses[f // per_length]
                    whitener = basis.whiteners[f]
                    units = basis.variances[f] if remembered else left_open(whitener, crosses, known, s[0])
                    look_ahead(*shares, whitener, crosses, units, known, seen, s, place, ahead, centers[j], var[j])
        noise[j] = max((weights * variances * basis.ratios).sum(), floor * floor)
        for k in range(3):
            for o in range(past.shape[1]):
                for h in range(past.shape[2]):
                    past[j, o, h, k] += positions[r - 1, j, k]
            for h in range(centers.shape[1]):
                centers[j, h, k] += positions[r - 1, j, k]
    return past, 2.0 * past_var, centers, 2.0 * var, noise
