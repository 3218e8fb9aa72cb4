"""Kalman filters of constant velocity and constant acceleration."""

import numpy as np

from planners.prediction.kalman._kernels import follow
from planners.prediction.model import NOISE_FLOOR_M, SPEED_RADII, Extrapolation, Indices, Model
from planners.prediction.observation import Observation
from scenarios.arm import FloatArray

HISTORY = 64
"""Observations used; filters that matter have forgotten what lies further back."""
ORDERS = np.repeat([2, 3], 5)
"""Number of states of each filter: 2 is constant velocity, 3 constant acceleration."""
RATIOS = np.array([1e-8, 1e-4, 1e-2, 1e0, 1e3, 1e-8, 1e-5, 1e-3, 1e0, 1e3])
"""How restless each takes the obstacle to be: density of its process noise over the variance of the measurements."""


class KalmanPredictor(Model):
    """Filters from calm to restless, each weighted by the probability it gave to what then was observed.

    The weighted mean of their states is extrapolated; where they differ, the error bound grows.
    """

    leaves_out = 3

    def extrapolate(
        self, observation: Observation, origins: Indices, targets: Indices, ahead_s: FloatArray
    ) -> Extrapolation:
        """See ``Model.extrapolate``."""
        filters = (ORDERS, RATIOS, HISTORY, NOISE_FLOOR_M, SPEED_RADII)
        return Extrapolation(*follow(*observation, origins, targets, ahead_s, *filters))
