"""The paper's predictor: SciPy's cubic interpolation over the last five observations, extrapolated."""

import functools

import numpy as np

from planners.prediction._kernels import follow_weights
from planners.prediction.model import Extrapolation, Indices, Model
from planners.prediction.observation import Observation, without_gaps
from scenarios.arm import FloatArray

HISTORY = 5
"""Observations used (paper, section IV: "the past 5 steps")."""


class CubicPredictor(Model):
    """``scipy.interpolate.interp1d(kind="cubic")`` as in the paper, section IV; lost observations are filled in.

    With five points this is a not-a-knot cubic spline, not one cubic. The error on the paper's orbits stays below
    0.3 cm for 3 s, for 5 s below 0.5 cm on 19 of 20, and grows with the fourth power, so past ``reach_s`` obstacles are
    held. The spline goes through all observations and leaves no residual to know the noise by: differences of the
    fourth order stand in, which are the noise (its variance 70-fold) where the motion is close to a cubic.
    """

    reach_s = 12.0
    leaves_out = 4

    def extrapolate(
        self, observation: Observation, origins: Indices, targets: Indices, ahead_s: FloatArray
    ) -> Extrapolation:
        """See ``Model.extrapolate``."""
        times, positions, _ = without_gaps(observation)
        now = times[-1]
        past, present = _all_weights((times - now).tobytes(), origins.tobytes(), targets.tobytes(), ahead_s.tobytes())
        return Extrapolation(*follow_weights(positions, origins, past, present, _noise_variances(positions)))


def _noise_variances(positions: FloatArray) -> FloatArray:
    """Variance of the noise (m,) [m^2] by differences of the highest order up to 4 that the observations allow."""
    order = min(4, len(positions) - 1)
    gain = (1.0, 2.0, 6.0, 20.0, 70.0)[order]
    return np.asarray(np.square(np.diff(positions, n=order, axis=0)).mean(axis=(0, 2)) / gain)


@functools.lru_cache(maxsize=256)
def _all_weights(times: bytes, origins: bytes, targets: bytes, ahead: bytes) -> tuple[FloatArray, FloatArray]:
    """Weights of the last observations at each past origin for its targets, (O - 1, H, r), and now, (T, r)."""
    seen, starts = np.frombuffer(times), np.frombuffer(origins, dtype=np.int64)[:-1]
    wanted = np.frombuffer(targets, dtype=np.int64).reshape(len(starts), -1 if len(starts) else 0)
    past = np.zeros((*wanted.shape, min(HISTORY, len(seen))))
    for o, start in enumerate(starts):
        history = seen[max(0, start + 1 - HISTORY) : start + 1] - seen[start]
        there = wanted[o] >= 0
        past[o, there, -len(history) :] = _weights(history.tobytes(), (seen[wanted[o, there]] - seen[start]).tobytes())
    return past, _weights(seen[-HISTORY:].tobytes(), ahead)


@functools.lru_cache(maxsize=1024)
def _weights(history: bytes, ahead: bytes) -> FloatArray:
    """What each observation contributes to each prediction, (T, r): the spline is linear in the observed values."""
    from scipy.interpolate import interp1d  # a tenth of a second, only where it is used

    times, wanted = np.frombuffer(history), np.frombuffer(ahead)
    if len(times) == 1:
        return np.ones((len(wanted), 1))
    order = min(3, len(times) - 1)  # 3 is "cubic"; too few observations bear less
    spline = interp1d(times, np.eye(len(times)), kind=order, axis=0, fill_value="extrapolate", assume_sorted=True)
    return np.asarray(spline(wanted), dtype=np.float64)
