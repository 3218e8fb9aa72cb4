"""One worker process as its parent sees it: asked for one thing at a time, and killed when it takes too long.

It is started anew, not forked (a child would inherit the locks of OMPL's and Numba's threads), and never imports the
parent's main module: a script without a main guard would run once more in it.
"""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from multiprocessing.connection import Connection
from typing import Any, NamedTuple

from suite.backends.worker import Request, Unreadable

START_LIMIT_S = 300.0
_ONE_THREAD = {f"{library}_NUM_THREADS": "1" for library in ("OMP", "OPENBLAS", "MKL")}
"""Threads of workers' libraries would fight over the cores and disturb the timings."""


class Late(NamedTuple):
    """The answer of a worker that was killed for taking too long."""

    limit_s: float


class Dead(NamedTuple):
    """The answer of a worker that died."""

    cause: str
    """Name of the signal, or the exit code."""


class WorkerProcess:
    """One process with its pipe; its first answer, None, says that it has started."""

    def __init__(self) -> None:
        """Start it; it imports what this process would."""
        ours, theirs = socket.socketpair()
        handle = theirs.fileno()
        start = f"import sys; sys.path[:] = {sys.path!r}; from suite.backends.worker import main; main({handle})"
        with _interrupts_held():
            self._process = subprocess.Popen(
                [sys.executable, "-c", start],
                stdin=subprocess.DEVNULL,
                pass_fds=[handle],
                env=_ONE_THREAD | os.environ,
            )
        theirs.close()  # the death of the process now shows as the end of our side
        self.pipe: Connection[Any, Any] = Connection(ours.detach())
        self.is_alive = True
        self.is_asked = True
        self._unsent: Unreadable | None = None
        self._begin(START_LIMIT_S)

    def ask(self, function: Callable[..., object], *arguments: object, limit_s: float) -> None:
        """Have ``function``, importable by name, called there; the process is killed after ``limit_s``."""
        self.is_asked = True
        self._begin(limit_s)
        try:
            self.pipe.send(Request(function, arguments, limit_s))
        except BrokenPipeError:
            pass  # a death is noticed when the pipe is read
        except Exception as error:  # noqa: BLE001  pickle raises whatever the arguments' own methods raise
            self._unsent = Unreadable(f"{type(error).__name__}: {error}".splitlines()[0])

    @property
    def spent_s(self) -> float:
        """Time since it was asked [s]."""
        return time.monotonic() - self._begun_s

    @property
    def patience_s(self) -> float:
        """Time until there is something to see to, unless the pipe says so before [s]."""
        if not self.is_asked:
            return float("inf")
        return 0.0 if self._unsent else max(0.0, self._limit_s - self.spent_s)

    def answer(self) -> object:
        """What came back from the call; ``Late`` or ``Dead`` if nothing will, ``Unreadable`` if it cannot be made."""
        self.is_asked = False
        unsent, self._unsent = self._unsent, None
        if unsent is not None:
            return unsent
        if not self.pipe.poll():
            self.kill()
            return Late(self._limit_s)
        try:
            return self.pipe.recv()
        except (EOFError, ConnectionResetError):
            self._process.wait()
            self.kill()
            return Dead(_cause_of_death(self._process.returncode))

    def kill(self) -> None:
        """End it now, whatever it is at."""
        self.is_alive = False
        self._process.kill()
        self._process.wait()
        self.pipe.close()

    def _begin(self, limit_s: float) -> None:
        self._limit_s, self._begun_s = limit_s, time.monotonic()


@contextmanager
def _interrupts_held() -> Iterator[None]:
    """Let a process that is started here never see Ctrl-C; one that comes meanwhile is ours as soon as this ends.

    Ctrl-C reaches the whole group, and a worker that it meets among its first imports would print a traceback.
    """
    held = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, held)


def _cause_of_death(returncode: int) -> str:
    if returncode < 0:
        with suppress(ValueError):  # a signal without a name
            return signal.Signals(-returncode).name
    return f"exit code {returncode}"
