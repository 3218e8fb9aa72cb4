"""A planner's own failure as data: one line for people, the traceback for its author."""

from __future__ import annotations

import site
import sysconfig
import traceback
from pathlib import Path
from typing import NamedTuple

LONGEST_MESSAGE = 300
"""Characters of a message that are kept."""
LONGEST_TRACEBACK = 20_000
"""Characters of a traceback that are kept: its end, where the error is."""

_HOUSE = Path(__file__).resolve().parents[1]
_LIBRARIES = tuple(str(Path(folder).resolve()) for folder in [*site.getsitepackages(), sysconfig.get_paths()["stdlib"]])


class Failure(NamedTuple):
    """Why a planner can't be had or did not come through; it costs that planner's trials and no others."""

    outcome: str
    """Outcome of its trials, such as ``planner_error``."""
    message: str
    """One line, with file and line where there is one."""
    traceback: str = ""


def failure_of(error: BaseException, where: str = "") -> Failure:
    """What was raised ``where``, as one line that names the file and line of the planner's own code.

    Its own is the innermost frame outside the suite and the libraries; without one, the innermost of all.
    """
    said = " ".join("".join(traceback.format_exception_only(error)[-1:])[: 4 * LONGEST_MESSAGE].split())
    line = f"{where}: {said}" if where else said
    whole = "".join(traceback.format_exception(error))
    place = _place(error)
    message = line[: LONGEST_MESSAGE - len(place)] + place
    outcome = "planner_memory" if isinstance(error, MemoryError) else "planner_error"
    return Failure(outcome, _encodable(message), _encodable(whole[-LONGEST_TRACEBACK:]))


def _place(error: BaseException) -> str:
    """`` (file.py:12)``; the last two parts of the path at the most."""
    if isinstance(error, SyntaxError) and error.filename:
        return f" ({Path(error.filename).name}:{error.lineno})"
    frames = traceback.extract_tb(error.__traceback__)
    if not frames:
        return ""
    own = [frame for frame in frames if _is_own(frame.filename)]
    innermost = (own or frames)[-1]
    return f" ({Path(innermost.filename).name}:{innermost.lineno})"


def _is_own(filename: str) -> bool:
    file = Path(filename)
    house = any(file.is_relative_to(_HOUSE / package) for package in ("planners", "suite", "scenarios"))
    return file.is_absolute() and not house and not filename.startswith(_LIBRARIES)


def _encodable(text: str) -> str:
    """The same with what can't be stored as UTF-8, or ends a C string, escaped."""
    return text.encode("utf-8", "backslashreplace").decode("utf-8").replace("\0", "\\0")
