"""The contract of a predictor."""

from abc import ABC, abstractmethod

import numpy as np

from planners.prediction.observation import Observation, without_gaps
from scenarios.arm import FloatArray
from scenarios.world import SampledWorld, make_world


class Predictor(ABC):
    """Extrapolates observed centres; stateless between calls."""

    reach_s: float
    """How far ahead [s] the extrapolation is used; beyond it obstacles are taken to rest where they then are."""

    @abstractmethod
    def positions(self, observation: Observation, times_s: FloatArray) -> FloatArray:
        """Predicted centres (T, m, 3) [m] at absolute times (T,) [s], all at or after the last observation."""

    def predict(self, observation: Observation, horizon_s: float, step_s: float) -> SampledWorld:
        """World from the last observation to ``horizon_s`` later, every ``step_s`` [s]; at rest past ``reach_s``."""
        observation = without_gaps(observation)
        count = max(2, int(np.ceil(min(horizon_s, self.reach_s) / step_s - 1e-9)) + 1)
        now = float(observation.times_s[-1])
        times = now + step_s * np.arange(count, dtype=np.float64)
        return make_world(now, step_s, self.positions(observation, times), observation.radii_m)
