"""What a planner raised: a line for the row, the whole of it for the journal."""

from __future__ import annotations

import traceback
from pathlib import Path

MAX_MESSAGE = 300
MAX_TRACEBACK = 20_000


def in_a_line(error: BaseException) -> str:
    """Type, first line, and the file and line that raised, in ``MAX_MESSAGE`` characters."""
    where = _where(error)
    text = " ".join(_printable(f"{type(error).__name__}: {_text(error)}", MAX_MESSAGE + 1).splitlines()[:1])
    room = MAX_MESSAGE - len(where)
    return (text if len(text) <= room else f"{text[: room - 3]}...") + where


def in_full(error: BaseException) -> str:
    """The traceback; of one longer than ``MAX_TRACEBACK`` characters, both ends."""
    text = "".join(traceback.format_exception(error))
    if len(text) > MAX_TRACEBACK:
        text = f"{text[: MAX_TRACEBACK // 2]}\n...\n{text[-MAX_TRACEBACK // 2 :]}"
    return _printable(text, 2 * MAX_TRACEBACK)


def _where(error: BaseException) -> str:
    """File and line; of files that every package has, the folder as well. The machine's paths are left out."""
    trace = error.__traceback__
    if trace is None:
        return ""
    while trace.tb_next is not None:
        trace = trace.tb_next
    file = Path(trace.tb_frame.f_code.co_filename)
    name = "/".join(file.parts[-2:]) if file.name.startswith("_") else file.name
    return _printable(f" ({name[-100:]}:{trace.tb_lineno})", 120)


def _text(error: BaseException) -> str:
    try:
        return str(error)
    except Exception:  # noqa: BLE001  a planner's own exception may not even have a text
        return "(no text)"


def _printable(text: str, length: int) -> str:
    """Something that any file can hold: surrogates and zeros are written out."""
    return text[:length].encode("utf-8", "backslashreplace").decode("utf-8").replace("\0", "\\0")
