"""Files of others, read as text: bounded, and refused in one line."""

from __future__ import annotations

from pathlib import Path

from suite.errors import SuiteError

MAX_FILE_BYTES = 256 * 1024 * 1024


def read_bytes(file: Path) -> bytes:
    """The whole of a file.

    Raises:
        SuiteError: It cannot be read, or is larger than ``MAX_FILE_BYTES``.
    """
    try:
        size = file.stat().st_size
        if size > MAX_FILE_BYTES:
            raise SuiteError(f"{file}: found {size} bytes, allowed {MAX_FILE_BYTES}")
        return file.read_bytes()
    except (OSError, ValueError) as error:
        raise SuiteError(f"{file}: cannot be read: {getattr(error, 'strerror', None) or error}") from None


def read_text(file: Path) -> str:
    """The whole of a file, as UTF-8 text.

    Raises:
        SuiteError: As ``read_bytes``, or it is no such text.
    """
    try:
        return read_bytes(file).decode("utf-8-sig")
    except UnicodeDecodeError:
        raise SuiteError(f"{file}: found bytes that are not UTF-8, allowed UTF-8 text") from None


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
