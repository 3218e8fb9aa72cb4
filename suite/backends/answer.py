"""What a worker process answers, as bytes of a form that is checked when they are read.

A planner shares the worker's process and may write into its channel whatever it likes, so nothing that comes out of
one is unpickled: a frame is a length, a JSON header and numbers.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np

from planners.failure import LONGEST_MESSAGE, LONGEST_TRACEBACK, Failure
from suite.backends.worker import LENGTH_BYTES, Unreadable
from suite.trial.columns import MEASURED, OUTCOMES
from suite.trial.task import TrialResult

MAX_HEADER_BYTES = 1024 * 1024
MAX_FRAME_BYTES = 256 * 1024 * 1024


class GarbledError(ValueError):
    """Bytes that are no answer; the message says why."""


Answer = TrialResult | Failure | Unreadable | None
"""None says that it is done: started, or warmed up."""


def packed(number: int, answer: Answer) -> bytes:
    """The frame of the answer to request ``number``; what is of a result's trial itself is left out."""
    numbers = b""
    match answer:
        case None:
            said: dict[str, Any] = {"kind": "done"}
        case Failure():
            said = {"kind": "failure", **answer._asdict()}
        case Unreadable(message):
            said = {"kind": "unreadable", "message": message}
        case TrialResult(row, times_s, configurations_rad, traceback):
            measured = {column.name: row[column.name] for column in MEASURED}
            said = {"kind": "trial", "measured": measured, "traceback": traceback, "states": len(times_s)}
            numbers = np.column_stack([times_s, configurations_rad]).astype("<f8").tobytes()
    header = json.dumps({"request": number, **said}).encode()
    body = len(header).to_bytes(LENGTH_BYTES) + header + numbers
    return len(body).to_bytes(LENGTH_BYTES) + body


def frame_length(begun: bytes | bytearray) -> int | None:
    """Bytes of the whole frame that begins with these; None as long as they do not say it.

    Raises:
        GarbledError: No answer is so long.
    """
    if len(begun) < LENGTH_BYTES:
        return None
    length = int.from_bytes(begun[:LENGTH_BYTES])
    if length > MAX_FRAME_BYTES:
        raise GarbledError(f"found an answer of {length} bytes, allowed {MAX_FRAME_BYTES}")
    return LENGTH_BYTES + length


def unpacked(number: int, frame: bytes) -> Answer:
    """The answer in a whole frame; the row of a result holds what was measured, which is for the caller to check.

    Raises:
        GarbledError: It is no answer to request ``number``.
    """
    header, numbers = _parts(frame)
    if header.get("request") != number:
        raise GarbledError("found an answer to something else")
    match header:
        case {"kind": "done"}:
            return None
        case {"kind": "failure", "outcome": str(outcome), "message": str(message), "traceback": str(traceback)}:
            if outcome not in OUTCOMES:
                raise GarbledError("found an unknown outcome")
            return Failure(outcome, _sound(message)[:LONGEST_MESSAGE], _sound(traceback)[-LONGEST_TRACEBACK:])
        case {"kind": "unreadable", "message": str(message)}:
            return Unreadable(_sound(message)[:LONGEST_MESSAGE])
        case {"kind": "trial", "measured": dict(measured), "traceback": str(traceback), "states": int(states)}:
            timed = _states(numbers, states)
            return TrialResult(measured, timed[:, 0], timed[:, 1:], _sound(traceback)[-LONGEST_TRACEBACK:])
    raise GarbledError("found something else than an answer")


def _parts(frame: bytes) -> tuple[Mapping[str, Any], bytes]:
    start = 2 * LENGTH_BYTES
    if len(frame) != frame_length(frame):
        raise GarbledError("found more than an answer")
    length = int.from_bytes(frame[LENGTH_BYTES:start])
    if len(frame) < start or not length <= min(len(frame) - start, MAX_HEADER_BYTES):
        raise GarbledError("found bytes that are no answer")
    try:
        header = json.loads(frame[start : start + length])
    except (ValueError, RecursionError):
        raise GarbledError("found bytes that are no answer") from None
    if not isinstance(header, dict):
        raise GarbledError("found bytes that are no answer")
    return header, frame[start + length :]


def _states(numbers: bytes, states: int) -> Any:
    """Times and configurations, shape (states, 1 + dof)."""
    if states < 0 or len(numbers) % (8 * max(states, 1)):
        raise GarbledError("found numbers that are no states")
    width = len(numbers) // (8 * states) if states else 1
    if (states and not width) or (not states and numbers):
        raise GarbledError("found numbers that are no states")
    return np.frombuffer(numbers, "<f8").reshape(states, width)


def _sound(text: str) -> str:
    """The same without what cannot be stored."""
    return text.encode("utf-8", "backslashreplace").decode().replace("\0", "\\0")
