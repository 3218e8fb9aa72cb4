from decimal import Decimal

import pytest
from hypothesis import given
from hypothesis import strategies as st

from suite.errors import SuiteError
from suite.experiment.values import arms_of, expand, expand_spec, listed, specs_of, with_setting


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("3", ["3"]),
        ("1..4", ["1", "2", "3", "4"]),
        ("-1..1", ["-1", "0", "1"]),
        ("0.005..0.03/6", ["0.005", "0.01", "0.015", "0.02", "0.025", "0.03"]),
        ("0..1/3", ["0", "0.5", "1"]),
        ("1..10/4", ["1", "4", "7", "10"]),
        ("2|4|8", ["2", "4", "8"]),
        ("1..2|9", ["1", "2", "9"]),
        ("chained|steps", ["chained", "steps"]),
        ("a..b", ["a..b"]),
    ],
)
def test_what_a_text_stands_for(text: str, values: list[str]) -> None:
    assert expand(text) == values


@pytest.mark.parametrize("text", ["0.1..0.3", "3..1", "1..1", "0..1/1", "1..1000000000", "0..1/1001", "1..2/0"])
def test_a_range_that_is_none_is_one_line(text: str) -> None:
    with pytest.raises(SuiteError, match=r"^found '.*', allowed .*"):
        expand(text)


@given(st.decimals(-100, 100, places=4), st.decimals("0.0001", 100, places=4), st.integers(2, 50))
def test_a_range_is_the_decimal_one(low: Decimal, width: Decimal, count: int) -> None:
    """Against decimal arithmetic: both ends are there as typed, steps are equal, and none is off by a rounding."""
    high = low + width
    values = expand(f"{low:f}..{high:f}/{count}")
    assert len(values) == count
    assert (float(values[0]), float(values[-1])) == (float(low), float(high))
    for k, value in enumerate(values):
        exact = low + width * k / (count - 1)
        assert abs(Decimal(value) - exact) <= abs(exact) * Decimal("2e-16") + Decimal("1e-24")


def test_specs_expand_to_every_combination() -> None:
    assert expand_spec("orbit[a=1..2,b=x|y]") == [
        "orbit[a=1,b=x]",
        "orbit[a=1,b=y]",
        "orbit[a=2,b=x]",
        "orbit[a=2,b=y]",
    ]
    assert specs_of("orbit[a=1|2],wander") == ("orbit[a=1]", "orbit[a=2]", "wander")
    assert specs_of([{"name": "orbit", "a": [1, 2]}, "wander"]) == ("orbit[a=1]", "orbit[a=2]", "wander")
    assert specs_of("../mine..py:Mine") == ("../mine..py:Mine",)
    assert arms_of(["", "radius_m=0.01|0.02,n_sections=2"]) == (
        "",
        "radius_m=0.01,n_sections=2",
        "radius_m=0.02,n_sections=2",
    )
    assert arms_of({"radius_m": "0.01..0.02/2"}) == ("radius_m=0.01", "radius_m=0.02")
    assert with_setting("orbit[a=1]", "b", [1, 2]) == "orbit[a=1,b=1|2]"


def test_a_list_may_be_typed_or_given() -> None:
    assert listed("1,3, 5..7") == ("1", "3", "5", "6", "7")
    assert listed([0, "1..2", 2.5]) == (0, "1", "2", 2.5)
    assert listed(None) == (None,)
    with pytest.raises(SuiteError, match="'1,,3'"):
        listed("1,,3")


def test_too_many_combinations_are_refused() -> None:
    with pytest.raises(SuiteError, match="found 2000 combinations of settings, allowed 1000"):
        expand_spec("orbit[a=1..200,b=1..10]")
