"""Slow twins of the models of motion: SciPy and plain matrices."""

import numpy as np
from scipy.optimize import least_squares


def turned(theta: np.ndarray, times: np.ndarray) -> np.ndarray:
    """Constant turn from position, velocity and curvature vector, by rotating about the turn's axis: (T, 3)."""
    place, velocity, curvature = theta[:3], theta[3:6], theta[6:9]
    speed = np.linalg.norm(velocity)
    curvature = curvature - velocity * (curvature @ velocity) / speed**2
    bend = np.linalg.norm(curvature)
    along, inwards = velocity / speed, curvature / bend
    angle = (bend * speed * times)[:, None]
    return place + (np.sin(angle) * along + (1.0 - np.cos(angle)) * inwards) / bend


def constant_turn(
    times: np.ndarray,
    positions: np.ndarray,
    noise: float,
    speed_scale: float,
    curvature_scale: float,
    start: np.ndarray,
) -> np.ndarray:
    """Most probable place, velocity and curvature at time 0 for a known noise, by SciPy from a start nearby."""

    def residuals(theta: np.ndarray) -> np.ndarray:
        velocity, curvature = theta[3:6], theta[6:9]
        curvature = curvature - velocity * (curvature @ velocity) / (velocity @ velocity)
        fit = (turned(theta, times) - positions).ravel() / noise
        return np.concatenate(
            [fit, velocity / speed_scale, curvature / curvature_scale, [1e-3 * theta[6:9] @ velocity]]
        )

    return least_squares(residuals, start, x_scale=np.repeat([1e-2, 1e-2, 10.0], 3), xtol=1e-14, ftol=1e-14).x


def kalman(
    times: np.ndarray, positions: np.ndarray, order: int, ratio: float, unknown: float, skipped: int
) -> tuple[np.ndarray, np.ndarray, float, float]:
    """One filter in matrices: state (order, 3), covariance (order, order) per noise, log evidence, noise variance."""
    state = np.zeros((order, 3))
    state[0] = positions[0]
    cov = np.diag([1.0] + [unknown] * (order - 1))
    squares, logs = 0.0, 0.0
    for i in range(1, len(times)):
        t = times[i] - times[i - 1]
        if order == 2:
            move = np.array([[1, t], [0, 1]])
            disturbed = ratio * np.array([[t**3 / 3, t**2 / 2], [t**2 / 2, t]])
        else:
            move = np.array([[1, t, t**2 / 2], [0, 1, t], [0, 0, 1]])
            disturbed = ratio * np.array(
                [[t**5 / 20, t**4 / 8, t**3 / 6], [t**4 / 8, t**3 / 3, t**2 / 2], [t**3 / 6, t**2 / 2, t]]
            )
        state, cov = move @ state, move @ cov @ move.T + disturbed
        surprise, scale = positions[i] - state[0], cov[0, 0] + 1.0
        gain = cov[:, :1] / scale
        state, cov = state + gain * surprise, cov - gain * gain.T * scale
        if i >= skipped:
            squares += surprise @ surprise / scale
            logs += np.log(scale)
    count = len(times) - skipped
    noise = squares / (3 * count)
    return state, cov, -1.5 * (logs + count * np.log(noise)), noise


def gaussian_process(
    times: np.ndarray,
    positions: np.ndarray,
    wanted: np.ndarray,
    lengths: tuple[float, ...],
    ratios: tuple[float, ...],
    prior: tuple[float, float],
    negligible: float,
) -> tuple[np.ndarray, np.ndarray, float]:
    """Regression about an unknown mean (Rasmussen and Williams, equation 2.41 f.), averaged by evidence, in matrices.

    Lost observations (nan) have no rows in them. The prior is a plausible excursion and the number of observations it
    counts for. Returns forecasts (T, 3), the variances of their coordinates (T,), and the noise's variance.
    """
    seen = ~np.isnan(positions[:, 0])
    times, positions = times[seen], positions[seen]
    n, ones = len(times), np.ones(len(times))
    scale, worth = prior
    evidence, places, spreads, noises = [], [], [], []
    for length in lengths:
        for ratio in ratios:
            within = np.exp(-0.5 * ((times[:, None] - times) / length) ** 2) + ratio * np.eye(n)
            across = np.exp(-0.5 * ((wanted[:, None] - times) / length) ** 2)
            precision = ones @ np.linalg.solve(within, ones)
            mean = ones @ np.linalg.solve(within, positions) / precision
            solved = np.linalg.solve(within, positions - mean)
            freedom = 3 * (n - 1 + worth)
            variance = (((positions - mean) * solved).sum() + 3 * worth * scale**2) / freedom
            left = 1.0 - (across * np.linalg.solve(within, across.T).T).sum(axis=1)
            left += (1.0 - across @ np.linalg.solve(within, ones)) ** 2 / precision
            places.append(mean + across @ solved)
            spreads.append(variance * left)
            noises.append(variance * ratio)
            log_det = np.linalg.slogdet(within)[1]
            evidence.append(-0.5 * freedom * np.log(variance) - 1.5 * log_det - 1.5 * np.log(precision))
    weights = np.exp(np.array(evidence) - max(evidence))
    weights /= weights.sum()
    weights[weights < negligible] = 0.0
    weights /= weights.sum()
    mixed = np.tensordot(weights, places, axes=1)
    apart = np.square(np.array(places) - mixed).mean(axis=2)
    return mixed, weights @ (np.array(spreads) + apart), float(weights @ noises)
