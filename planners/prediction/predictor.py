"""The contract of a predictor."""

from abc import ABC, abstractmethod
from typing import NamedTuple

import numpy as np

from planners.prediction.observation import Observation
from scenarios.arm import FloatArray
from scenarios.world import SampledWorld, make_world


class Prediction(NamedTuple):
    """Where obstacles are expected, and how far off that may be."""

    start_s: float
    """The last observation [s]."""
    step_s: float
    centers_m: FloatArray
    """Centres every ``step_s`` from ``start_s`` on, shape (T, m, 3), [m]; at rest after the last."""
    radii_m: FloatArray
    """Radii, shape (m,), [m]."""
    bounds_m: FloatArray
    """Bound on the error of each centre, one standard deviation of it, shape (T, m), [m]."""

    @property
    def ahead_s(self) -> FloatArray:
        """Times of ``centers_m`` after the last observation, shape (T,), [s]."""
        return self.step_s * np.arange(len(self.centers_m), dtype=np.float64)

    def world(self, margin: float | FloatArray, largest_bound_m: float = float("inf")) -> SampledWorld:
        """The obstacles for collision checks, each grown by ``margin`` times its error bound, cut at the largest.

        The margin may be one for all times or one for each, shape (T,). A negative one makes obstacles smaller, points
        at the least.
        """
        margins = np.reshape(margin, (-1, 1))
        grown = np.maximum(0.0, self.radii_m + margins * np.minimum(self.bounds_m, largest_bound_m))
        return make_world(self.start_s, self.step_s, self.centers_m, grown)


class Forecast(NamedTuple):
    """Centres at given times, with bounds on their errors."""

    centers_m: FloatArray
    """Shape (T, m, 3), [m]."""
    bounds_m: FloatArray
    """One standard deviation of the error, shape (T, m), [m]: 95 % of errors should be within twice that."""


class Predictor(ABC):
    """Extrapolates observed centres; what it says depends on the observation alone."""

    reach_s: float = float("inf")
    """How far ahead [s] the extrapolation is used; beyond it obstacles are taken to rest where they then are."""

    @abstractmethod
    def forecast(self, observation: Observation, times_s: FloatArray) -> Forecast:
        """Forecast for absolute times (T,) [s], ascending, all at or after the last observation."""

    def positions(self, observation: Observation, times_s: FloatArray) -> FloatArray:
        """Predicted centres (T, m, 3) [m]; see ``forecast``."""
        return self.forecast(observation, times_s).centers_m

    def bounds(self, observation: Observation, times_s: FloatArray) -> FloatArray:
        """Standard deviation (T, m) [m] of the predicted centres' error; see ``forecast``."""
        return self.forecast(observation, times_s).bounds_m

    def predict(self, observation: Observation, horizon_s: float, step_s: float) -> Prediction:
        """Predict from the last observation to ``horizon_s`` later, every ``step_s`` [s]; at rest past ``reach_s``."""
        count = max(2, int(np.ceil(min(horizon_s, self.reach_s) / step_s - 1e-9)) + 1)
        now = float(observation.times_s[-1])
        centers, bounds = self.forecast(observation, now + step_s * np.arange(count, dtype=np.float64))
        # By time in memory too: every world that is made of them would copy them again.
        return Prediction(now, step_s, np.ascontiguousarray(centers), observation.radii_m, np.ascontiguousarray(bounds))
