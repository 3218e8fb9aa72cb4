"""What an experiment would run, and how long that should take; nothing is written."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from functools import partial
from pathlib import Path
from typing import NamedTuple

import pandas as pd

from planners import check_fit
from scenarios.spec import parse_spec
from suite.experiment.experiment import Experiment
from suite.experiment.manifest import make_manifest
from suite.store.growth import Standing
from suite.store.run_folder import read_trials, standing_of
from suite.trial.lineup import Lineup

DEFAULT_TRIAL_S = 2.0
"""What a trial is taken to last where the folder has none of its planner [s]: most last between 0.2 and 10 s."""


class Foresight(NamedTuple):
    """An experiment looked at before it runs."""

    trials: int
    there: int
    """Trials that are there already and would not run again."""
    notes: list[str]
    """What the run would say of rows that are there."""
    seconds: float
    """Estimated time [s]; compiling and loading are not in it."""
    guessed: int
    """Trials to run of planners that nothing is known of."""

    def lines(self, workers: int) -> list[str]:
        """For people."""
        left = self.trials - self.there
        said = [f"{self.trials} trials, {self.there} of them there already, {left} to run", *self.notes]
        if left:
            how = f"; {self.guessed} of them at {DEFAULT_TRIAL_S:g} s each for want of any" if self.guessed else ""
            known = "what trials of these planners took in this folder"
            basis = f"{known}{how}" if self.guessed < left else f"{DEFAULT_TRIAL_S:g} s a trial: none has run here yet"
            said.append(f"about {_duration(self.seconds)} with {workers} workers, from {basis}")
        return said


def foresee(experiment: Experiment, folder: Path, workers: int, *, fresh: bool, keep_stale: bool) -> Foresight:
    """Count the trials of an experiment and estimate their time.

    Raises:
        SuiteError, ScenarioError: The experiment cannot be run like this, as ``run_experiment`` would say.
    """
    scenarios = experiment.scenarios()
    for arm in scenarios.arms:
        check_fit(experiment.specs(), arm)
    tasks = Lineup(partial(experiment.tasks, scenarios), range(experiment.count(len(scenarios))))
    manifest = make_manifest(experiment, scenarios)
    standing = Standing() if fresh else standing_of(folder, manifest, tasks, keep_stale=keep_stale)
    left = Counter(task.spec.label for task in tasks)
    left.subtract(standing.done)
    took = _took(read_trials(folder), left)
    seconds = sum(count * took.get(label, DEFAULT_TRIAL_S) for label, count in left.items()) / max(1, workers)
    guessed = sum(count for label, count in left.items() if label not in took)
    return Foresight(len(tasks), standing.there, standing.notes(), seconds, guessed)


def _took(trials: pd.DataFrame | None, labels: Iterable[str]) -> Mapping[str, float]:
    """Mean wall time of a trial by planner [s]; of one that has not run here, that of the same with other settings."""
    if trials is None or trials.empty:
        return {}
    timed = trials.dropna(subset=["trial_wall_s"])
    exact = timed.groupby("planner")["trial_wall_s"].mean().to_dict()
    alike = timed.groupby(timed["planner"].map(_name))["trial_wall_s"].mean().to_dict()
    found = {label: exact.get(label, alike.get(_name(label))) for label in labels}
    return {label: seconds for label, seconds in found.items() if seconds is not None}


def _name(label: str) -> str:
    return parse_spec(label)[0]


def _duration(seconds: float) -> str:
    if seconds < 90:
        return f"{max(1.0, seconds):.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"
