"""The comparison: trials summed up per planner and number of obstacles, and planners compared in pairs.

Failures stay in: success rates and planning times are over all trials. How long, how far and how smooth a motion was
can only be said of motions that reached the goal; those columns are medians over them, and their number is a column.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from suite.columns import VERDICTS
from suite.errors import SuiteError
from suite.statistics import holm, mcnemar_p, wilson_interval

GROUP = ["family", "n_obstacles", "planner"]

ERRORS = ("planner_error", "planner_hung", "invalid_scenario")
"""Outcomes that say something about the software rather than about the method."""

PUBLISHED_COLUMNS = ["planner", "n_obstacles", "time_s", "success_percent", "trials"]


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


def published_file(name: str) -> Path:
    """The file behind ``--against``: ``published`` is the paper's Table I, anything else a path."""
    return Path(__file__).parent.parent / "results" / "published_table1.csv" if name == "published" else Path(name)


def read_published(file: Path) -> pd.DataFrame:
    """Read results published elsewhere: columns planner, n_obstacles, time_s, success_percent, trials.

    Raises:
        SuiteError: The file cannot be read or a column is missing.
    """
    try:
        published = pd.read_csv(file)
    except (OSError, ValueError) as error:
        raise SuiteError(f"{file}: cannot be read: {error}") from None
    missing = [name for name in PUBLISHED_COLUMNS if name not in published.columns]
    if missing:
        raise SuiteError(f"{file}: found no column {missing[0]}, allowed: {', '.join(PUBLISHED_COLUMNS)}")
    return published[PUBLISHED_COLUMNS]


def beside(summary: pd.DataFrame, published: pd.DataFrame) -> pd.DataFrame:
    """Put published success and time beside ours, where planner (in any case) and number of obstacles agree."""
    theirs = published.assign(planner=published["planner"].str.lower()).rename(
        columns={name: f"published_{name}" for name in PUBLISHED_COLUMNS[2:]}
    )
    return summary.merge(theirs, how="left", on=["planner", "n_obstacles"], validate="many_to_one")


def compare_in_pairs(trials: pd.DataFrame, reference: str, verdict: str = "per_step") -> pd.DataFrame:
    """Test every planner against ``reference`` on the scenarios that both were tried on.

    Args:
        trials: Frame of trial rows.
        reference: Label of the planner that the others are compared with.
        verdict: Which success is compared.

    Returns:
        One row per family, number of obstacles and other planner, with the scenarios on which only one of the two
        succeeded, the exact McNemar p-value and the same after Holm's correction for the number of rows.

    Raises:
        SuiteError: The reference is not among the planners.
    """
    labels = list(dict.fromkeys(trials["planner"]))
    if reference not in labels:
        raise SuiteError(f"reference: found {reference!r}, allowed: {', '.join(labels)}")
    judged = trials.dropna(subset=[f"success_{verdict}"])
    rows: list[dict[str, object]] = []
    for (family, n_obstacles), group in judged.groupby(["family", "n_obstacles"]):
        won = group.pivot_table(index="scenario_hash", columns="planner", values=f"success_{verdict}", aggfunc="first")
        for label in labels:
            if label == reference or not {label, reference} <= set(won.columns):
                continue
            both = won[[label, reference]].dropna().astype(bool)
            only_this = int((both[label] & ~both[reference]).sum())
            only_reference = int((both[reference] & ~both[label]).sum())
            rows.append(
                {
                    "family": family,
                    "n_obstacles": n_obstacles,
                    "planner": label,
                    "reference": reference,
                    "scenarios": len(both),
                    "only_planner": only_this,
                    "only_reference": only_reference,
                    "p_mcnemar": mcnemar_p(only_this, only_reference),
                }
            )
    adjusted = holm([float(str(row["p_mcnemar"])) for row in rows])
    return pd.DataFrame([row | {"p_holm": p} for row, p in zip(rows, adjusted, strict=True)])
