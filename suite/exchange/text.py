"""Files of others, read as text: bounded, and refused in one line."""

from __future__ import annotations

from pathlib import Path

from scenarios import reading
from suite.errors import SuiteError

MAX_FILE_BYTES = 256 * 1024 * 1024


def read_bytes(file: Path) -> bytes:
    """The whole of a file.

    Raises:
        FileError: It cannot be read, is no regular file, or is larger than ``MAX_FILE_BYTES``.
    """
    with reading.open_regular(file, MAX_FILE_BYTES) as handle:
        return handle.read(MAX_FILE_BYTES)


def read_text(file: Path) -> str:
    """The whole of a file, as UTF-8 text.

    Raises:
        FileError: As ``read_bytes``, or it is no such text.
    """
    return reading.read_text(file, MAX_FILE_BYTES)


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
