"""Prediction of obstacle motion from observations."""

from collections.abc import Callable
from typing import NamedTuple

from planners.prediction.arc import ArcPredictor
from planners.prediction.cubic import CubicPredictor
from planners.prediction.gaussian import GaussianProcessPredictor
from planners.prediction.kalman import KalmanPredictor
from planners.prediction.observation import Observation
from planners.prediction.portfolio import PortfolioPredictor
from planners.prediction.predictor import Forecast, Prediction, Predictor
from planners.prediction.truth import TruthPredictor
from planners.prediction.velocity import VelocityPredictor
from scenarios.scenario import Scenario
from scenarios.spec import known_name


class PredictorEntry(NamedTuple):
    """One line of the registry."""

    summary: str
    build: Callable[[Scenario], Predictor]
    is_oracle: bool = False
    """Sees the true future: a bound, never a method to be ranked."""


PORTFOLIO = ("arc", "kalman", "gp")
"""The models in the portfolio."""

PREDICTORS: dict[str, PredictorEntry] = {
    "velocity": PredictorEntry("constant velocity over the last 5 observations", lambda _: VelocityPredictor()),
    "cubic": PredictorEntry("cubic spline over the last 5 observations (the paper's)", lambda _: CubicPredictor()),
    "arc": PredictorEntry("circular arc through everything seen", lambda _: ArcPredictor()),
    "kalman": PredictorEntry("Kalman filters of constant velocity and acceleration", lambda _: KalmanPredictor()),
    "gp": PredictorEntry("Gaussian processes, averaged by their evidence", lambda _: GaussianProcessPredictor()),
    "portfolio": PredictorEntry(
        "arc, kalman and gp, each obstacle by what hindsight favours",
        lambda _: PortfolioPredictor([ArcPredictor(), KalmanPredictor(), GaussianProcessPredictor()]),
    ),
    "truth": PredictorEntry(
        "the true motion: a bound", lambda scenario: TruthPredictor(scenario.obstacles), is_oracle=True
    ),
}


def build_predictor(name: str, scenario: Scenario) -> Predictor:
    """Build the predictor called ``name``; only an oracle reads the scenario's obstacles.

    Raises:
        SpecError: The name is unknown; the message lists the known ones.
    """
    return PREDICTORS[known_name("predictor", name, PREDICTORS)].build(scenario)


__all__ = [
    "PORTFOLIO",
    "PREDICTORS",
    "Forecast",
    "Observation",
    "Prediction",
    "Predictor",
    "PredictorEntry",
    "build_predictor",
]
