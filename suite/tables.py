"""The comparison: trials summed up per number of obstacles and planner.

Failures stay in: success rates and planning times are over all trials. How long, how far and how smooth a motion was
can only be said of motions that reached the goal; those columns are medians over them, and their number is a column.
"""

from __future__ import annotations

from collections.abc import Sequence

import pandas as pd

from suite.columns import VERDICTS
from suite.statistics import wilson_interval

GROUP = ["family", "n_obstacles", "planner"]

ERRORS = ("planner_error", "planner_hung", "invalid_scenario")
"""Outcomes that say something about the software rather than about the method."""


def summarize(trials: pd.DataFrame, planners: Sequence[str] = ()) -> pd.DataFrame:
    """One row per family, number of obstacles and planner.

    Args:
        trials: Frame of trial rows.
        planners: Labels in the order in which they are to appear; others follow by name.
    """
    order = {label: position for position, label in enumerate(planners)}
    rows = [dict(zip(GROUP, key, strict=True)) | _summary(group) for key, group in trials.groupby(GROUP, sort=False)]
    rows.sort(
        key=lambda row: (*(row[name] for name in GROUP[:2]), order.get(str(row["planner"]), len(order)), row["planner"])
    )
    return pd.DataFrame(rows)


def _summary(group: pd.DataFrame) -> dict[str, object]:
    reached = group[group["outcome"] == "reached"]
    summary: dict[str, object] = {"trials": len(group)}
    for verdict in VERDICTS:
        summary |= _success(group[f"success_{verdict}"], f"success_{verdict}")
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
