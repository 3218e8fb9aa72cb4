"""One worker process as its parent sees it: asked for one thing at a time, and killed when it takes too much.

It is started anew, not forked (a child would inherit the locks of OMPL's and Numba's threads), and never imports the
parent's main module: a script without a main guard would run once more in it. It leads a process group of its own, so
that what its planners start ends with it, and Ctrl-C reaches the parent alone.
"""

from __future__ import annotations

import os
import pickle
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from typing import Any, NamedTuple

from suite.backends.memory import private_mb
from suite.backends.worker import LENGTH_BYTES, Request, Unreadable

START_LIMIT_S = 300.0
SEND_LIMIT_S = 10.0
"""A worker that waits for a request takes it at once; one that takes longer [s] has been stopped."""
EXIT_LIMIT_S = 2.0
"""A worker whose channel is closed has so long [s] to be gone."""
LOOK_EVERY_S = 0.1
"""How often memory is looked at [s], where it is limited."""
LOG_BYTES = 4096
"""So much of what a trial prints is kept: its beginning."""
_OUTSIDE = {"SIGKILL", "SIGTERM", "SIGHUP"}
_ONE_THREAD = {f"{library}_NUM_THREADS": "1" for library in ("OMP", "OPENBLAS", "MKL")}
"""Threads of workers' libraries would fight over the cores and disturb the timings."""


class Late(NamedTuple):
    """The answer of a worker that was killed for taking too long."""

    limit_s: float


class Bloated(NamedTuple):
    """The answer of a worker that was killed for taking too much memory."""

    limit_mb: float


class Dead(NamedTuple):
    """The answer of a worker that died."""

    cause: str
    """Name of the signal, or the exit code."""

    @property
    def is_from_outside(self) -> bool:
        """Whether somebody else ended it, as the system does that runs out of memory."""
        return self.cause in _OUTSIDE


class Garbled(NamedTuple):
    """The answer of a worker in whose channel stood something else; it was killed."""

    message: str


PENDING = object()
"""No answer yet."""


class WorkerProcess:
    """One process with its channel; its first answer, None, says that it has started."""

    def __init__(self) -> None:
        """Start it; it imports what this process would."""
        self._channel, theirs = socket.socketpair()
        self._channel.setblocking(False)
        printed, their_output = os.pipe()
        os.set_blocking(printed, False)
        call = f"main({theirs.fileno()}, {os.getpid()})"
        start = f"import sys; sys.path[:] = {sys.path!r}; from suite.backends.worker import main; {call}"
        self._process = subprocess.Popen(
            [sys.executable, "-c", start],
            stdin=subprocess.DEVNULL,
            stdout=their_output,
            stderr=their_output,
            pass_fds=[theirs.fileno()],
            env=_ONE_THREAD | {"SUITE_CACHE_FALLBACK": f"continuum-arm-suite-{os.getpid()}"} | os.environ,
            start_new_session=True,
        )
        theirs.close()  # the death of the process now shows as the end of our side
        os.close(their_output)
        self._printed: int | None = printed
        self.is_alive = True
        self.is_asked = True
        self._number = 0
        self._unsent: object = None
        self._begin(START_LIMIT_S, None)

    def ask(
        self, function: Callable[..., Any], *arguments: object, limit_s: float, memory_limit_mb: float | None = None
    ) -> None:
        """Have ``function``, importable by name, called there; the process is killed when it exceeds a limit.

        Args:
            function: Called there; what it returns comes back.
            *arguments: Handed to it.
            limit_s: Wall time [s].
            memory_limit_mb: Memory that it and its children may take beyond what they have now [MB].
        """
        self.is_asked = True
        self._number += 1
        self._begin(limit_s, memory_limit_mb)
        try:
            request = pickle.dumps(Request(self._number, function, arguments, limit_s))
        except Exception as error:  # noqa: BLE001  pickle raises whatever the arguments' own methods raise
            self._unsent = Unreadable(f"{type(error).__name__}: {error}".splitlines()[0])
            return
        body = self._number.to_bytes(LENGTH_BYTES) + request
        self._channel.settimeout(SEND_LIMIT_S)
        with suppress(OSError):  # a death is noticed when the channel is read, a stopped process when it is late
            self._channel.sendall(len(body).to_bytes(LENGTH_BYTES) + body)
        self._channel.setblocking(False)

    @property
    def handles(self) -> list[socket.socket | int]:
        """What to wait for, to ask for the answer then."""
        return [self._channel] if self._printed is None else [self._channel, self._printed]

    @property
    def spent_s(self) -> float:
        """Time since it was asked [s]."""
        return time.monotonic() - self._begun_s

    @property
    def patience_s(self) -> float:
        """Time until there is something to see to, unless ``handles`` say so before [s]."""
        if not self.is_asked:
            return float("inf")
        if self._unsent:
            return 0.0
        left_s = max(0.0, self._limit_s - self.spent_s)
        return left_s if self._memory_limit_mb is None else min(left_s, LOOK_EVERY_S)

    def answer(self) -> object:
        """What came back from the call, or why nothing will; ``PENDING`` as long as neither is known."""
        self._listen()
        answer = self._unsent or self._heard_answer()
        self._unsent = None
        if answer is PENDING and self._is_at_end:
            answer = Dead(self._cause_of_death())
        elif answer is PENDING and self.is_asked:
            answer = self._exceeded()
        if isinstance(answer, Late | Bloated | Dead | Garbled):
            self.kill()
        self.is_asked = self.is_asked and answer is PENDING
        return answer

    def log(self) -> str:
        """The beginning of what has been printed since it was asked."""
        return bytes(self._log).decode("utf-8", "backslashreplace").replace("\0", "\\0")

    def kill(self) -> None:
        """End it now, whatever it is at, and what it has started."""
        if not self.is_alive:
            return
        self.is_alive = False
        with suppress(ProcessLookupError):
            os.killpg(self._process.pid, signal.SIGKILL)
        self._process.wait()
        self._listen()
        self._channel.close()
        if self._printed is not None:
            os.close(self._printed)
            self._printed = None

    def _begin(self, limit_s: float, memory_limit_mb: float | None) -> None:
        self._limit_s, self._begun_s = limit_s, time.monotonic()
        self._memory_limit_mb = memory_limit_mb
        self._memory_mb = 0.0 if memory_limit_mb is None else private_mb(self._process.pid)
        self._heard, self._log = bytearray(), bytearray()
        self._is_at_end = False

    def _listen(self) -> None:
        """Take what has arrived; of a flood only a part, so that other workers are heard as well."""
        for _ in range(64):
            if self._printed is None:
                break
            try:
                text = os.read(self._printed, 65536)
            except BlockingIOError:
                break
            self._log += text[: LOG_BYTES - len(self._log)]
            if not text:
                os.close(self._printed)
                self._printed = None
        with suppress(BlockingIOError, ConnectionResetError):
            for _ in range(256):
                data = self._channel.recv(65536)
                self._is_at_end = not data
                if not data:
                    break
                self._heard += data

    def _heard_answer(self) -> object:
        # Imported late: the first worker is on its way while this process imports the like.
        from suite.backends.answer import GarbledError, frame_length, unpacked

        if self._heard and not self.is_asked:
            return Garbled("found an answer to nothing")
        try:
            length = frame_length(self._heard)
            if length is None or len(self._heard) < length:
                return PENDING
            return unpacked(self._number, bytes(self._heard))
        except GarbledError as error:
            return Garbled(str(error))

    def _exceeded(self) -> object:
        if self.spent_s >= self._limit_s:
            return Late(self._limit_s)
        limit_mb = self._memory_limit_mb
        if limit_mb is not None and private_mb(self._process.pid) - self._memory_mb > limit_mb:
            return Bloated(limit_mb)
        return PENDING

    def _cause_of_death(self) -> str:
        try:
            code = self._process.wait(EXIT_LIMIT_S)
        except subprocess.TimeoutExpired:
            return "it closed its channel"
        if code < 0:
            with suppress(ValueError):  # a signal without a name
                return signal.Signals(-code).name
        return f"exit code {code}"
