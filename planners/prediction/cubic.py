"""The paper's predictor: SciPy's cubic interpolation over the last five observations, extrapolated."""

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
        spline = interp1d(times, positions, kind="cubic", axis=0, fill_value="extrapolate", assume_sorted=True)
        return np.asarray(spline(times_s), dtype=np.float64)
