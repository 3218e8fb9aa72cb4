"""The life of a worker process: say that it is ready, then answer each request with its result."""

from __future__ import annotations

import pickle
import signal
from collections.abc import Callable
from contextlib import suppress
from multiprocessing.connection import Connection
from typing import Any, NamedTuple


LENGTH_BYTES = 8


class Request(NamedTuple):
    """What a worker is asked to do."""

    function: Callable[..., object]
    arguments: tuple[Any, ...]
    limit_s: float
    """After this time the parent will have killed the worker [s]."""


class Unreadable(NamedTuple):
    """The answer to a request that could not be read."""

    message: str


def main(handle: int) -> None:
    """Serve the process at the other end of the socket with this file descriptor until it is gone."""
    import suite.trial.episode  # noqa: F401  what every trial needs, while the parent may still be busy itself

    pipe: Connection[Any, Any] = Connection(handle)
    with suppress(EOFError, OSError):
        pipe.send(None)
        while True:
            pipe.send(_answer(pipe.recv_bytes()))


def _answer(message: bytes) -> object:
    try:
        request: Request = pickle.loads(message)
    except Exception as error:  # noqa: BLE001  whatever a user's module raises when it is imported here
        return Unreadable(f"{type(error).__name__}: {error}".splitlines()[0][:300])
    if hasattr(signal, "setitimer"):  # should the parent be killed, a hung planner must not outlive it for ever
        signal.setitimer(signal.ITIMER_REAL, 2 * request.limit_s + 60)
    return request.function(*request.arguments)
