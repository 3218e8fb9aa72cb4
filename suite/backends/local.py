"""Trials in the calling process: what each worker does, and a backend of its own."""

from __future__ import annotations

import copy
import gc
import time
from collections.abc import Generator

from planners.failure import Failure, failure_of
from suite.backends.job import Job, OnWarmUp, Part
from suite.trial.lineup import Tasks
from suite.trial.task import RowError, TrialResult, TrialTask, checked_result, failed_trial

MANY_OBJECTS = 300_000
"""Made by compiling, not by loading what was compiled: worth the tenth of a second that it takes to clear away."""


class InProcess:
    """Runs trials one after the other in the calling process: in notebooks, on stdin, under a debugger.

    There is no hang limit here, and a planner that takes its process down ends the run.
    """

    def run(
        self, job: Job, tasks: Tasks, on_warm_up: OnWarmUp | None = None
    ) -> Generator[tuple[TrialTask, TrialResult], None, None]:
        """See ``Backend.run``."""
        failures: dict[str, Failure | None] = {}
        for task in tasks:
            if task.spec.failure:
                yield task, failed_trial(task, task.spec.failure, 0.0)
                continue
            for part in job.needed_by(task):
                if part.name not in failures:
                    if on_warm_up is not None:
                        on_warm_up([part], [p for p in job.parts if p.name not in {part.name, *failures}])
                    failures[part.name] = warm_up(part)
                if failure := failures[part.name]:
                    yield task, failed_trial(task, within(in_warm_up(part), failure), 0.0)
                    break
            else:
                yield task, run_task(job, copy.deepcopy(task))  # a planner may get at it and change it


def warm_up(part: Part) -> Failure | None:
    """Warm up ``part`` in this process; whatever it raises is a failure of its planner."""
    # Compiling makes millions of objects that stay; looking through them time and again takes a tenth of its time.
    collects = gc.isenabled()
    gc.disable()
    try:
        part.run()
    except (Exception, SystemExit) as error:  # noqa: BLE001  a planner may raise anything
        return failure_of(error)
    finally:
        if collects:
            gc.enable()
        if gc.get_count()[0] > MANY_OBJECTS:
            gc.collect()
    return None


def in_warm_up(part: Part) -> str:
    """Where a failure happened, for its message."""
    return "in warm-up" if part.planner else f"in warm-up, {part.name}"


def within(where: str, failure: Failure) -> Failure:
    """The same, its message saying where."""
    return failure._replace(message=f"{where}: {failure.message}")


def run_task(job: Job, task: TrialTask) -> TrialResult:
    """Run ``task`` in this process; whatever its planner raises becomes a row, not the end of the run."""
    started_s = time.monotonic()
    try:
        return checked_result(task, job.run(task))
    except RowError as error:
        return failed_trial(task, Failure("planner_error", str(error)), time.monotonic() - started_s)
    except (Exception, SystemExit) as error:  # noqa: BLE001  a planner may raise anything
        return failed_trial(task, failure_of(error), time.monotonic() - started_s)
