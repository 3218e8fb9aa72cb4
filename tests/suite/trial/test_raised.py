import pytest

from suite.trial.raised import MAX_MESSAGE, MAX_TRACEBACK, in_a_line, in_full


class Wordless(Exception):
    def __str__(self) -> str:
        raise RuntimeError("not even that")


def deep(levels: int) -> None:
    if levels == 0:
        raise ValueError("at the bottom")
    deep(levels - 1)


def raised(error: Exception) -> Exception:
    try:
        raise error
    except type(error) as caught:
        return caught


@pytest.mark.parametrize(
    ("error", "begins"),
    [
        (ValueError("one\ntwo"), "ValueError: one ("),
        (ValueError(), "ValueError:  ("),
        (ValueError("bad \udc80 name"), "ValueError: bad \\udc80 name ("),
        (ValueError("nul \0 inside"), "ValueError: nul \\0 inside ("),
        (ValueError("x" * 5_000_000), "ValueError: xxx"),
        (Wordless(), "Wordless: (no text) ("),
    ],
)
def test_a_line_that_any_file_can_hold(error: Exception, begins: str) -> None:
    line = in_a_line(raised(error))
    assert line.startswith(begins)
    assert "(test_raised.py:" in line
    assert line.endswith(")")
    assert len(line) <= MAX_MESSAGE
    assert "\n" not in line
    line.encode()
    in_full(raised(error)).encode()


def test_the_line_is_where_it_was_raised_and_the_whole_names_every_caller() -> None:
    try:
        deep(3)
    except ValueError as error:
        line, whole = in_a_line(error), in_full(error)
    number = deep.__code__.co_firstlineno + 2
    assert line == f"ValueError: at the bottom (test_raised.py:{number})"
    assert whole.startswith("Traceback")
    assert f"line {number}, in deep" in whole
    assert "in test_the_line_is_where" in whole


def test_of_a_traceback_without_end_both_ends_are_kept() -> None:
    whole = in_full(raised(ValueError("y" * 5_000_000)))
    assert len(whole) <= MAX_TRACEBACK + 10
    assert whole.startswith("Traceback")
    assert whole.endswith("yyy\n")
