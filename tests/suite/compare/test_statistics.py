import math

import pytest
from scipy.stats import binom

from suite.compare.statistics import holm, mcnemar_p, wilson_interval


@pytest.mark.parametrize(("successes", "trials"), [(0, 10), (1, 10), (46, 100), (93, 100), (100, 100), (1, 1)])
def test_wilson_interval_is_the_closed_formula(successes: int, trials: int) -> None:
    z, share = 1.959963984540054, successes / trials
    middle = (share + z * z / (2 * trials)) / (1 + z * z / trials)
    half = z / (1 + z * z / trials) * math.sqrt(share * (1 - share) / trials + z * z / (4 * trials * trials))
    low, high = wilson_interval(successes, trials)
    assert low == pytest.approx(middle - half, abs=1e-12)
    assert high == pytest.approx(middle + half, abs=1e-12)


def test_wilson_interval_of_the_published_t3_at_one_obstacle() -> None:
    low, high = wilson_interval(93, 100)
    assert (round(low, 3), round(high, 3)) == (0.863, 0.966)


def test_mcnemar_by_hand() -> None:
    assert mcnemar_p(1, 8) == pytest.approx(2 * (1 + 9) / 2**9)
    assert mcnemar_p(8, 1) == mcnemar_p(1, 8)


def test_mcnemar_is_twice_the_binomial_tail() -> None:
    assert mcnemar_p(30, 12) == pytest.approx(2 * binom.cdf(12, 42, 0.5))


@pytest.mark.parametrize("ties", [0, 5])
def test_mcnemar_of_equals_is_one(ties: int) -> None:
    assert mcnemar_p(ties, ties) == pytest.approx(1.0)


def test_holm_by_hand() -> None:
    assert holm([0.01, 0.04, 0.03, 0.005]) == pytest.approx([0.03, 0.06, 0.06, 0.02])


def test_holm_never_exceeds_one_and_keeps_the_order() -> None:
    adjusted = holm([0.9, 0.8, 0.0001, 0.5])
    assert adjusted == pytest.approx([1.0, 1.0, 0.0004, 1.0])
    assert holm([]) == []
