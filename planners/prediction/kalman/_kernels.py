"""Kalman filters of constant velocity and of constant acceleration, averaged by how well they foretold what came.

All coordinates share one covariance, written in units of the noise's variance: the gains then depend on the ratio of
process to measurement noise alone, and the noise's variance follows from the innovations.
"""

import math

import numpy as np

from planners.prediction._kernels import copy_into, window_start
from scenarios.kernels.jit import kernel

UNKNOWN = 1e8
"""Variance of velocity and acceleration before anything was seen, in units of the noise's: as good as infinite."""
SKIPPED = 3
"""Observations that a filter of three states needs to begin with; they do not count for or against any."""


@kernel
def weigh(times, seen, first, origins, order, ratio, gains, covariances, logs):
    """The gains of one filter for the observations first.., which depend on when something was ``seen`` (r,) alone.

    Args:
        times: Observation times, shape (r,), [s].
        seen: Whether each was not lost, shape (r,).
        first: The first observation used.
        origins: Ascending indices of observations, shape (O,).
        order: 2 for constant velocity, 3 for constant acceleration.
        ratio: Density of the white noise that disturbs it over the variance of the measurements.
        gains: Filled with three gains and the variance of the innovation for each observation, (r, 4).
        covariances: Filled with the upper half of the covariance at each origin, (O, 6).
        logs: Filled with the sum of the logarithms of innovation variances up to each origin, (O,).
    """
    p00, p01, p02, p11, p12, p22 = 1.0, 0.0, 0.0, UNKNOWN, 0.0, UNKNOWN if order == 3 else 0.0
    q2, q3 = (ratio, 0.0) if order == 2 else (0.0, ratio)
    count, total, o = 0, 0.0, 0
    for i in range(first, origins[-1] + 1):
        if count > 0:
            t = times[i] - times[i - 1]
            half = 0.5 * t * t
            b0, b1, b2 = p00 + t * p01 + half * p02, p01 + t * p11 + half * p12, p02 + t * p12 + half * p22
            c1, c2 = p11 + t * p12, p12 + t * p22
            p00 = b0 + t * b1 + half * b2 + q2 * t**3 / 3.0 + q3 * t**5 / 20.0
            p01 = b1 + t * b2 + q2 * half + q3 * t**4 / 8.0
            p02 = b2 + q3 * t**3 / 6.0
            p11 = c1 + t * c2 + q2 * t + q3 * t**3 / 3.0
            p12, p22 = c2 + q3 * half, p22 + q3 * t
        if seen[i]:
            count += 1
            if count > 1:
                s = p00 + 1.0
                g0, g1, g2 = p00 / s, p01 / s, p02 / s
                gains[i, 0], gains[i, 1], gains[i, 2], gains[i, 3] = g0, g1, g2, s
                p11, p12, p22 = p11 - g1 * p01, p12 - g1 * p02, p22 - g2 * p02
                p00, p01, p02 = g0, g1, g2
                if count > SKIPPED:
                    total += math.log(s)
        if i == origins[o]:
            covariances[o, 0], covariances[o, 1], covariances[o, 2] = p00, p01, p02
            covariances[o, 3], covariances[o, 4], covariances[o, 5] = p11, p12, p22
            logs[o] = total
            o += 1


@kernel
def run(times, positions, seen, first, origins, gains, logs, floor, speed, states, evidence, variances):
    """One filter, given its gains, over the observations first.. of one obstacle; the rest is as for ``weigh``.

    ``speed`` [m/s] is the scale of plausible ones, for an obstacle that was seen once. Fills, for each origin, states
    (O, 3, 3), logarithms of the evidence (O,) and the noise's variance (O,).
    """
    x = np.zeros((3, 3))
    count, squares, o = 0, 0.0, 0
    for i in range(first, origins[-1] + 1):
        if count > 0:
            t = times[i] - times[i - 1]
            for k in range(3):
                x[0, k] += t * x[1, k] + 0.5 * t * t * x[2, k]
                x[1, k] += t * x[2, k]
        if seen[i]:
            count += 1
            square = 0.0
            for k in range(3):
                surprise = positions[i, k] - x[0, k]
                if count == 1:
                    x[0, k] = positions[i, k]
                else:
                    square += surprise * surprise
                    x[0, k] += gains[i, 0] * surprise
                    x[1, k] += gains[i, 1] * surprise
                    x[2, k] += gains[i, 2] * surprise
            if count > SKIPPED:
                squares += square / gains[i, 3]
        if i == origins[o]:
            counted = max(1, count - SKIPPED)
            variances[o] = max(squares / (3.0 * counted), floor * floor)
            evidence[o] = -1.5 * (logs[o] + counted * math.log(variances[o]))
            if count == 1:
                variances[o] = speed * speed / UNKNOWN
            copy_into(states[o], x)
            o += 1


@kernel
def average(orders, ratios, states, covariances, evidence, variances, weights, state, covariance):
    """Mean ``state`` (3, 3) and ``covariance`` (6,) of filters by their evidence; ``weights`` (F,) is work space.

    Returns:
        The mean variance of the noise, and the mean densities that disturb velocity and acceleration.
    """
    state[:], covariance[:] = 0.0, 0.0
    noise, q2, q3, total, best = 0.0, 0.0, 0.0, 0.0, evidence.max()
    for f in range(evidence.shape[0]):
        weights[f] = math.exp(evidence[f] - best)
        total += weights[f]
    for f in range(evidence.shape[0]):
        weights[f] /= total
        scaled = weights[f] * variances[f]
        for a in range(3):
            for k in range(3):
                state[a, k] += weights[f] * states[f, a, k]
        for a in range(6):
            covariance[a] += scaled * covariances[f, a]
        noise += scaled
        if orders[f] == 2:
            q2 += scaled * ratios[f]
        else:
            q3 += scaled * ratios[f]
    for f in range(evidence.shape[0]):  # where they differ, none of them knows
        weight = weights[f] / 3.0
        for k in range(3):
            dp, dv, da = states[f, 0, k] - state[0, k], states[f, 1, k] - state[1, k], states[f, 2, k] - state[2, k]
            covariance[0] += weight * dp * dp
            covariance[1] += weight * dp * dv
            covariance[2] += weight * dp * da
            covariance[3] += weight * dv * dv
            covariance[4] += weight * dv * da
            covariance[5] += weight * da * da
    return noise, q2, q3


@kernel
def extrapolated(t, state, covariance, q2, q3, place):
    """The place (3,) after ``t``; returns its variance, that of an error which is alike in all directions."""
    half = 0.5 * t * t
    for k in range(3):
        place[k] = state[0, k] + t * state[1, k] + half * state[2, k]
    c = covariance
    spread = c[0] + 2.0 * t * c[1] + 2.0 * half * c[2] + t * t * c[3] + 2.0 * t * half * c[4] + half * half * c[5]
    return 2.0 * (spread + q2 * t**3 / 3.0 + q3 * t**5 / 20.0)


@kernel
def follow(times, positions, radii, origins, targets, ahead, orders, ratios, history, floor, speed_radii):
    """Filters with the given ``orders`` and ``ratios`` (F,) over the last ``history`` observations, averaged.

    The other arguments and the results are those of ``arc._kernels.follow``.
    """
    n_origins, (n_seen, m), n_filters = origins.shape[0], positions.shape[:2], orders.shape[0]
    past, past_var = np.zeros((m, *targets.shape, 3)), np.zeros((m, *targets.shape))
    centers, var, noise = np.empty((m, ahead.shape[0], 3)), np.empty((m, ahead.shape[0])), np.empty(m)
    gains, covariances = np.empty((n_filters, n_seen, 4)), np.empty((n_filters, n_origins, 6))
    states, logs = np.empty((n_filters, n_origins, 3, 3)), np.empty((n_filters, n_origins))
    evidence, variances = np.empty((n_filters, n_origins)), np.empty((n_filters, n_origins))
    weights, state, covariance = np.empty(n_filters), np.empty((3, 3)), np.empty(6)
    seen = ~np.isnan(positions[:, :, 0]).T
    for j in range(m):
        first = window_start(positions[:, j], n_seen - 1, history)
        speed = speed_radii * radii[j]
        alike = j > 0 and (seen[j] == seen[j - 1]).all()
        for f in range(n_filters):
            if not alike:
                weigh(times, seen[j], first, origins, orders[f], ratios[f], gains[f], covariances[f], logs[f])
            run(
                times,
                positions[:, j],
                seen[j],
                first,
                origins,
                gains[f],
                logs[f],
                floor,
                speed,
                states[f],
                evidence[f],
                variances[f],
            )
        for o in range(n_origins):
            noise[j], q2, q3 = average(
                orders,
                ratios,
                states[:, o],
                covariances[:, o],
                evidence[:, o],
                variances[:, o],
                weights,
                state,
                covariance,
            )
            if o < n_origins - 1:
                for h in range(targets.shape[1]):
                    if targets[o, h] >= 0:
                        t = times[targets[o, h]] - times[origins[o]]
                        past_var[j, o, h] = extrapolated(t, state, covariance, q2, q3, past[j, o, h])
            else:
                for h in range(ahead.shape[0]):
                    var[j, h] = extrapolated(ahead[h], state, covariance, q2, q3, centers[j, h])
    return past, past_var, centers, var, noise
