"""Replays for a report: as many scenarios as its size allows, those first on which planners disagree."""

from __future__ import annotations

import json
from collections.abc import Sequence
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from scenarios import Scenario
from suite.compare.conditions import telling_apart
from suite.show.replay.again import Played
from suite.show.replay.chosen import label_of_trial, run_scenarios
from suite.show.replay.data import scenario_data, trial_data
from suite.store.journal import Executed, Journal
from suite.store.run_folder import JOURNAL
from suite.trial.columns import Row

_TRIAL_BYTES, _SCENARIO_BYTES = 400, 500
"""Less than what a trial, and a scenario, usually take; what turns out too much is left out again."""


def disagreement(trials: pd.DataFrame) -> pd.Series[int]:
    """By scenario: 2 where some planners succeed (swept) and others fail, 1 where all fail, 0 where all succeed."""
    won = trials["success_swept"].fillna(False).astype(bool).groupby(trials["scenario_id"])
    return (won.any() & ~won.all()).astype(int) * 2 + (~won.any()).astype(int)


def episodes(folder: Path, trials: pd.DataFrame, budget: int) -> dict[str, dict[str, Any]]:
    """By scenario's id what a replay needs, of no more than ``budget`` bytes in all; empty where no motion was kept.

    Raises:
        SuiteError: The journal cannot be read.
    """
    if not (folder / JOURNAL).exists():
        return {}
    counts = trials.groupby("scenario_id").size()
    order = disagreement(trials).sort_values(ascending=False, kind="stable").index
    likely = (counts[order] * _TRIAL_BYTES + _SCENARIO_BYTES).cumsum()
    wanted = set(order[likely <= budget])
    apart = telling_apart(trials)
    scenarios = {each.id: each for each in run_scenarios(folder) if each.id in wanted}
    made: dict[str, dict[str, Any]] = {}
    with Journal(folder / JOURNAL, read_only=True) as journal:
        kept = journal.kept(scenarios)
        for scenario_id, group in groupby(kept, key=lambda pair: str(pair[0]["scenario_id"])):
            made[scenario_id] = _episode(scenarios[scenario_id], list(group), apart)
    sizes = pd.Series({name: len(json.dumps(made[name], separators=(",", ":"))) for name in order if name in made})
    return {name: made[name] for name in sizes.index[sizes.cumsum() <= budget]}


def _episode(scenario: Scenario, group: list[tuple[Row, Executed]], apart: Sequence[str]) -> dict[str, Any]:
    trials = [trial_data(scenario, _as_kept(scenario, row, executed, apart)) for row, executed in group]
    end_s = max((float(executed.times_s[-1]) for _, executed in group if len(executed.times_s)), default=0.0)
    return {"scenario": scenario_data(scenario, end_s), "trials": trials, "end": end_s}


def _as_kept(scenario: Scenario, row: Row, executed: Executed, apart: Sequence[str]) -> Played:
    if not len(executed.times_s):
        executed = executed._replace(times_s=np.zeros(1), configurations_rad=scenario.start[None])
    return Played(label_of_trial(row, apart), row, executed, [], "")
