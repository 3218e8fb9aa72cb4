"""The life of a worker process: say that it is ready, then answer each request with its result."""

from __future__ import annotations

import ctypes
import faulthandler
import os
import pickle
import signal
import socket
import sys
from collections.abc import Callable
from contextlib import suppress
from typing import Any, NamedTuple

LENGTH_BYTES = 8
"""Every message begins with its length."""


class Request(NamedTuple):
    """What a worker is asked to do."""

    number: int
    """Which request it is; its answer says so again."""
    function: Callable[..., Any]
    arguments: tuple[Any, ...]
    limit_s: float
    """After this time the parent will have killed the worker [s]."""


class Unreadable(NamedTuple):
    """The answer to a request that could not be read."""

    message: str


def main(handle: int, parent: int) -> None:
    """Serve the process at the other end of the socket with this file descriptor until it is gone."""
    _die_with(parent)
    faulthandler.enable()  # what a crash in C prints is kept with the trial
    import suite.trial.episode  # noqa: F401  what every trial needs, while the parent may still be busy itself
    from suite.backends.answer import packed

    channel = socket.socket(fileno=handle)
    with suppress(OSError):  # a planner may have closed it
        channel.sendall(packed(0, None))
        while message := _received(channel):
            channel.sendall(_answer(message))
    os._exit(0)  # threads and exit handlers of planners are not waited for


def _die_with(parent: int) -> None:
    """Have the system kill this process as soon as its parent is gone, whatever a planner is at; Linux alone can."""
    if sys.platform == "linux":
        set_parent_death_signal = 1
        ctypes.CDLL(None).prctl(set_parent_death_signal, signal.SIGKILL)
        if os.getppid() != parent:
            os._exit(0)


def _received(channel: socket.socket) -> bytes:
    """The next request; empty when there will be none."""
    return _exactly(channel, int.from_bytes(_exactly(channel, LENGTH_BYTES)))


def _exactly(channel: socket.socket, length: int) -> bytes:
    """So many bytes, or none where the other end has gone."""
    parts = list[bytes]()
    while length:
        parts.append(channel.recv(min(length, 1 << 20)))
        if not parts[-1]:
            return b""
        length -= len(parts[-1])
    return b"".join(parts)


def _answer(message: bytes) -> bytes:
    from suite.backends.answer import packed

    number = int.from_bytes(message[:LENGTH_BYTES])
    try:
        request: Request = pickle.loads(message[LENGTH_BYTES:])
    except Exception as error:  # noqa: BLE001  whatever a user's module raises when it is imported here
        return packed(number, Unreadable(f"{type(error).__name__}: {error}".splitlines()[0][:300]))
    if hasattr(signal, "setitimer"):  # where no system kills it: a hung planner must not outlive the parent for ever
        signal.setitimer(signal.ITIMER_REAL, 2 * request.limit_s + 60)
    return packed(number, request.function(*request.arguments))
