"""The paper's predictor: SciPy's cubic interpolation over the last five observations, extrapolated."""

import functools

import numpy as np
from scipy.interpolate import interp1d

from planners.prediction._kernels import weigh
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
    leaves_out = 4

    def extrapolate(
        self, observation: Observation, origins: Indices, targets: Indices, ahead_s: FloatArray
    ) -> Extrapolation:
        """See ``Model.extrapolate``."""
        times, positions, _ = without_gaps(observation)
        noise = _noise_variances(positions)
        m = positions.shape[1]
        past, past_variances = np.zeros((m, *targets.shape, 3)), np.zeros((m, *targets.shape))
        for o, origin in enumerate(origins[:-1]):
            reached = int(np.count_nonzero(targets[o] >= 0))  # targets ascend, those past the present come last
            history = slice(max(0, origin + 1 - HISTORY), origin + 1)
            weights = _weights(
                (times[history] - times[origin]).tobytes(), (times[targets[o, :reached]] - times[origin]).tobytes()
            )
            weigh(weights, positions[history], noise, past[:, o], past_variances[:, o])
        centers, variances = np.empty((m, len(ahead_s), 3)), np.empty((m, len(ahead_s)))
        weights = _weights((times[-HISTORY:] - times[-1]).tobytes(), ahead_s.tobytes())
        weigh(weights, positions[-HISTORY:], noise, centers, variances)
        return Extrapolation(past, past_variances, centers, variances, noise)


def _noise_variances(positions: FloatArray) -> FloatArray:
    """Variance of the noise (m,) [m^2] by differences of the highest order up to 4 that the observations allow."""
    order = min(4, len(positions) - 1)
    gain = (1.0, 2.0, 6.0, 20.0, 70.0)[order]
    return np.asarray(np.square(np.diff(positions, n=order, axis=0)).mean(axis=(0, 2)) / gain)


@functools.lru_cache(maxsize=1024)
def _weights(history: bytes, ahead: bytes) -> FloatArray:
    """What each observation contributes to each prediction, (T, r): the spline is linear in the observed values."""
    times, wanted = np.frombuffer(history), np.frombuffer(ahead)
    if len(times) == 1:
        return np.ones((len(wanted), 1))
    order = min(3, len(times) - 1)  # 3 is "cubic"; too few observations bear less
    spline = interp1d(times, np.eye(len(times)), kind=order, axis=0, fill_value="extrapolate", assume_sorted=True)
    return np.asarray(spline(wanted), dtype=np.float64)
