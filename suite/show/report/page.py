"""The page of a report: what ``suite report`` writes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pandas as pd

from suite.auditor.verdicts import VERDICTS
from suite.compare.tables import summarize
from suite.errors import SuiteError
from suite.show.conditions import sentence
from suite.show.page import page
from suite.show.report.data import all_curves, entries, entry_of, failures, headline, pairs, plain, times
from suite.show.report.episodes import disagreement, episodes
from suite.show.text import NOTES
from suite.store.run_folder import planner_order, present_codes, read_manifest, read_trials

MOST_BYTES = 8_000_000
"""What a report may take, replays included."""
MAX_LISTED = 20_000
"""Trials in the list of a report; of a larger run those on which planners disagree, then those that failed."""


def report_page(folder: Path, most_bytes: int = MOST_BYTES) -> str:
    """One page for the run in ``folder``.

    Raises:
        SuiteError: There are no trials, or they cannot be read.
    """
    trials = read_trials(folder)
    if trials is None or trials.empty:
        raise SuiteError(f"{folder}: found no trials, allowed: the folder of a run where they were kept")
    order = planner_order(folder)
    summary = summarize(trials, order, present_codes(read_manifest(folder)))
    planners = [label for label in dict.fromkeys([*order, *trials["planner"]]) if label in set(trials["planner"])]
    table = entries(summary)
    data: dict[str, Any] = {
        "kind": "report",
        "run": folder.name,
        "headlines": {verdict: headline(summary, table, verdict) for verdict in VERDICTS},
        "conditions": sentence(summary),
        "notes": NOTES,
        "planners": planners,
        "entries": table,
        "curves": all_curves(trials, planners),
        "times": times(trials, planners),
        "failures": failures(trials, planners),
        "pairs": pairs(trials),
        "trials": _listed(trials, summary),
        "count": len(trials),
        "episodes": {},
    }
    title = f"{folder.name}: report"
    left = most_bytes - len(page(title, data).encode())
    return page(title, data | {"episodes": episodes(folder, trials, left)})


def _listed(trials: pd.DataFrame, summary: pd.DataFrame) -> dict[str, list[Any]]:
    """Trials as columns, each with its place among those of its scenario."""
    interest = disagreement(trials)
    listed = trials.assign(
        entry=entry_of(trials, summary),
        place=trials.groupby("scenario_id").cumcount(),
        disagreed=(interest[trials["scenario_id"]] == 2).to_numpy(),
        interest=interest[trials["scenario_id"]].to_numpy(),
    )
    if len(listed) > MAX_LISTED:
        kept = listed["interest"].sort_values(ascending=False, kind="stable").index[:MAX_LISTED]
        listed = listed.loc[sorted(kept)]
    names = ["entry", "place", "disagreed", "scenario_id", "outcome", "planning_time_s", "arrival_time_s"]
    names += ["contact_obstacle", "contact_section", "contact_while"]
    names += [
        f"{part}_{verdict}{end}" for verdict in VERDICTS for part, end in (("success", ""), ("violation", "_kind"))
    ]
    names += [f"violation_{verdict}_time_s" for verdict in VERDICTS]
    return {name: [_short(value) for value in listed[name].tolist()] for name in names}


def _short(value: Any) -> Any:
    value = plain(value)
    return float(f"{value:.4g}") if isinstance(value, float) else value
