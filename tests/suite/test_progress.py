from typing import NamedTuple
from unittest.mock import patch

import pytest

from suite import progress
from suite.progress import Compilation


class Part(NamedTuple):
    name: str
    typical_s: float = 10.0


PARTS = [Part(name) for name in "abcd"]


def sentences(*seen: tuple[float, list[Part], list[Part]]) -> list[str]:
    """What is said at each time [s], given the parts under way and those not yet begun."""
    with patch.object(progress.time, "monotonic", side_effect=[0.0, *(time_s for time_s, _, _ in seen)]):
        compilation = Compilation()
        return [compilation.sentence(running, waiting) for _, running, waiting in seen]


def test_loading_is_not_talked_about() -> None:
    assert sentences((0.0, PARTS[:2], PARTS[2:]), (1.0, PARTS[2:], []), (5.0, [], [])) == ["", "", ""]


def test_it_says_what_is_compiled_and_how_long_that_takes() -> None:
    (said,) = sentences((2.5, PARTS[:2], PARTS[2:]))
    assert said == "compiling, once: a, b and 2 more; about 20 s to go"


def test_the_pace_is_that_of_the_parts_that_are_done() -> None:
    *_, said = sentences((0.0, PARTS[:2], PARTS[2:]), (20.0, PARTS[2:], []), (24.0, PARTS[2:], []))
    assert said.endswith("about 16 s to go")  # two took 20 s, the other two have taken 4


def test_what_was_only_loaded_says_nothing_about_the_pace() -> None:
    *_, said = sentences((0.0, PARTS[:2], PARTS[2:]), (0.5, PARTS[2:], []), (3.0, PARTS[2:], []))
    assert said.endswith("about 8 s to go")


def test_it_never_says_that_nothing_is_left() -> None:
    *_, said = sentences((0.0, PARTS[:1], []), (40.0, PARTS[:1], []))
    assert said.endswith("about 2 s to go")


def test_what_takes_far_too_long_may_hang() -> None:
    *_, said = sentences((0.0, PARTS[:1], []), (55.0, PARTS[:1], []))
    assert said == "warming up: a; 55 s so far, longer than usual: it may hang"


def test_log_lines_are_few(capsys: pytest.CaptureFixture[str]) -> None:
    with progress.progress(3) as report:
        for _ in range(3):
            report.warm_up(PARTS[:2], PARTS[2:])
            report("a")
    assert capsys.readouterr().err.splitlines() == ["3 trials to run", "3/3 trials, about 0 s to go"]
