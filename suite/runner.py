"""A run from start to end: scenarios, folder, workers, journal, tables."""

from __future__ import annotations

import os
from collections.abc import Sequence
from functools import partial
from pathlib import Path

import pandas as pd

from planners import PlannerSpec, check_fit
from suite.backends.local import Job, run_tasks
from suite.backends.warm_up import warm_up_trials
from suite.experiment.experiment import Experiment
from suite.experiment.manifest import make_manifest
from suite.progress import note, progress
from suite.show.derived import write_derived
from suite.store.journal import Journal
from suite.store.run_folder import open_run
from suite.trial.episode import run_trial
from suite.trial.task import TrialTask

DEFAULT_HANG_LIMIT_S = 300.0


class RunInterrupted(Exception):
    """The run was stopped from outside; what had finished is saved."""

    def __init__(self, finished: int, total: int) -> None:
        super().__init__(f"{finished} of {total} trials are saved")


def run_experiment(
    experiment: Experiment,
    folder: Path,
    *,
    workers: int,
    hang_limit_s: float = DEFAULT_HANG_LIMIT_S,
    fresh: bool = False,
    keep_stale: bool = False,
) -> pd.DataFrame:
    """Run what is left of an experiment and write its files.

    Args:
        experiment: What to run.
        folder: Where the run lives; one that is there goes on, and grows by what is new.
        workers: Number of worker processes.
        hang_limit_s: A trial that takes longer is killed and recorded as ``planner_hung`` [s].
        fresh: Start over, whatever an earlier run has left in the folder.
        keep_stale: Use rows that other code has made as they are.

    Returns:
        The summary, one row per number of obstacles, conditions and planner.

    Raises:
        SuiteError, ScenarioError: The experiment cannot be run like this; found before anything is written.
        RunInterrupted: Stopped by the user; the next call goes on from there.
    """
    scenarios = experiment.scenarios()
    for arm in {scenario.arm for scenario in scenarios}:
        check_fit(experiment.specs(), arm)
    tasks = list(experiment.tasks(scenarios))
    manifest = make_manifest(experiment, scenarios)
    with open_run(folder, manifest, tasks, fresh=fresh, keep_stale=keep_stale) as (journal, standing):
        for line in standing.notes():
            note(line)
        finished = journal.finished()
        left = [task for task in tasks if task.key not in finished]
        try:
            if left:
                _run(left, experiment.specs(), journal, workers, hang_limit_s)
            return write_derived(folder, journal, scenarios, experiment.codes())
        except KeyboardInterrupt:
            raise RunInterrupted(len(journal.finished()), len(tasks)) from None


def _run(
    tasks: Sequence[TrialTask], specs: Sequence[PlannerSpec], journal: Journal, workers: int, hang_limit_s: float
) -> None:
    """Run every task and store each result as it comes."""
    examples = {task.scenario.arm: task.scenario for task in tasks}
    prepare = partial(warm_up_trials, specs, list(examples.values()))
    for library in ("OMP", "OPENBLAS", "MKL"):
        # Workers inherit this; threads of theirs would fight over the cores and disturb the timings.
        os.environ.setdefault(f"{library}_NUM_THREADS", "1")
    with progress(len(tasks)) as advance:
        prepare()  # compiled and enumerated here, once, so that workers only have to load it
        for task, result in run_tasks(Job(run_trial, prepare, hang_limit_s), tasks, workers):
            journal.add(task, result)
            advance(task.spec.label)
