"""Numbers in files of others."""

from __future__ import annotations

from suite.errors import SuiteError

MAX_FILE_BYTES = 256 * 1024 * 1024


def number(where: str, text: str) -> float:
    """A finite number, or NaN for an empty cell.

    Raises:
        SuiteError: It is something else.
    """
    try:
        value = float(text) if text.strip() else float("nan")
    except ValueError:
        raise SuiteError(f"{where}: found {text[:40]!r}, allowed a number") from None
    if value in (float("inf"), float("-inf")):
        raise SuiteError(f"{where}: found {text[:40]!r}, allowed a finite number")
    return value
