"""Several models at once; hindsight says how much each counts for each obstacle."""

from collections.abc import Sequence

from planners.prediction._kernels import blend, keep_within_reach
from planners.prediction.model import GAP, Model
from planners.prediction.observation import Observation
from planners.prediction.predictor import Forecast, Predictor
from scenarios.arm import FloatArray


class PortfolioPredictor(Predictor):
    """Leaves each obstacle to the models that would have predicted it best so far.

    Every model predicts past observations from still earlier ones. Its weight falls with the sixth power of the error
    that it made there, which comes close to a choice of the best, and with its error bound: a model that is sharp for
    some seconds gives way to a calmer one further ahead. Where models of similar merit differ, the bound grows.
    """

    def __init__(self, models: Sequence[Model]) -> None:
        """Weigh ``models``."""
        self._models = models

    def forecast(self, observation: Observation, times_s: FloatArray) -> Forecast:
        """See ``Predictor.forecast``."""
        centers, bounds, scores = zip(*(model.judged(observation, times_s) for model in self._models), strict=True)
        mean, spread = blend(centers, bounds, scores)
        seen = observation.times_s
        keep_within_reach(seen, observation.positions_m, GAP, times_s - seen[-1], spread, mean)
        return Forecast(mean.transpose(1, 0, 2), spread.T)
