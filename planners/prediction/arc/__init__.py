"""Circular arc: a constant turn at constant speed, fitted to everything seen."""

from planners.prediction.arc._kernels import follow
from planners.prediction.model import NOISE_FLOOR_M, SPEED_RADII, TURN_RADII, Extrapolation, Indices, Model
from planners.prediction.observation import Observation
from scenarios.arm import FloatArray


class ArcPredictor(Model):
    """The most probable constant turn, given what was seen and what is plausible.

    Exact on circles and lines without noise. Where noise hides the turn, the plausible scales of speed and curvature
    (normal, zero in the mean, in units of the obstacle's size) draw it to a straight line. The noise is estimated from
    the residuals. The error bound is the posterior's standard deviation, widened by hindsight.
    """

    leaves_out = 2
    knows_turns = True

    def extrapolate(
        self, observation: Observation, origins: Indices, targets: Indices, ahead_s: FloatArray
    ) -> Extrapolation:
        """See ``Model.extrapolate``."""
        scales = (NOISE_FLOOR_M, SPEED_RADII, TURN_RADII)
        return Extrapolation(*follow(*observation, origins, targets, ahead_s, *scales))
