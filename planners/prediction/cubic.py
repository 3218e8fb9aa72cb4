"""The paper's predictor: SciPy's cubic interpolation over the last five observations, extrapolated."""

import functools

import numpy as np
from scipy.interpolate import interp1d

from planners.prediction.model import Extrapolation, Indices, Model
from planners.prediction.observation import Observation, without_gaps
from scenarios.arm import FloatArray

HISTORY = 5
"""Observations used (paper, section IV: "the past 5 steps")."""


class CubicPredictor(Model):
    """``scipy.interpolate.interp1d(kind="cubic")`` as in the paper, section IV; lost observations are filled in.

    With five points this is a not-a-knot cubic spline, not one cubic. The error on the paper's orbits stays below
    0.5 cm for 5 s and grows with the fourth power, so past ``reach_s`` obstacles are held. The spline goes through all
    observations and leaves no residual to know the noise by: differences of the fourth order stand in, which are the
    noise (its variance 70-fold) where the motion is close to a cubic.
    """

    reach_s = 12.0

    def extrapolate(
        self, observation: Observation, origins: Indices, targets: Indices, ahead_s: FloatArray
    ) -> Extrapolation:
        """See ``Model.extrapolate``."""
        times, positions, _ = without_gaps(observation)
        m = positions.shape[1]
        past, past_variances = np.zeros((*targets.shape, m, 3)), np.zeros((*targets.shape, m))
        noise = np.empty((len(origins), m))
        for o, last in enumerate(origins):
            used = slice(max(0, last + 1 - HISTORY), last + 1)
            now, history = times[last], positions[used]
            noise[o] = _noise_variance(positions[: last + 1])
            if o < len(targets):
                there = targets[o] >= 0
                weights = _weights((times[used] - now).tobytes(), (times[targets[o][there]] - now).tobytes())
                past[o, there] = np.tensordot(weights, history, axes=1)
                past_variances[o, there] = 2.0 * np.square(weights).sum(axis=1)[:, None] * noise[o]
        weights = _weights((times[used] - now).tobytes(), ahead_s.tobytes())
        variances = 2.0 * np.square(weights).sum(axis=1)[:, None] * noise[-1]
        return Extrapolation(past, past_variances, np.tensordot(weights, history, axes=1), variances, noise)


def _noise_variance(positions: FloatArray) -> FloatArray:
    """Variance of the noise (m,) [m^2] by differences of the highest order up to 4 that the observations allow."""
    order = min(4, len(positions) - 1)
    gain = (1.0, 2.0, 6.0, 20.0, 70.0)[order]
    return np.asarray(np.square(np.diff(positions, n=order, axis=0)).mean(axis=(0, 2)) / gain)


@functools.lru_cache(maxsize=1024)
def _weights(history: bytes, ahead: bytes) -> FloatArray:
    """What each observation contributes to each prediction, (T, r): the spline is linear in the observed values."""
    times = np.frombuffer(history)
    spline = interp1d(times, np.eye(len(times)), kind="cubic", axis=0, fill_value="extrapolate", assume_sorted=True)
    return np.asarray(spline(np.frombuffer(ahead)), dtype=np.float64)
