"""The comparison: trials summed up per number of obstacles, conditions and planner.

Failures stay in: success rates and planning times are over all trials. How long, how far and how smooth a motion was
can only be said of motions that reached the goal; those columns are medians over them, and their number is a column.
Trials under unlike conditions are never summed up together.

A bound (a planner that knows the true motion) shows what is possible. It stands below the others, and every success is
also given as a share of its own, over the scenarios that both were tried on. Beside it stands how many of a planner's
scenarios are possible: solved by somebody, or at most those that are not proven impossible.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd

from planners import is_bound
from suite.auditor.verdicts import VERDICTS
from suite.compare.possible import IMPOSSIBLE, OPEN, YES, numbered, possible
from suite.compare.statistics import wilson_interval
from suite.store.frames import TABLE_TYPES
from suite.trial.columns import OWN, WORLD
from suite.trial.task import Code

ERRORS = ("planner_error", "planner_hung", "worker_lost", "invalid_scenario")
"""Outcomes that say something about the software rather than about the method."""

WORLDS = ["family", "n_obstacles", *(column.name for column in WORLD)]
"""Planners are only compared where all of these are the same."""

ENTRANT = ["planner", *(column.name for column in OWN)]
"""What one row of a table is about, in its world."""

SUMMED_UP = (
    *WORLDS,
    *ENTRANT,
    "scenario_id",
    "scenario_hash",
    "house_code",
    "planner_code",
    "is_bound",
    "outcome",
    *(f"success_{verdict}" for verdict in VERDICTS),
    "impossible_reason",
    "planning_time_s",
    "solve_p50_s",
    "arrival_time_s",
    "tip_path_length_m",
    "smoothness_paper_rad",
)
"""Columns of trials that a table is made from."""


def summarize(
    trials: pd.DataFrame, planners: Sequence[str] = (), present: Mapping[str, Code] | None = None
) -> pd.DataFrame:
    """One row per family, number of obstacles, conditions and planner.

    Args:
        trials: Frame of trial rows.
        planners: Labels in the order in which they are to appear; others follow by name.
        present: The code that would run each planner now; rows that other code has made are counted as stale.
    """
    order = {label: position for position, label in enumerate(planners)}
    rows: list[dict[str, Any]] = []
    numbers = numbered(trials)
    for world, among in trials.assign(scenario=numbers, possible=possible(trials, numbers)).groupby(
        WORLDS, sort=False, dropna=False
    ):
        bounds = among[are_bounds(among)]
        for entrant, group in among.groupby(ENTRANT, sort=False, dropna=False):
            named = dict(zip(WORLDS + ENTRANT, (*world, *entrant), strict=True))
            counts = group.loc[~group["scenario"].duplicated(), "possible"].value_counts()
            known = {
                "possible": counts.get(YES, 0),
                "open": counts.get(OPEN, 0),
                "impossible": counts.get(IMPOSSIBLE, 0),
            }
            named |= {f"scenarios_{name}": count for name, count in known.items()}
            rows.append(named | _summary(group, bounds) | {"stale": _stale(group, present or {})})
    summary = pd.DataFrame(rows)[list(TABLE_TYPES)].astype(TABLE_TYPES)
    position = summary["planner"].map(lambda label: order.get(label, len(order)))
    by = [*WORLDS, "is_bound", "position", *ENTRANT]
    return summary.assign(position=position).sort_values(by, ignore_index=True).drop(columns="position")


def are_bounds(trials: pd.DataFrame) -> pd.Series[bool]:
    """Which trials are of bounds; the planner's name says so for rows from before that was noted."""
    by_name = trials["planner"].map(is_bound).astype("boolean")
    return trials["is_bound"].astype("boolean").fillna(by_name).astype(bool)


def _summary(group: pd.DataFrame, bounds: pd.DataFrame) -> dict[str, object]:
    reached = group[group["outcome"] == "reached"]
    summary: dict[str, object] = {"is_bound": are_bounds(group).iloc[0], "trials": len(group)}
    for verdict in VERDICTS:
        summary |= _success(group[f"success_{verdict}"], f"success_{verdict}")
    for verdict in VERDICTS:
        summary[f"success_{verdict}_of_bound_percent"] = _share(group, bounds, f"success_{verdict}")
    return summary | {
        "planning_time_mean_s": group["planning_time_s"].mean(),
        "planning_time_median_s": group["planning_time_s"].median(),
        "solve_median_s": group["solve_p50_s"].median(),
        "reached": len(reached),
        "arrival_median_s": reached["arrival_time_s"].median(),
        "tip_path_length_median_m": reached["tip_path_length_m"].median(),
        "smoothness_paper_median_rad": reached["smoothness_paper_rad"].median(),
        "errors": int(group["outcome"].isin(ERRORS).sum()),
    }


def _stale(group: pd.DataFrame, present: Mapping[str, Code]) -> int:
    code = present.get(group["planner"].iloc[0])
    if code is None:
        return 0
    return int(((group["house_code"] != code.house) | (group["planner_code"] != code.planner)).sum())


def _share(group: pd.DataFrame, bounds: pd.DataFrame, success: str) -> float:
    """Successes in percent of those shown to be possible; NaN for bounds and where none was shown.

    A share above 100 % is no error: a bound that fails proves nothing, and another planner may succeed there.
    """
    possible = bounds.dropna(subset=[success]).groupby("scenario_hash")[success].any()
    common = group[group["scenario_hash"].isin(possible.index)]
    shown = int(possible.loc[common["scenario_hash"]].sum())  # as often as it was tried, where trials are pooled
    if are_bounds(group).iloc[0] or not shown:
        return float("nan")
    return 100 * int(common[success].sum()) / shown


def _success(verdicts: pd.Series[bool], name: str) -> dict[str, float]:
    """Success rate in percent with its 95 % interval; NaN when no trial was judged."""
    judged = verdicts.dropna()
    if judged.empty:
        return {f"{name}_percent": float("nan"), f"{name}_low": float("nan"), f"{name}_high": float("nan")}
    successes = int(judged.sum())
    low, high = wilson_interval(successes, len(judged))
    return {
        f"{name}_percent": 100 * successes / len(judged),
        f"{name}_low": 100 * low,
        f"{name}_high": 100 * high,
    }
