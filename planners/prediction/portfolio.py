"""Several models; each obstacle is predicted by the one that would have been best for it so far."""

from collections.abc import Sequence

import numpy as np

from planners.prediction.model import Model
from planners.prediction.observation import Observation
from planners.prediction.predictor import Forecast, Predictor
from scenarios.arm import FloatArray


class PortfolioPredictor(Predictor):
    """Picks a model per obstacle by its error in hindsight: past observations predicted from still earlier ones."""

    def __init__(self, models: Sequence[Model]) -> None:
        """Choose among ``models``; on a tie the earlier one is taken."""
        self._models = models

    def forecast(self, observation: Observation, times_s: FloatArray) -> Forecast:
        """See ``Predictor.forecast``."""
        judged = [model.judged(observation, times_s) for model in self._models]
        best = np.argmin([one.scores for one in judged], axis=0)
        centers, bounds = judged[0].forecast
        for j in np.flatnonzero(best):
            centers[:, j] = judged[best[j]].forecast.centers_m[:, j]
            bounds[:, j] = judged[best[j]].forecast.bounds_m[:, j]
        return Forecast(centers, bounds)
