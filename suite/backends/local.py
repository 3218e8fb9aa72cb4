"""Worker processes that can be killed: a hang or a crash of a planner costs one trial, never the run.

Every worker has a pipe of its own and holds one task at a time, so the parent always knows which task a dead or late
worker had. In a pool with a shared queue a planner that takes its process down at once can pass for one that hangs.
"""

from __future__ import annotations

import multiprocessing
import signal
import time
from collections.abc import Callable, Collection, Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from itertools import islice
from multiprocessing import resource_tracker
from multiprocessing.connection import Connection, wait
from typing import Any

from suite.trial.raised import in_a_line, in_full
from suite.trial.task import TrialResult, TrialTask, failed_trial

_CONTEXT = multiprocessing.get_context("spawn")  # a forked child would inherit the locks of OMPL's and Numba's threads


@dataclass(frozen=True)
class Job:
    """What workers do; the functions are importable by name and what they carry can be pickled."""

    run: Callable[[TrialTask], TrialResult]
    """Called with each task."""
    prepare: Callable[[], None]
    """Called once in each new worker, before its first task and outside the hang limit."""
    hang_limit_s: float
    """A task that takes longer is killed and becomes ``planner_hung`` [s]."""


class WorkerStartError(RuntimeError):
    """A worker process died before it could run a task; no planner is to blame."""


def run_tasks(job: Job, tasks: Iterable[TrialTask], workers: int) -> Iterator[tuple[TrialTask, TrialResult]]:
    """Run every task in one of ``workers`` processes and yield each with its result as it finishes.

    Tasks are taken one at a time, as workers become free. Closing the iterator early kills the workers.

    Raises:
        WorkerStartError: A worker died while it started.
    """
    waiting = iter(tasks)
    crew: list[_Worker] = []
    try:
        for task in islice(waiting, workers):
            crew.append(_Worker(job, task))
        while crew:
            for worker in _due(crew):
                finished, result = worker.task, worker.settle()
                if result is None:
                    continue
                # The worker goes on before the caller sees the result, which it may take its time to store.
                following = next(waiting, None)
                if following is not None and worker.is_alive:
                    worker.take(following)
                else:
                    worker.kill()
                    crew.remove(worker)
                    if following is not None:
                        crew.append(_Worker(job, following))
                yield finished, result
    finally:
        for worker in crew:
            worker.kill()


class _Worker:
    """One process with its pipe and the task it holds."""

    def __init__(self, job: Job, task: TrialTask) -> None:
        self.pipe, theirs = _CONTEXT.Pipe()
        self._process = _CONTEXT.Process(target=_serve, args=(theirs, job), daemon=True)
        with _interrupts_held():
            self._process.start()
        theirs.close()  # the death of the process now shows as the end of our side
        self._job = job
        self._is_ready = False
        self.is_alive = True
        self.take(task)

    def take(self, task: TrialTask) -> None:
        self.task = task
        self._started_s = time.monotonic()
        with suppress(BrokenPipeError):  # a death is noticed when the pipe is read
            self.pipe.send(task)

    @property
    def seconds_left(self) -> float:
        """Time until the task counts as hung; a worker that is still starting has no limit."""
        if not self._is_ready:
            return float("inf")
        return self._started_s + self._job.hang_limit_s - time.monotonic()

    def settle(self) -> TrialResult | None:
        """Read what the pipe holds or kill the late process; None if the worker has only just become ready."""
        if not self.pipe.poll():
            self.kill()
            return self._failed("planner_hung", f"killed after {self._job.hang_limit_s:g} s")
        try:
            message: TrialResult | None = self.pipe.recv()
        except (EOFError, ConnectionResetError):
            self._process.join()
            self.kill()
            cause = _cause_of_death(self._process.exitcode)
            if not self._is_ready:
                raise WorkerStartError(f"a worker process could not start: {cause}") from None
            return self._failed("planner_error", f"the process died: {cause}")
        if message is None:
            self._is_ready = True
            self._started_s = time.monotonic()
        return message

    def kill(self) -> None:
        self.is_alive = False
        self._process.kill()
        self._process.join()
        self.pipe.close()

    def _failed(self, outcome: str, message: str) -> TrialResult:
        return failed_trial(self.task, outcome, message, time.monotonic() - self._started_s)


@contextmanager
def _interrupts_held() -> Iterator[None]:
    """Let a process that is started here never see Ctrl-C; one that comes meanwhile is ours as soon as this ends.

    Ctrl-C reaches the whole group, and a worker that it meets among its first imports would print a traceback.
    """
    resource_tracker.ensure_running()  # started with the first process otherwise, and it lets signals through again
    held = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, held)


def _due(crew: Collection[_Worker]) -> list[_Worker]:
    """Wait until at least one worker has something to say or is late; return those."""
    patience_s = min(worker.seconds_left for worker in crew)
    pipes = [worker.pipe for worker in crew]
    talking = wait(pipes, timeout=None if patience_s == float("inf") else max(0.0, patience_s))
    return [worker for worker in crew if worker.pipe in talking or worker.seconds_left <= 0]


def _serve(pipe: Connection[Any, Any], job: Job) -> None:
    """The life of a worker process: say that it is ready, then answer each task with its result."""
    job.prepare()
    with suppress(EOFError, OSError):  # the parent has closed the pipe or is gone
        pipe.send(None)
        while True:
            task = pipe.recv()
            if hasattr(signal, "setitimer"):  # should the parent be killed, a hung planner must not outlive it for ever
                signal.setitimer(signal.ITIMER_REAL, 2 * job.hang_limit_s + 60)
            pipe.send(_attempt(job, task))


def _attempt(job: Job, task: TrialTask) -> TrialResult:
    started_s = time.monotonic()
    try:
        return job.run(task)
    except Exception as error:  # noqa: BLE001  a planner may raise anything; it becomes a row, not the end of the run
        elapsed_s = time.monotonic() - started_s
        return failed_trial(task, "planner_error", in_a_line(error), elapsed_s, in_full(error))


def _cause_of_death(exitcode: int | None) -> str:
    if exitcode is not None and exitcode < 0:
        return signal.Signals(-exitcode).name
    return f"exit code {exitcode}"
