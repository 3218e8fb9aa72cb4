"""Confidence intervals and paired tests of success, exact where it is cheap."""

from __future__ import annotations

import math
from collections.abc import Sequence
from statistics import NormalDist
from typing import NamedTuple


class Interval(NamedTuple):
    """A confidence interval of a share."""

    low: float
    high: float


def wilson_interval(successes: int, trials: int, confidence: float = 0.95) -> Interval:
    """Wilson's score interval of a success rate, without continuity correction.

    Unlike the textbook normal interval it stays within [0, 1] and keeps its coverage at rates near 0 and 1.

    Args:
        successes: Number of successes.
        trials: Number of trials, at least one.
        confidence: Coverage.

    References:
        E. B. Wilson, J. Am. Stat. Assoc. 22 (1927), 209-212.
    """
    rate, z = successes / trials, NormalDist().inv_cdf(0.5 + 0.5 * confidence)
    center = (2.0 * trials * rate + z * z) / (2.0 * (trials + z * z))
    half = z * math.sqrt(4.0 * trials * rate * (1.0 - rate) + z * z) / (2.0 * (trials + z * z))
    return Interval(center - half if successes > 0 else 0.0, center + half if successes < trials else 1.0)


def mcnemar_p(only_first: int, only_second: int) -> float:
    """Two-sided exact McNemar test of two planners on the same scenarios.

    Scenarios on which both succeed or both fail carry no information; if the planners were equally good, each of the
    others would go either way like a fair coin.

    Args:
        only_first: Scenarios on which only the first planner succeeds.
        only_second: Scenarios on which only the second one does.
    """
    from scipy.stats import binomtest  # half a second to import, and no run's own table needs it

    discordant = only_first + only_second
    return float(binomtest(only_first, discordant).pvalue) if discordant else 1.0


def holm(p_values: Sequence[float]) -> list[float]:
    """Adjust p-values for the number of tests by Holm's step-down method, in the order given.

    References:
        S. Holm, Scand. J. Stat. 6 (1979), 65-70.
    """
    adjusted = [0.0] * len(p_values)
    largest = 0.0
    for rank, index in enumerate(sorted(range(len(p_values)), key=lambda i: p_values[i])):
        largest = max(largest, min(1.0, (len(p_values) - rank) * p_values[index]))
        adjusted[index] = largest
    return adjusted
