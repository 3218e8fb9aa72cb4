"""Gaussian processes: motion that is smooth, and of which nothing else is known (Rasmussen and Williams 2006)."""

import functools

import numpy as np
from scipy.linalg import cholesky, solve_triangular

from planners.prediction.gaussian._kernels import Basis, follow
from planners.prediction.model import NOISE_FLOOR_M, TURN_RADII, Extrapolation, Indices, Model
from planners.prediction.observation import Observation, without_gaps
from scenarios.arm import FloatArray

HISTORY = 48
"""Observations used; what lies further back says little about the seconds to come."""
LENGTHS_S = (15.0, 30.0, 60.0)
"""Over how long positions have much to do with one another: from restless to calm."""
RATIOS = (1e-12, 1e-9, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2)
"""Variance of the noise over that of the motion."""
EXCURSION_RADII = TURN_RADII
"""Plausible excursions, where too little was seen to tell: as wide as plausible turns."""


class GaussianProcessPredictor(Model):
    """Regression with squared exponential covariances about an unknown mean place, averaged by their evidence.

    Sharp on smooth paths of any shape without noise, and soon with noise. Far ahead an obstacle drifts back to where it
    has been. The variance of the motion is its most probable one. Lost observations are filled in.
    """

    leaves_out = 4

    def extrapolate(
        self, observation: Observation, origins: Indices, targets: Indices, ahead_s: FloatArray
    ) -> Extrapolation:
        """See ``Model.extrapolate``."""
        times, positions, radii = without_gaps(observation)
        first = max(0, len(times) - HISTORY)
        counts = np.maximum(1, origins + 1 - first)
        since = times - times[-1]
        basis = _basis(since[first:].tobytes(), counts.tobytes(), since[targets].tobytes(), ahead_s.tobytes())
        return Extrapolation(*follow(positions[first:], EXCURSION_RADII * radii, counts, basis, NOISE_FLOOR_M))


@functools.lru_cache(maxsize=64)
def _basis(seen: bytes, counts: bytes, wanted: bytes, ahead: bytes) -> Basis:
    """Everything that follows from when obstacles were seen: all times are relative to the present."""
    times, later, known = np.frombuffer(seen), np.frombuffer(ahead), np.frombuffer(counts, dtype=np.int64)[:-1]
    targets = np.frombuffer(wanted).reshape(len(known), -1 if len(known) else 0)
    inverses, logs, past, variances = [], [], [], []
    for length in LENGTHS_S:
        within, to_targets, to_later = (_covariance(times, other, length) for other in (times, targets, later))
        for ratio in RATIOS:
            factor = cholesky(within + ratio * np.eye(len(times)), lower=True)
            inverse = solve_triangular(factor, np.eye(len(times)), lower=True)
            inverses.append(inverse)
            logs.append(np.cumsum(np.log(np.diag(factor))))
            past.append(np.tensordot(to_targets, inverse, axes=(0, 1)))
            variances.append(_variance(inverse @ to_later, inverse.sum(axis=1)))
    return Basis(
        whiteners=np.array(inverses).transpose(0, 2, 1).copy(),
        ones=np.array(inverses).sum(axis=2),
        logs=np.array(logs),
        past=np.array(past),
        crosses=np.array([_covariance(times, later, length) for length in LENGTHS_S]),
        variances=np.array(variances),
        ratios=np.tile(RATIOS, len(LENGTHS_S)),
    )


def _covariance(times_s: FloatArray, others_s: FloatArray, length_s: float) -> FloatArray:
    """Squared exponential between every two times, 1 at no distance: (r, *others)."""
    apart = np.subtract.outer(times_s, others_s) / length_s
    return np.asarray(np.exp(-0.5 * apart * apart))


def _variance(reach: FloatArray, ones: FloatArray) -> FloatArray:
    """Variance of forecasts (T,), the motion's being 1: what observations leave open, and the mean's.

    Rasmussen and Williams, equation 2.42, with the inverse factor times covariances (r, T) and times ones (r,).
    """
    left = np.maximum(0.0, 1.0 - np.square(reach).sum(axis=0))
    return np.asarray(left + np.square(1.0 - ones @ reach) / (ones @ ones))
