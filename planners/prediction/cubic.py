"""The paper's predictor: SciPy's cubic interpolation over the last five observations, extrapolated."""

import functools

import numpy as np
from scipy.interpolate import interp1d

from planners.prediction.observation import Observation
from planners.prediction.predictor import Predictor
from scenarios.arm import FloatArray

HISTORY = 5
"""Observations used (paper, section IV: "the past 5 steps")."""


class CubicPredictor(Predictor):
    """``scipy.interpolate.interp1d(kind="cubic")`` as in the paper, section IV.

    With five points this is a not-a-knot cubic spline, not one cubic. The error on the paper's orbits stays below
    0.5 cm for 5 s and grows with the fourth power, so past ``reach_s`` obstacles are held.
    """

    reach_s = 12.0

    def positions(self, observation: Observation, times_s: FloatArray) -> FloatArray:
        """Predicted centres; see ``Predictor.positions``."""
        times, positions = observation.times_s[-HISTORY:], observation.positions_m[-HISTORY:]
        now = times[-1]
        weights = _weights((times - now).tobytes(), (times_s - now).tobytes())
        return np.asarray(np.tensordot(weights, positions, axes=1))


@functools.lru_cache(maxsize=256)
def _weights(history: bytes, ahead: bytes) -> FloatArray:
    """What each observation contributes to each prediction, (T, r): the spline is linear in the observed values."""
    times = np.frombuffer(history)
    spline = interp1d(times, np.eye(len(times)), kind="cubic", axis=0, fill_value="extrapolate", assume_sorted=True)
    return np.asarray(spline(np.frombuffer(ahead)), dtype=np.float64)
