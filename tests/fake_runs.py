"""Whole runs with ``behave`` in place of the episode."""

import os
import signal
from pathlib import Path
from unittest.mock import patch

from fakes import behave, prepare_nothing

import suite.runner
from suite.experiment.experiment import make_experiment
from suite.store.journal import Journal
from suite.trial.task import TrialResult, TrialTask


def run_with_fakes(folder: Path, *, die_after: int | None = None, fresh: bool = False) -> None:
    """Sixteen trials; takes its own process down after ``die_after`` of them."""
    experiment = make_experiment(planners=("pf", "rrt"), obstacles=(0, 1), trials=4, seed=5)
    finished = iter(range(1, 1000))

    def add(journal: Journal, task: TrialTask, result: TrialResult) -> None:
        really_add(journal, task, result)
        if next(finished) == die_after:
            os.kill(os.getpid(), signal.SIGKILL)

    really_add = Journal.add
    with (
        patch("suite.experiment.manifest.source_hash", return_value="0" * 16),  # sources may be edited while tests run
        patch.object(suite.runner, "run_trial", behave),
        patch.object(suite.runner, "warm_up_parts", prepare_nothing),
        patch.object(Journal, "add", add),
    ):
        suite.runner.run_experiment(experiment, folder, workers=2, fresh=fresh)
