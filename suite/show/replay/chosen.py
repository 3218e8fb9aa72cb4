"""Which trials of a run are shown, and what the run has kept of them."""

from __future__ import annotations

import difflib
import sqlite3
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import NamedTuple

import pandas as pd
from pydantic import ValidationError

from scenarios import Scenario, load_scenarios
from scenarios.spec import known_name
from suite.compare.conditions import telling_apart
from suite.errors import SuiteError
from suite.experiment.experiment import Experiment, make_experiment
from suite.store.journal import Executed, Journal
from suite.store.run_folder import JOURNAL, planner_order, read_manifest, read_trials
from suite.trial.columns import Row, complete_row

MAX_SHOWN = 6
"""Trials side by side; more cannot be told apart."""


class Trial(NamedTuple):
    """A trial of a run."""

    row: Row
    executed: Executed | None
    """None where the run kept its rows only."""
    label: str
    """The planner, with the conditions that tell its trials apart where it has several."""


class Chosen(NamedTuple):
    """A scenario and trials on it."""

    scenario: Scenario
    trials: list[Trial]
    left_out: list[str]
    """Planners of which no trial is shown for lack of room."""
    why: str
    """Why these, where nobody asked for the scenario."""


def choose(folder: Path, scenario_id: str | None, planners: Sequence[str]) -> Chosen:
    """Find the trials of one scenario: all planners' unless some are named.

    Args:
        folder: The run's.
        scenario_id: The first that somebody failed on when None: touching an obstacle comes before being late.
        planners: Labels, in the order in which they are to be shown.

    Raises:
        SuiteError, SpecError: There is no such run, scenario or planner; one line.
    """
    frame = read_trials(folder)
    if frame is None or frame.empty:
        raise SuiteError(f"{folder}: found no trials, allowed: the folder of a run, or a scenario file")
    labels = list(dict.fromkeys([*planner_order(folder), *frame["planner"]]))
    labels = [label for label in labels if label in set(frame["planner"])]
    for planner in planners:
        known_name("--planner", planner, labels)
    wanted = list(planners) or labels
    why = ""
    if scenario_id is None:
        scenario_id, wanted, why = _first_failure(frame[frame["planner"].isin(wanted)], wanted)
    rows = frame[frame["scenario_id"] == scenario_id]
    if rows.empty:
        names = list(dict.fromkeys(map(str, frame["scenario_id"])))
        near = difflib.get_close_matches(scenario_id[:100], names, 1) or names[:1]
        raise SuiteError(
            f"--scenario: found {scenario_id!r}, allowed one of the {len(names)} of {folder}; nearest: {near[0]}"
        )
    apart = telling_apart(rows)
    kept = [Trial(row, executed, label_of_trial(row, apart)) for row, executed in _kept(folder, rows, scenario_id)]
    kept = [trial for trial in kept if trial.row["planner"] in wanted]
    trials = sorted(kept, key=lambda trial: wanted.index(trial.row["planner"]))
    if not trials:
        raise SuiteError(
            f"--planner: found no trial of {', '.join(wanted)} on {scenario_id}, allowed one that ran on it"
        )
    shown, rest = trials[:MAX_SHOWN], trials[MAX_SHOWN:]
    scenario = scenario_of(folder, scenario_id, str(shown[0].row["scenario_hash"]))
    return Chosen(scenario, shown, [trial.label for trial in rest], why)


def scenario_of(folder: Path, scenario_id: str, content_hash: str) -> Scenario:
    """The scenario that the run kept, or drawn again where it kept none.

    Raises:
        SuiteError: There is none of that name and content.
    """
    file = folder / "scenarios.jsonl"
    found: Scenario | None = None
    if file.is_file():
        with file.open(encoding="utf-8") as lines:
            # One line among a hundred thousand; only those that can be the one are read as scenarios.
            for line in lines:
                if f'"{scenario_id}"' in line:
                    try:
                        candidate = Scenario.model_validate_json(line)
                    except ValidationError:
                        raise SuiteError(f"{file}: found a line that is no scenario") from None
                    found = candidate if candidate.id == scenario_id else found
    elif (experiment := experiment_of(folder)) is not None:
        found = next((each for each in experiment.scenarios() if each.id == scenario_id), None)
    if found is None or found.content_hash != content_hash:
        raise SuiteError(f"{folder}: found no scenario {scenario_id} as its trials had it, allowed: a run that kept it")
    return found


def run_scenarios(folder: Path) -> Iterable[Scenario]:
    """All scenarios that the run kept, or drawn again; none where neither can be done."""
    if (folder / "scenarios.jsonl").is_file():
        return load_scenarios(folder / "scenarios.jsonl")
    experiment = experiment_of(folder)
    return () if experiment is None else experiment.scenarios()


def experiment_of(folder: Path, planners: Sequence[str] | None = None) -> Experiment | None:
    """What was asked for in the run, with some of its planners alone; None where its manifest can't say."""
    fields = (read_manifest(folder) or {}).get("experiment")
    if fields is None:
        return None
    try:
        return make_experiment(**fields | ({} if planners is None else {"planners": tuple(planners)}))
    except (ValueError, TypeError):  # written by another version, or by hand
        return None


def _first_failure(frame: pd.DataFrame, wanted: list[str]) -> tuple[str, list[str], str]:
    """Scenario, the planner that failed with one that did not, and words that say so."""
    failed = frame[~frame["success_swept"].fillna(False).astype(bool) & ~frame["is_bound"].fillna(False).astype(bool)]
    touched = failed[failed["violation_swept_kind"] == "collision"]
    of_all = touched if len(touched) else failed if len(failed) else frame
    first = of_all.iloc[0]
    scenario_id, planner = str(first["scenario_id"]), str(first["planner"])
    if not len(failed):
        return scenario_id, wanted, f"the first scenario, {scenario_id}; nobody failed"
    there = frame[frame["success_swept"].fillna(False).astype(bool) & (frame["scenario_id"] == scenario_id)]
    others = [label for label in wanted if label != planner and label in set(there["planner"])][:1]
    beside = f"; beside it {others[0]}, which succeeded" if others else ""
    return scenario_id, [planner, *others], f"the first trial that failed, {planner} on {scenario_id}{beside}"


def _kept(folder: Path, rows: pd.DataFrame, scenario_id: str) -> Sequence[tuple[Row, Executed | None]]:
    if not (folder / JOURNAL).exists():
        plain = rows.astype(object).where(rows.notna(), None)
        named = ({str(name): value for name, value in row.items()} for row in plain.to_dict("records"))
        return [(complete_row(row), None) for row in named]
    try:
        with Journal(folder / JOURNAL, read_only=True) as journal:
            return list(journal.kept({scenario_id}))
    except (OSError, sqlite3.Error) as error:
        raise SuiteError(f"{folder / JOURNAL}: cannot be read: {error}"[:300]) from None


def label_of_trial(row: Row, apart: Sequence[str]) -> str:
    """The planner, with the conditions ``apart`` that tell its trials on one scenario from one another."""
    return ", ".join([str(row["planner"]), *(f"{name.replace('_', ' ')} {row[name]}" for name in apart)])
