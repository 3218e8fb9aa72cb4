"""What solutions cost, compared on the scenarios that both solve, as ratios."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

COUNTS = ("state_checks", "motion_checks", "n_solves")
"""Work: the same on any machine."""

COSTS = ("arrival_time_s", "tip_path_length_m", "smoothness_paper_rad")
"""What is executed."""

TIMES = ("planning_time_s", "solve_p50_s")
"""Wall-clock readings, which other processes on the machine change as well."""

RESAMPLES = 4999

FloatArray = npt.NDArray[np.float64]


class CostChange(NamedTuple):
    """How a quantity has changed over pairs, as the ratio of geometric means."""

    base: float
    """Geometric mean."""
    new: float
    ratio: float
    low: float
    """Bootstrap interval of the ratio."""
    high: float
    p_worse: float
    """One-sided, that the ratio is no more than 1 + margin."""
    p_better: float
    """That it is no less than 1 / (1 + margin)."""
    p_within: float
    """That it is at least 1 + margin: the change is shown to be no larger loss than that where this is small."""


def compare_costs(base: FloatArray, new: FloatArray, margin: float, alpha: float, *, is_count: bool) -> CostChange:
    """Compare positive quantities in pairs: sign flips of the logarithms of their ratios about the margin.

    Were the runs of equal planners, each ratio would be as likely to be its own inverse, whatever its distribution.

    Args:
        base: Values, shape (n,), n >= 1.
        new: Those of their partners, shape (n,).
        margin: Change that makes no difference, as a share.
        alpha: Risk on each side of the interval.
        is_count: Whether zero may occur; then one is added to both.
    """
    ones = 1.0 if is_count else 0.0
    gains, edge = np.log(new + ones) - np.log(base + ones), math.log1p(margin)
    low, high = _bootstrap_interval(gains, 1.0 - 2.0 * alpha)
    return CostChange(
        base=geometric_mean(base, is_count=is_count),
        new=geometric_mean(new, is_count=is_count),
        ratio=math.exp(gains.mean()),
        low=math.exp(low),
        high=math.exp(high),
        p_worse=sign_flip_p(gains - edge),
        p_better=sign_flip_p(-gains - edge),
        p_within=sign_flip_p(edge - gains),
    )


def geometric_mean(values: FloatArray, *, is_count: bool) -> float:
    """Geometric mean of values (n,); of counts, that of one more, less one."""
    ones = 1.0 if is_count else 0.0
    return math.exp(np.log(values + ones).mean()) - ones


def sign_flip_p(values: FloatArray) -> float:
    """One-sided p of the mean of values (n,) being above zero: exact up to twelve values, then by random sign flips.

    Nothing is evidence where the mean is not above zero; the p of half and more that the test would give is said as 1.
    """
    if values.mean() <= 0.0:
        return 1.0
    if len(values) == 1:
        return 0.5
    from scipy.stats import permutation_test

    def mean(sample: FloatArray, axis: int) -> FloatArray:
        return np.asarray(sample.mean(axis=axis))

    tested = permutation_test(
        (values,),
        mean,
        permutation_type="samples",
        alternative="greater",
        n_resamples=RESAMPLES,
        vectorized=True,
        rng=np.random.default_rng(0),
    )
    return float(tested.pvalue)


def _bootstrap_interval(values: FloatArray, confidence: float) -> tuple[float, float]:
    """Percentile interval of the mean; there is none of a single value."""
    from scipy.stats import bootstrap

    if len(values) < 2:
        return -math.inf, math.inf
    found = bootstrap(
        (values,),
        np.mean,
        confidence_level=confidence,
        method="percentile",
        n_resamples=RESAMPLES,
        rng=np.random.default_rng(0),
    )
    return float(found.confidence_interval.low), float(found.confidence_interval.high)
