"""Worker processes that can be killed: a hang or a crash of a planner costs one trial, never the run.

Every worker owns a pipe and holds at most one task, so the parent always knows which task a dead or late worker had. A
pool with a shared queue does not: there, a planner that takes its process down at once can look like one that hangs.
"""

from __future__ import annotations

import multiprocessing
import signal
import time
from collections.abc import Callable, Iterable, Iterator
from multiprocessing.connection import Connection, wait

from suite.trial import TrialResult, TrialTask, failed_trial

Run = Callable[[TrialTask], TrialResult]
Prepare = Callable[[], None]

_CONTEXT = multiprocessing.get_context("spawn")  # a forked child would inherit OMPL's and Numba's threads and locks


class WorkerStartError(RuntimeError):
    """A worker process died before it could take a task."""


def run_tasks(
    tasks: Iterable[TrialTask], run: Run, prepare: Prepare, workers: int, hang_limit_s: float
) -> Iterator[tuple[TrialTask, TrialResult]]:
    """Run every task in one of ``workers`` processes and yield each with its result as it finishes.

    Args:
        tasks: Taken one at a time, as workers become free.
        run: What a worker does with a task; importable and picklable, as is ``prepare``.
        prepare: Called once in every new worker, before its first task and outside every limit.
        workers: Number of processes, at least one.
        hang_limit_s: A task that runs longer is killed and becomes ``planner_hung`` [s].

    Raises:
        WorkerStartError: A worker died while it started; no task is to blame.
    """
    waiting = iter(tasks)
    crew = [_Worker(run, prepare, hang_limit_s) for _ in range(workers)]
    try:
        while crew:
            patience_s = min(worker.seconds_left() for worker in crew)
            ready = wait([worker.pipe for worker in crew], timeout=max(0.0, min(patience_s, 3600.0)))
            for worker in list(crew):
                if worker.pipe not in ready and worker.seconds_left() > 0:
                    continue
                finished = worker.task
                result = worker.collect() if worker.pipe in ready else worker.give_up()
                if not worker.is_alive:
                    crew.remove(worker)
                following = next(waiting, None)
                if following is None:
                    worker.kill()
                    crew = [other for other in crew if other is not worker]
                else:
                    if worker not in crew:
                        worker = _Worker(run, prepare, hang_limit_s)
                        crew.append(worker)
                    worker.start(following)
                if finished is not None and result is not None:
                    yield finished, result
    finally:
        for worker in crew:
            worker.kill()
