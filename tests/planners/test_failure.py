"""A failure as data: whatever is raised becomes a line that any file can hold."""

import pytest

from planners.failure import LONGEST_MESSAGE, LONGEST_TRACEBACK, failure_of


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
        (ValueError("one\ntwo"), "ValueError: one two ("),
        (ValueError(), "ValueError ("),
        (ValueError("bad \udc80 name"), "ValueError: bad \\udc80 name ("),
        (ValueError("nul \0 inside"), "ValueError: nul \\0 inside ("),
        (ValueError("x" * 5_000_000), "ValueError: xxx"),
        (Wordless(), "Wordless: <exception str() failed> ("),
    ],
)
def test_a_line_that_any_file_can_hold(error: Exception, begins: str) -> None:
    failure = failure_of(raised(error))
    line = failure.message.replace("test_failure.Wordless", "Wordless")
    assert line.startswith(begins)
    assert "(test_failure.py:" in line
    assert line.endswith(")")
    assert len(line) <= LONGEST_MESSAGE
    assert "\n" not in line
    line.encode()
    failure.traceback.encode()


def test_the_line_is_where_it_was_raised_and_the_whole_names_every_caller() -> None:
    with pytest.raises(ValueError, match="bottom") as caught:
        deep(3)
    failure = failure_of(caught.value, "in a test")
    number = deep.__code__.co_firstlineno + 2
    assert failure.message == f"in a test: ValueError: at the bottom (test_failure.py:{number})"
    assert failure.traceback.startswith("Traceback")
    assert f"line {number}, in deep" in failure.traceback
    assert "in test_the_line_is_where" in failure.traceback


def test_of_a_long_traceback_the_end_is_kept() -> None:
    failure = failure_of(raised(ValueError("y" * 5_000_000)))
    assert len(failure.traceback) <= LONGEST_TRACEBACK
    assert failure.traceback.endswith("yyy\n")
