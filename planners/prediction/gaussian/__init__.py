"""Gaussian processes: motion that is smooth, and of which nothing else is known (Rasmussen and Williams 2006)."""

import functools

import numpy as np
from scipy.linalg.lapack import dpotrf, dtrtrs

from planners.prediction.gaussian._kernels import Basis, follow
from planners.prediction.model import NOISE_FLOOR_M, TURN_RADII, Extrapolation, Indices, Model
from planners.prediction.observation import Observation
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
    has been. The variance of the motion is its most probable one. Lost observations are left out.
    """

    leaves_out = 4

    def extrapolate(
        self, observation: Observation, origins: Indices, targets: Indices, ahead_s: FloatArray
    ) -> Extrapolation:
        """See ``Model.extrapolate``."""
        times, positions, radii = observation
        recent = np.arange(len(times))[-HISTORY:]
        if not np.isnan(positions[recent, :, 0]).any():
            return _through(recent, observation, origins, targets, ahead_s)
        each = []
        for j in range(len(radii)):
            seen = np.flatnonzero(~np.isnan(positions[:, j, 0]))[-HISTORY:]
            alone = Observation(times, positions[:, j : j + 1], radii[j : j + 1])
            each.append(_through(seen, alone, origins, targets, ahead_s))
        return Extrapolation(*(np.concatenate(parts) for parts in zip(*each, strict=True)))


def _through(
    seen: Indices, observation: Observation, origins: Indices, targets: Indices, ahead_s: FloatArray
) -> Extrapolation:
    """See ``Model.extrapolate``: through the observations with indices ``seen``, of which none is lost."""
    times, positions, radii = observation
    since, scales = times - times[-1], EXCURSION_RADII * radii
    if len(seen) == len(times) - seen[0]:  # times that recur, in every scenario
        basis = _remembered(since[seen].tobytes(), since[targets].tobytes(), targets.shape, ahead_s.tobytes())
    else:
        basis = _basis(since[seen], since[targets], ahead_s)
    counts = np.maximum(1, np.searchsorted(seen, origins, side="right"))
    return Extrapolation(*follow(positions[seen], scales, counts, basis, NOISE_FLOOR_M))


@functools.lru_cache(maxsize=64)
def _remembered(seen: bytes, wanted: bytes, shape: tuple[int, ...], ahead: bytes) -> Basis:
    """The basis with variances; ``shape`` is that of the targets."""
    basis = _basis(np.frombuffer(seen), np.frombuffer(wanted).reshape(shape), np.frombuffer(ahead))
    variances = []
    for f, whitener in enumerate(basis.whiteners):
        inverse = whitener.T
        variances.append(_variance(inverse @ basis.crosses[f // len(RATIOS)], inverse.sum(axis=1)))
    return basis._replace(variances=np.array(variances))


def _basis(times: FloatArray, targets: FloatArray, later: FloatArray) -> Basis:
    """What follows from when obstacles were seen, without variances; all times are relative to the present."""
    n, r, one = len(LENGTHS_S) * len(RATIOS), len(times), np.eye(len(times))
    whiteners, ones, logs = np.empty((n, r, r)), np.empty((n, r)), np.empty((n, r))
    past, crosses = np.empty((n, targets.size, r)), np.empty((len(LENGTHS_S), r, len(later)))
    for e, length in enumerate(LENGTHS_S):
        within, to_targets = _covariance(times, times, length), _covariance(times, targets.ravel(), length)
        crosses[e] = _covariance(times, later, length)
        for f, ratio in enumerate(RATIOS, e * len(RATIOS)):
            # Bare LAPACK, since SciPy's checks take longer; the least ratio keeps the covariance positive definite.
            factor, _ = dpotrf(within + ratio * one, lower=1)
            inverse, _ = dtrtrs(factor, one, lower=1)
            whiteners[f] = inverse.T
            ones[f] = np.ascontiguousarray(inverse).sum(axis=1)
            logs[f] = np.cumsum(np.log(np.diag(factor)))
            past[f] = to_targets.T @ inverse.T
    return Basis(
        whiteners=whiteners,
        ones=ones,
        logs=logs,
        past=past.reshape(n, *targets.shape, r),
        crosses=crosses,
        variances=np.empty((0, len(later))),
        ratios=np.tile(RATIOS, len(LENGTHS_S)),
    )


def _covariance(times_s: FloatArray, others_s: FloatArray, length_s: float) -> FloatArray:
    """Squared exponential between every two times, 1 at no distance: (r, others)."""
    covariance = np.subtract.outer(times_s, others_s)  # worked on in place: fresh memory takes longer than sums
    covariance /= length_s
    covariance *= covariance
    covariance *= -0.5
    return np.asarray(np.exp(covariance, out=covariance))


def _variance(reach: FloatArray, ones: FloatArray) -> FloatArray:
    """Variance of forecasts (T,), the motion's being 1: what observations leave open, and the mean's.

    Rasmussen and Williams, equation 2.42, with the inverse factor times covariances (r, T) and times ones (r,).
    """
    left = np.maximum(0.0, 1.0 - np.square(reach).sum(axis=0))
    return np.asarray(left + np.square(1.0 - ones @ reach) / (ones @ ones))
