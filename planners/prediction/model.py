"""Predictors that forecast from earlier observations too, so that hindsight can tell how far to trust them."""

import functools
from abc import abstractmethod
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from planners.prediction._kernels import judge
from planners.prediction.observation import Observation
from planners.prediction.predictor import Forecast, Predictor
from scenarios.arm import FloatArray

Indices = npt.NDArray[np.int64]

NOISE_FLOOR_M = 1e-7
"""No sensor is better than this; it keeps weights finite where a model explains what was seen exactly."""
SPEED_RADII = 1.0
"""Plausible speeds, where too little was seen to tell: about one radius of the obstacle per second."""
TURN_RADII = 4.0
"""Plausible turns, where noise hides them: a radius of some four times the obstacle's own."""
HORIZONS = (1, 2, 3, 5, 8, 12, 20)
"""Steps ahead at which past forecasts are compared with what came."""
BACK = (1, 2, 4, 8, 16, 32)
"""Steps back from the present at which past forecasts are made."""
FEWEST = 4
"""Observations that a past forecast is made from at the least."""
GAP = 5
"""Steps over which an obstacle's fastest speed is looked for."""


class Extrapolation(NamedTuple):
    """A model's forecasts, from earlier observations and from the present."""

    past_m: FloatArray
    """Forecast centres from each past origin at each of its targets, shape (m, O - 1, H, 3), [m]."""
    past_variances: FloatArray
    """What the model claims of their errors, shape (m, O - 1, H), [m^2]."""
    centers_m: FloatArray
    """Forecast centres from the present, shape (m, T, 3), [m]."""
    variances: FloatArray
    """What the model claims of their errors, shape (m, T), [m^2]."""
    noise_variances: FloatArray
    """Variance of the noise of each coordinate, shape (m,), [m^2]."""


class Judged(NamedTuple):
    """A model's forecast from the present in the light of its past errors."""

    centers_m: FloatArray
    """Shape (m, T, 3), [m]."""
    bounds_m: FloatArray
    """One standard deviation of the error, shape (m, T), [m]."""
    scores: FloatArray
    """How wrong the model has been about each obstacle, shape (m,): mean square past error per second ahead."""

    def forecast(self) -> Forecast:
        """The same by time first."""
        return Forecast(self.centers_m.transpose(1, 0, 2), self.bounds_m.T)


class Model(Predictor):
    """A law of motion fitted to what was seen up to an origin: the present, or an earlier one for comparison."""

    leaves_out: int
    """Order of the lowest derivative of the motion that the model leaves out."""
    knows_turns: bool = False
    """Whether the model's own variance covers a turn that noise hides."""

    @abstractmethod
    def extrapolate(
        self, observation: Observation, origins: Indices, targets: Indices, ahead_s: FloatArray
    ) -> Extrapolation:
        """Forecast from each origin.

        Args:
            observation: All observations.
            origins: Ascending indices of observations to forecast from, shape (O,); the last is the present.
            targets: Indices of observations to forecast from each past origin, shape (O - 1, H); -1 for none.
            ahead_s: Times after the present to forecast from there, shape (T,), [s].
        """

    def judged(self, observation: Observation, times_s: FloatArray) -> Judged:
        """Forecast, with bounds widened to what hindsight shows."""
        times = observation.times_s
        origins, targets = _comparisons(len(times))
        ahead = times_s - times[-1]
        past, past_var, centers, var, noise = self.extrapolate(observation, origins, targets, ahead)
        bounds, scores = judge(
            *observation,
            origins,
            targets,
            past,
            past_var,
            centers,
            var,
            noise,
            ahead,
            self.leaves_out,
            np.inf if self.knows_turns else TURN_RADII,
            GAP,
        )
        return Judged(centers, bounds, scores)

    def forecast(self, observation: Observation, times_s: FloatArray) -> Forecast:
        """See ``Predictor.forecast``."""
        return self.judged(observation, times_s).forecast()


@functools.lru_cache(maxsize=512)
def _comparisons(count: int) -> tuple[Indices, Indices]:
    """Origins and targets for ``count`` observations; see ``Model.extrapolate``."""
    last = count - 1
    past = np.array([last - back for back in reversed(BACK) if last - back >= FEWEST - 1], dtype=np.int64)
    targets = past[:, None] + np.array(HORIZONS, dtype=np.int64)
    targets[targets > last] = -1
    return np.append(past, last), targets
