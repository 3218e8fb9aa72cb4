"""A run from start to end: scenarios, folder, workers, journal, tables."""

from __future__ import annotations

import importlib
import sqlite3
import threading
from contextlib import closing
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from planners import check_fit
from suite.backends.job import LEAST_WARM_UP_S, Backend, Job, Limits
from suite.backends.local import InProcess
from suite.backends.processes import Processes
from suite.backends.warm_up import warm_up_parts
from suite.errors import SuiteError
from suite.experiment.experiment import Experiment
from suite.experiment.manifest import make_manifest
from suite.experiment.presets import standard_of
from suite.progress import note, progress
from suite.store.journal import Journal
from suite.store.run_folder import open_run, read_table
from suite.store.stamp import is_finished, stamp
from suite.trial.episode import run_trial
from suite.trial.lineup import Lineup, Tasks

if TYPE_CHECKING:
    import pandas as pd

USUAL_LIMITS = Limits()


class RunInterrupted(Exception):
    """The run was stopped from outside; what had finished is saved."""

    def __init__(self, finished: int, total: int) -> None:
        super().__init__(f"{finished} of {total} trials are saved")


def run_experiment(
    experiment: Experiment,
    folder: Path,
    *,
    workers: int | Backend,
    limits: Limits = USUAL_LIMITS,
    fresh: bool = False,
    keep_stale: bool = False,
    quiet: bool = False,
) -> pd.DataFrame:
    """Run what is left of an experiment and write its files.

    Args:
        experiment: What to run.
        folder: Where the run lives; one that is there goes on, and grows by what is new.
        workers: Number of worker processes, or those that were started ahead, or a cluster; 0 runs the trials in this
            process, where nobody can kill a planner that hangs.
        limits: What a trial may take in a worker process.
        fresh: Start over, whatever an earlier run has left in the folder.
        keep_stale: Use rows that other code has made as they are.
        quiet: Say nothing on the way.

    Returns:
        The summary, one row per number of obstacles, conditions and planner.

    Raises:
        SuiteError, ScenarioError: The experiment cannot be run like this; found before anything is written.
        RunInterrupted: Stopped by the user; the next call goes on from there.
    """
    asked = experiment.fingerprint()
    if not fresh and is_finished(folder, asked):
        return read_table(folder)
    scenarios = experiment.scenarios()
    for arm in scenarios.arms:
        check_fit(experiment.specs(), arm)
    tasks = Lineup(partial(experiment.tasks, scenarios), range(experiment.count(len(scenarios))))
    manifest = make_manifest(experiment, scenarios)
    standard = standard_of(experiment, scenarios.digest)
    if standard and not standard.is_met:
        note(f"scenarios {scenarios.digest} are not those of {standard.name}: another machine or suite draws otherwise")
    with open_run(folder, manifest, tasks, fresh=fresh, keep_stale=keep_stale) as (journal, standing):
        for line in [] if quiet else standing.notes():
            note(line)
        # Pandas takes as long to import as workers to load their kernels.
        threading.Thread(target=importlib.import_module, args=["suite.show.derived"], daemon=True).start()
        try:
            if standing.left:
                examples = [task for task in standing.examples.values() if not task.spec.failure]
                job = Job(
                    run_trial,
                    limits.hang_s,
                    warm_up_parts(examples),
                    max(LEAST_WARM_UP_S, limits.hang_s),
                    limits.memory_mb,
                    examples,
                )
                _run(job, tasks.at(standing.left), journal, workers, quiet=quiet)
            from suite.show.derived import write_derived

            summary = write_derived(folder, journal, scenarios, experiment.codes())
            if not standing.kept:  # a run with rows of other code asks anew each time
                stamp(folder, asked, journal)
            return summary
        except KeyboardInterrupt:
            raise RunInterrupted(len(journal.finished()), len(tasks)) from None
        except (OSError, sqlite3.Error) as error:
            reason = getattr(error, "strerror", None) or error
            raise SuiteError(
                f"{folder}: stopped: {reason}; what had finished is saved, and the same command goes on from there"
            ) from None


def _run(job: Job, tasks: Tasks, journal: Journal, workers: int | Backend, *, quiet: bool) -> None:
    """Run every task and store each result as it comes."""
    backend: Backend = InProcess() if workers == 0 else Processes(workers) if isinstance(workers, int) else workers
    with progress(len(tasks), quiet=quiet) as report, closing(backend.run(job, tasks, report.warm_up)) as finished:
        for task, result in finished:
            journal.add(task, result)
            report(task.spec.label)
