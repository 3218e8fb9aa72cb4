"""The contract of a predictor."""

from abc import ABC, abstractmethod
from typing import NamedTuple

import numpy as np

from planners.prediction.observation import Observation, without_gaps
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

    def world(self, margin: float) -> SampledWorld:
        """The obstacles for collision checks, each grown by ``margin`` times its error bound."""
        return make_world(self.start_s, self.step_s, self.centers_m, self.radii_m + margin * self.bounds_m)


class Predictor(ABC):
    """Extrapolates observed centres; stateless between calls."""

    reach_s: float
    """How far ahead [s] the extrapolation is used; beyond it obstacles are taken to rest where they then are."""

    @abstractmethod
    def positions(self, observation: Observation, times_s: FloatArray) -> FloatArray:
        """Predicted centres (T, m, 3) [m] at absolute times (T,) [s], all at or after the last observation."""

    def bounds(self, observation: Observation, times_s: FloatArray) -> FloatArray:
        """Standard deviation (T, m) [m] of the predicted centres' error; 0 where a predictor claims to be exact."""
        return np.zeros((len(times_s), len(observation.radii_m)))

    def predict(self, observation: Observation, horizon_s: float, step_s: float) -> Prediction:
        """Predict from the last observation to ``horizon_s`` later, every ``step_s`` [s]; at rest past ``reach_s``."""
        observation = without_gaps(observation)
        count = max(2, int(np.ceil(min(horizon_s, self.reach_s) / step_s - 1e-9)) + 1)
        now = float(observation.times_s[-1])
        times = now + step_s * np.arange(count, dtype=np.float64)
        centers, bounds = self.positions(observation, times), self.bounds(observation, times)
        return Prediction(now, step_s, centers, observation.radii_m, bounds)
