"""Checks in a process of their own: a planner that hangs, crashes or can't be imported costs a line each."""

from __future__ import annotations

import json
import os
import select
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import suppress
from typing import Any

from planners.child import command_for
from planners.spec import read_spec
from scenarios import SpecError
from suite.conformance.finding import IMPORT, Finding


def run_checks(planner: str, limit_s: float) -> Iterator[Finding]:
    """Import a planner and run every check that concerns it, in order; each finding comes as it is made.

    Args:
        planner: The planner's spec.
        limit_s: A check that takes longer has hung [s]; compiling the suite's own kernels does not count.

    Raises:
        SpecError: Unknown planner or setting, or a value out of range.
    """
    read_spec(planner)  # a slip of the pen is found before a process starts
    examiner = _Examiner(planner, limit_s)
    try:
        names = examiner.start()
        if isinstance(names, Finding):
            yield names
            return
        yield Finding(IMPORT, "ok")
        for name in names:
            if not examiner.is_alive:
                examiner.start()
            yield examiner.ask(name)
    finally:
        examiner.kill()


class _Examiner:
    """A process that has imported the planner and is asked for one check at a time, a line of JSON each way."""

    def __init__(self, planner: str, limit_s: float) -> None:
        self._planner, self._limit_s = planner, limit_s
        self.is_alive = False

    def start(self) -> Finding | list[str]:
        """Start the process and have it import the planner: the names of its checks, or why it could not."""
        self._process = subprocess.Popen(
            command_for("suite.conformance.examiner"),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            start_new_session=True,  # to be killed as a group; Ctrl-C reaches this process alone
        )
        self.is_alive = True
        answer = self._exchange({"planner": self._planner, "path": sys.path}, None)  # compiles the house: no limit
        if answer == "ready":
            answer = self._exchange(IMPORT, self._limit_s)
        if isinstance(answer, str):
            raise SpecError(answer)
        return answer if isinstance(answer, list) else Finding(IMPORT, **answer)

    def ask(self, name: str) -> Finding:
        """What came of the check called ``name``."""
        return Finding(name, **self._exchange(name, self._limit_s))

    def kill(self) -> None:
        """End the process and what it has started."""
        if self.is_alive:
            self.is_alive = False
            with suppress(ProcessLookupError):
                os.killpg(self._process.pid, signal.SIGKILL)
            self._process.communicate()

    def _exchange(self, message: object, limit_s: float | None) -> Any:
        """Send a line and read one; ``hung`` or ``died`` with a message if none comes, and the process is no more."""
        pipe_in, pipe_out = self._process.stdin, self._process.stdout
        assert pipe_in is not None
        assert pipe_out is not None
        with suppress(BrokenPipeError):  # its death shows as the end of its answers
            pipe_in.write(json.dumps(message).encode() + b"\n")
            pipe_in.flush()
        if not select.select([pipe_out], [], [], limit_s)[0]:
            self.kill()
            return {"outcome": "hung", "message": f"killed after {limit_s:g} s"}
        try:
            return json.loads(pipe_out.readline())
        except ValueError:  # the end, or half a line
            with suppress(subprocess.TimeoutExpired):
                self._process.wait(1.0)
            code = self._process.returncode
            self.kill()
            cause = f"exit code {code}" if code is None or code >= 0 else signal.Signals(-code).name
            return {"outcome": "died", "message": f"the process died: {cause}"}
