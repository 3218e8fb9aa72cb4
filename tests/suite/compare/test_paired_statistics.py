import math
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq, minimize_scalar
from scipy.stats import binom, norm

from suite.compare.costs import compare_costs, sign_flip_p
from suite.compare.statistics import mcnemar_p, mcnemar_worse_p, paired_score, tango_interval


def slow_score(only_base: int, only_new: int, pairs: int, difference: float) -> float:
    """The score statistic with the likelihood maximised by search, not by formula."""

    def unlikely(only_base_share: float) -> float:
        only_new_share = only_base_share + difference
        shares = (only_base_share, only_new_share, 1.0 - only_base_share - only_new_share)
        counts = (only_base, only_new, pairs - only_base - only_new)
        return -sum(n * math.log(max(share, 1e-300)) for n, share in zip(counts, shares, strict=True) if n)

    low, high = max(0.0, -difference), 0.5 * (1.0 - difference)
    best = minimize_scalar(unlikely, bounds=(low, high), method="bounded", options={"xatol": 1e-13}).x
    best = min((low, best, high), key=unlikely)
    variance = (2.0 * best + difference - difference**2) / pairs
    return ((only_new - only_base) / pairs - difference) / math.sqrt(variance)


def slow_interval(only_base: int, only_new: int, pairs: int, confidence: float) -> tuple[float, float]:
    z, seen = norm.ppf(0.5 + confidence / 2), (only_new - only_base) / pairs
    nearly = 1.0 - 1e-9
    low = brentq(lambda d: slow_score(only_base, only_new, pairs, d) - z, -nearly, seen - 1e-9)
    high = brentq(lambda d: slow_score(only_base, only_new, pairs, d) + z, seen + 1e-9, nearly)
    return low, high


@pytest.mark.parametrize(
    ("only_base", "only_new", "pairs"), [(0, 1, 44), (12, 2, 50), (30, 10, 400), (0, 0, 30), (3, 3, 9), (1, 0, 2)]
)
def test_tangos_interval_is_what_the_score_test_does_not_reject(only_base: int, only_new: int, pairs: int) -> None:
    fast = tango_interval(only_base, only_new, pairs, 0.9)
    assert fast == pytest.approx(slow_interval(only_base, only_new, pairs, 0.9), abs=2e-6)


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 60), st.integers(0, 60), st.integers(0, 200), st.floats(-0.95, 0.95))
def test_the_score_by_formula_is_that_of_the_likeliest_shares(b: int, c: int, ties: int, difference: float) -> None:
    pairs = b + c + ties
    if pairs and abs(difference) > 1e-6:
        fast, slow = paired_score(b, c, pairs, difference), slow_score(b, c, pairs, difference)
        assert fast == pytest.approx(slow, abs=1e-4, rel=1e-4)


@given(st.integers(0, 300), st.integers(0, 300), st.integers(0, 300))
def test_an_interval_holds_what_was_seen_and_swaps_with_the_runs(b: int, c: int, ties: int) -> None:
    pairs = b + c + ties
    if pairs:
        low, high = tango_interval(b, c, pairs)
        assert -1.0 <= low <= (c - b) / pairs <= high <= 1.0
        assert low < high
        assert tango_interval(c, b, pairs) == pytest.approx((-high, -low), abs=1e-12)


def test_the_lower_bound_keeps_its_risk() -> None:
    """Exactly, over all outcomes: a loss just at the margin is called smaller in about one case of twenty."""
    pairs, lost, won = 60, 0.10, 0.03
    risk = sum(
        binom.pmf(b, pairs, lost) * binom.pmf(c, pairs - b, won / (1 - lost))
        for b, c in product(range(25), range(15))
        if tango_interval(b, c, pairs, 0.9).low > won - lost
    )
    assert 0.03 < risk < 0.07


def test_mcnemar_one_sided_is_the_binomial_tail() -> None:
    assert mcnemar_worse_p(8, 1) == pytest.approx((1 + 9) / 2**9)
    assert mcnemar_worse_p(30, 12) == pytest.approx(binom.cdf(12, 42, 0.5))
    assert mcnemar_worse_p(12, 30) > 0.99
    assert mcnemar_worse_p(0, 0) == 1.0
    assert mcnemar_p(30, 12) == pytest.approx(2 * mcnemar_worse_p(30, 12))


def test_sign_flips_are_all_tried_when_there_are_few() -> None:
    values = np.array([0.3, -0.1, 0.7, 0.2, 0.05, 0.4])
    means = [np.mean(values * signs) for signs in product([1, -1], repeat=6)]
    assert sign_flip_p(values) == pytest.approx(np.mean(np.array(means) >= values.mean() - 1e-12))


def test_costs_are_compared_as_ratios() -> None:
    rng = np.random.default_rng(3)
    base = np.exp(rng.normal(size=80))
    doubled = compare_costs(base, 2.0 * base * np.exp(rng.normal(scale=0.1, size=80)), 0.1, 0.05, is_count=False)
    assert doubled.ratio == pytest.approx(2.0, rel=0.05)
    assert doubled.low < doubled.ratio < doubled.high
    assert (doubled.p_worse < 0.01, doubled.p_better > 0.9, doubled.p_within > 0.9) == (True, True, True)
    same = compare_costs(base, base * np.exp(rng.normal(scale=0.1, size=80)), 0.1, 0.05, is_count=False)
    assert (same.p_worse > 0.9, same.p_better > 0.9, same.p_within < 0.01) == (True, True, True)


def test_no_count_is_a_count() -> None:
    none, some = np.zeros(10), np.full(10, 3.0)
    change = compare_costs(none, some, 0.1, 0.05, is_count=True)
    assert (change.base, change.new, change.ratio) == pytest.approx((0.0, 3.0, 4.0))
    assert change.p_worse < 0.01
