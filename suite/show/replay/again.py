"""A trial played again, to see what its planner believed and answered at every step.

A seed gives the same rows on any machine, so nothing of this needs to be kept in the run; where what comes out differs
from what was kept, it is not shown.
"""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path
from typing import NamedTuple

import numpy as np

from planners import label_of
from planners.spec import is_outside, read_spec
from scenarios import Scenario
from scenarios.arm import FloatArray
from suite.show.replay.chosen import Trial, experiment_of
from suite.store.journal import Executed
from suite.trial.columns import CONDITIONS, Row, trial_key
from suite.trial.episode import run_trial
from suite.trial.look import Look
from suite.trial.task import TrialTask

PLAYABLE = frozenset({"reached", "collided", "timeout", "stuck"})
"""Outcomes of trials whose planner did not fail as a program."""
_SAME_RAD = 1e-9


class Played(NamedTuple):
    """What there is to see of a trial."""

    label: str
    row: Row
    executed: Executed
    looks: list[Look]
    """One a step; empty where the trial could not be played again."""
    remark: str
    """What a viewer has to know of how this was come by; empty where all is as it was kept."""


def play(folder: Path, scenario: Scenario, trial: Trial, trusted: Collection[str] = ()) -> Played:
    """Play a trial again if that is possible and safe.

    Args:
        folder: The run's.
        scenario: What the trial ran on.
        trial: What was kept of it.
        trusted: Labels of planners that may be run though they are not the house's: their code is whatever a file
            holds that the run names.
    """
    row, kept = trial.row, trial.executed
    task, hindrance = _task(folder, scenario, row, trusted)
    if task is None:
        nothing = _executed(row, np.zeros(1), scenario.start[None])
        remark = f"What the planner answered is not shown: {hindrance}."
        has_motion = kept is not None and len(kept.times_s) > 0
        return Played(trial.label, row, kept if kept is not None and has_motion else nothing, [], remark)
    looks: list[Look] = []
    result = run_trial(task, looks.append)
    again = _executed(row, result.times_s, result.configurations_rad)
    if kept is None:
        same = all(result.row[name] == row[name] for name in ("outcome", "n_solves", "state_checks"))
        remark = f"Played again: the run keeps rows only{'' if same else ', and came out otherwise'}."
        return Played(trial.label, row if same else result.row, again, looks, remark)
    if not _is_same(kept, again):
        remark = "What the planner answered is not shown: played again, the trial went otherwise."
        return Played(trial.label, row, kept, [], remark)
    return Played(trial.label, row, kept, looks, "")


def _task(folder: Path, scenario: Scenario, row: Row, trusted: Collection[str]) -> tuple[TrialTask | None, str]:
    """The task that makes ``row``, or why there is none to be had."""
    if row["outcome"] not in PLAYABLE:
        return None, f"the trial ended as {row['outcome']}"
    fields = experiment_of(folder)
    if fields is None:
        return None, "the run does not say what was asked for"
    texts = [text for text in fields.planners if label_of(text) == row["planner"]]
    if any(is_outside(read_spec(text).name) for text in texts) and row["planner"] not in trusted:
        return None, "it is no planner of the house, and runs again only when --planner names it"
    experiment = experiment_of(folder, texts) if texts else None
    tasks = [] if experiment is None else [t for t in experiment.tasks([scenario]) if t.key == trial_key(row)]
    return (tasks[0], "") if tasks else (None, "the planner or its settings have changed since")


def _executed(row: Row, times_s: FloatArray, configurations_rad: FloatArray) -> Executed:
    conditions = {column.name: row[column.name] for column in CONDITIONS}
    return Executed(row["scenario_id"], row["planner"], times_s, configurations_rad, conditions)


def _is_same(kept: Executed, again: Executed) -> bool:
    return (
        kept.configurations_rad.shape == again.configurations_rad.shape
        and bool(np.array_equal(kept.times_s, again.times_s))
        and bool(np.abs(kept.configurations_rad - again.configurations_rad).max(initial=0.0) <= _SAME_RAD)
    )
