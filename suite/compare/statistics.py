"""Confidence intervals and paired tests of success, exact where it is cheap."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
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


def mcnemar_worse_p(only_base: int, only_new: int) -> float:
    """One-sided exact McNemar test of whether the new succeeds less often than the base, on the same scenarios.

    Args:
        only_base: Scenarios on which only the base succeeds.
        only_new: Scenarios on which only the new one does.
    """
    from scipy.stats import binomtest

    discordant = only_base + only_new
    return float(binomtest(only_base, discordant, alternative="greater").pvalue) if discordant else 1.0


def tango_interval(only_base: int, only_new: int, pairs: int, confidence: float = 0.9) -> Interval:
    """Tango's score interval of the difference of two success rates, new less base, seen on the same scenarios.

    The interval holds the differences that a score test does not reject. Unlike the textbook interval of paired
    differences it keeps its coverage with few discordant pairs, and does not shrink to a point with none.

    Args:
        only_base: Pairs in which only the base succeeds.
        only_new: Pairs in which only the new one does.
        pairs: All pairs, at least one.
        confidence: Two-sided coverage; a bound by itself has half of the rest as its risk.

    References:
        T. Tango, Stat. Med. 17 (1998), 891-908.
    """
    z = NormalDist().inv_cdf(0.5 + 0.5 * confidence)
    estimate = (only_new - only_base) / pairs

    def score(difference: float) -> float:
        return paired_score(only_base, only_new, pairs, difference)

    # The score falls with the difference that it is asked about, through 0 at the estimate.
    low = -1.0 if only_base == pairs else _falls_to(z, score, -1.0, estimate)
    high = 1.0 if only_new == pairs else _falls_to(-z, score, estimate, 1.0)
    return Interval(low, high)


def paired_score(only_base: int, only_new: int, pairs: int, difference: float) -> float:
    """Score statistic of the hypothesis that the success rates differ by ``difference``; see ``tango_interval``."""
    a = 2.0 * pairs
    b = (2.0 * pairs - only_new + only_base) * difference - only_new - only_base
    c = -only_base * difference * (1.0 - difference)
    lost = (math.sqrt(max(b * b - 4.0 * a * c, 0.0)) - b) / (2.0 * a)  # likeliest share that only the base solves
    variance = pairs * (2.0 * lost + difference * (1.0 - difference))
    deviation = only_new - only_base - pairs * difference
    if deviation == 0.0:
        return 0.0
    return deviation / math.sqrt(variance) if variance > 0.0 else math.copysign(math.inf, deviation)


def _falls_to(value: float, score: Callable[[float], float], low: float, high: float) -> float:
    """Where a falling function comes down to ``value`` between ``low`` and ``high``, by bisection."""
    for _ in range(60):
        middle = 0.5 * (low + high)
        if score(middle) > value:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)
