"""Trials in worker processes."""

from __future__ import annotations

from collections.abc import Generator
from contextlib import closing
from types import TracebackType
from typing import TYPE_CHECKING, Self

from suite.backends.process import WorkerProcess

if TYPE_CHECKING:
    from suite.backends.job import Job, OnWarmUp
    from suite.trial.lineup import Tasks
    from suite.trial.task import TrialResult, TrialTask


class Processes:
    """Runs trials in worker processes; a context manager, which starts the first and ends them all.

    The first process imports what trials need while this one still imports as much for itself, which is why this
    file imports next to nothing.
    """

    def __init__(self, workers: int) -> None:
        """Use at most ``workers`` processes."""
        self._workers = workers
        self._started: list[WorkerProcess] = []

    def __enter__(self) -> Self:
        self._started.append(WorkerProcess())
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        while self._started:
            self._started.pop().kill()

    def run(
        self, job: Job, tasks: Tasks, on_warm_up: OnWarmUp | None = None
    ) -> Generator[tuple[TrialTask, TrialResult], None, None]:
        """See ``Backend.run``."""
        from suite.backends.crew import Crew

        started, self._started = self._started, []
        with closing(Crew(started, self._workers, job, tasks, on_warm_up)) as crew:
            yield from crew.run()
