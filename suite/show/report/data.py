"""What a report needs of a run's rows: everything that is counted is counted here, the page only draws."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd

from suite.auditor.verdicts import VERDICTS
from suite.compare.curves import curves, swept
from suite.compare.pairs import compare_in_pairs
from suite.compare.tables import ENTRANT, WORLDS
from suite.errors import SuiteError
from suite.show.conditions import column, varying
from suite.show.plots.style import axis_label, named
from suite.trial.columns import WORLD

QUANTILES = 100
"""Points of a curve of planning times, at most."""
MAX_PAIRED = 12
"""Planners of which every pair is tested."""
_WORLD_NAMES = {condition.name for condition in WORLD}


def plain(value: Any) -> Any:
    """A value as JSON can hold it; None for what is missing or not finite."""
    if value is None or value is pd.NA or value != value:
        return None
    value = value.item() if hasattr(value, "item") else value
    return None if isinstance(value, float) and not np.isfinite(value) else value


def entries(summary: pd.DataFrame) -> list[dict[str, Any]]:
    """One entry per row of the table: where it belongs, in words, and its numbers."""
    varied = varying(summary)
    world = [column(summary, name) for name in varied if name in _WORLD_NAMES]
    own = [column(summary, name) for name in varied if name not in _WORLD_NAMES]
    families = len(set(summary["family"])) > 1
    return [_entry(row, world, own, families) for row in summary.itertuples(index=False)]


def _entry(row: Any, world: list[Any], own: list[Any], families: bool) -> dict[str, Any]:
    place = [str(row.family)] if families else []
    place += [_obstacles(row.n_obstacles)]
    place += [f"{title} {cell(row)}" for title, cell in world]
    said = {
        "planner": row.planner,
        "label": ", ".join([row.planner, *(f"{title} {cell(row)}" for title, cell in own)]),
        "place": ", ".join(place),
        "bound": bool(row.is_bound),
        "n": row.trials,
        "stale": row.stale,
        "errors": row.errors,
        "success": {
            verdict: [plain(getattr(row, f"success_{verdict}_{part}")) for part in ("percent", "low", "high")]
            for verdict in VERDICTS
        },
        "scenarios": [getattr(row, f"scenarios_{answer}") for answer in ("possible", "open", "impossible")],
        "planning_mean": row.planning_time_mean_s,
        "planning_median": row.planning_time_median_s,
        "solve": row.solve_median_s,
        "arrival": row.arrival_median_s,
        "tip_path": row.tip_path_length_median_m,
        "smoothness": row.smoothness_paper_median_rad,
    }
    return {
        name: [plain(each) for each in value]
        if isinstance(value, list)
        else value
        if isinstance(value, dict)
        else plain(value)
        for name, value in said.items()
    }


def _obstacles(n: Any) -> str:
    return f"{n} obstacle{'s' if n != 1 else ''}"


def entry_of(trials: pd.DataFrame, summary: pd.DataFrame) -> list[int]:
    """To which row of the table each trial belongs."""
    names = [*WORLDS, *ENTRANT]
    places = {key: k for k, key in enumerate(map(_key, summary[names].itertuples(index=False)))}
    return [places[_key(row)] for row in trials[names].itertuples(index=False)]


def _key(row: Any) -> tuple[str, ...]:
    return tuple(f"{value:.9g}" if isinstance(value, float) else str(value) for value in row)


def all_curves(trials: pd.DataFrame, planners: Sequence[str]) -> list[dict[str, Any]]:
    """Success over each condition worth an axis, by verdict."""
    try:
        overs = [swept(trials)]
    except SuiteError:  # nothing varies
        return []
    if len(trials["n_obstacles"].unique()) > 1:
        overs = list(dict.fromkeys(["n_obstacles", *overs]))
    return [_curves(trials, over, planners) for over in overs]


def _curves(trials: pd.DataFrame, over: str, planners: Sequence[str]) -> dict[str, Any]:
    judged = [verdict for verdict in VERDICTS if trials[f"success_{verdict}"].notna().any()]
    found = {verdict: curves(trials, over, verdict, None, planners) for verdict in judged}
    return {
        "over": axis_label(over),
        "panels": {
            verdict: [
                {
                    "title": ", ".join(named(*condition) for condition in panel.conditions.items()),
                    "lines": [
                        {
                            "planner": line.planner,
                            "points": [[plain(p.at), p.percent, p.low, p.high, p.trials] for p in line.points],
                        }
                        for line in panel.lines
                    ],
                }
                for panel in each.panels
            ]
            for verdict, each in found.items()
        },
    }


def times(trials: pd.DataFrame, planners: Sequence[str]) -> list[dict[str, Any]]:
    """Planning times of all trials, failures too, as quantiles by planner [s]."""
    shares = np.linspace(0.0, 1.0, QUANTILES + 1)
    said = []
    for planner in planners:
        spent = trials.loc[trials["planner"] == planner, "planning_time_s"].dropna().to_numpy(dtype=float)
        if len(spent):
            at = np.quantile(spent, shares, method="inverted_cdf")
            said.append({"planner": planner, "n": len(spent), "seconds": [float(f"{value:.4g}") for value in at]})
    return said


def failures(trials: pd.DataFrame, planners: Sequence[str]) -> list[dict[str, Any]]:
    """By planner and verdict: how many trials failed through what; and which section touched first, how."""
    said = []
    for planner in planners:
        theirs = trials[trials["planner"] == planner]
        program = theirs["outcome"].where(theirs["outcome"].isin(["planner_error", "planner_hung", "worker_lost"]))
        kinds = {}
        for verdict in VERDICTS:
            failed = ~theirs[f"success_{verdict}"].fillna(True).astype(bool)  # what was not judged is no failure
            kinds[verdict] = (
                theirs[f"violation_{verdict}_kind"].fillna(program).fillna("not said")[failed].value_counts()
            )
        touched = theirs.dropna(subset=["contact_section"])
        how = "section " + touched["contact_section"].astype(str) + ", arm " + touched["contact_while"].fillna("?")
        said.append(
            {
                "planner": planner,
                "n": len(theirs),
                "kinds": {name: {str(kind): int(n) for kind, n in each.items()} for name, each in kinds.items()},
                "touched": {str(what): int(n) for what, n in how.value_counts().items()},
            }
        )
    return said


def pairs(trials: pd.DataFrame) -> dict[str, list[dict[str, Any]]]:
    """Every pair of planners by verdict, tested as ``suite table --reference`` does."""
    competitors = list(dict.fromkeys(trials.loc[~trials["is_bound"].fillna(False).astype(bool), "planner"]))
    said: dict[str, list[dict[str, Any]]] = {verdict: [] for verdict in VERDICTS}
    if not 2 <= len(competitors) <= MAX_PAIRED:
        return said
    for verdict in VERDICTS:
        for reference in competitors:
            found = compare_in_pairs(trials, reference, verdict)
            if found.empty:
                continue
            varied = [name for name in varying(found) if name in _WORLD_NAMES]
            for row in found.itertuples(index=False):
                place = [_obstacles(row.n_obstacles), *(f"{name} {getattr(row, name)}" for name in varied)]
                said[verdict].append(
                    {
                        "place": ", ".join(place),
                        "planner": row.planner,
                        "reference": reference,
                        "scenarios": row.scenarios,
                        "only": [row.only_planner, row.only_reference],
                        "p": float(f"{row.p_holm:.3g}"),
                    }
                )
    return said


def headline(summary: pd.DataFrame, said: list[dict[str, Any]], verdict: str) -> str:
    """Who succeeds most often where, in a sentence; bounds do not compete."""
    best: dict[str, list[dict[str, Any]]] = {}
    for entry in said:
        if not entry["bound"] and entry["success"][verdict][0] is not None:
            best.setdefault(entry["place"], []).append(entry)
    parts = []
    for place, there in best.items():
        top = max(entry["success"][verdict][0] for entry in there)
        winners = [entry for entry in there if entry["success"][verdict][0] == top]
        _, low, high = winners[0]["success"][verdict]
        names = " and ".join(entry["label"] for entry in winners[:3])
        more = f" and {len(winners) - 3} more" if len(winners) > 3 else ""
        parts.append(f"{names}{more} with {place} ({top:.0f} % [{low:.0f}, {high:.0f}])")
    trials = int(summary["trials"].sum())
    shown = "; ".join(parts[:6]) + (f"; and {len(parts) - 6} conditions more" if len(parts) > 6 else "")
    planners = summary["planner"].nunique()
    return f"{planners} planners, {trials} trials. Most successes, {verdict.replace('_', ' ')}: {shown}."
