"""The future itself: a bound on what any predictor can give, not a method."""

from collections.abc import Sequence

import numpy as np

from planners.prediction.observation import Observation
from planners.prediction.predictor import Forecast, Predictor
from scenarios.arm import FloatArray
from scenarios.obstacle import Obstacle


class TruthPredictor(Predictor):
    """Returns the obstacles' true motion."""

    def __init__(self, obstacles: Sequence[Obstacle]) -> None:
        """Take the true obstacles of the scenario."""
        self._obstacles = obstacles

    def forecast(self, observation: Observation, times_s: FloatArray) -> Forecast:
        """True centres, no error; see ``Predictor.forecast``."""
        del observation  # the truth needs none
        centers = np.empty((len(times_s), len(self._obstacles), 3))
        for j, obstacle in enumerate(self._obstacles):
            centers[:, j] = obstacle.position(times_s)
        return Forecast(centers, np.zeros(centers.shape[:2]))
