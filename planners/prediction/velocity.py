"""Constant velocity."""

from planners.prediction._kernels import follow_lines
from planners.prediction.model import NOISE_FLOOR_M, SPEED_RADII, Extrapolation, Indices, Model
from planners.prediction.observation import Observation
from scenarios.arm import FloatArray

WINDOW = 5
"""Observations used: the paper's history."""


class VelocityPredictor(Model):
    """The least-squares line through the last five observations that were not lost."""

    leaves_out = 2

    def extrapolate(
        self, observation: Observation, origins: Indices, targets: Indices, ahead_s: FloatArray
    ) -> Extrapolation:
        """See ``Model.extrapolate``."""
        return Extrapolation(*follow_lines(*observation, origins, targets, ahead_s, WINDOW, NOISE_FLOOR_M, SPEED_RADII))
