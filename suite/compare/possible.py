"""What is possible, from both sides: solved by somebody, or proven impossible (docs/possible.md)."""

from __future__ import annotations

import pandas as pd

YES, IMPOSSIBLE, OPEN = "yes", "impossible", "open"
"""Solved, executable, by somebody; proven impossible; neither."""


def possible(trials: pd.DataFrame) -> pd.Series[str]:
    """``yes``, ``impossible`` or ``open`` for every scenario, by its hash.

    A success under any conditions counts, the noise of observations and the planner's knowledge of the future included:
    the motion is one that the arm can make. Proofs stand in the rows of bounds that failed.
    """
    by_scenario = trials.groupby("scenario_hash")
    solved = by_scenario["success_executable"].any()
    proven = trials["impossible_reason"].notna().groupby(trials["scenario_hash"]).any()
    answers = pd.Series(OPEN, solved.index, dtype="string")
    return answers.mask(proven, IMPOSSIBLE).mask(solved.astype(bool), YES)


def scenarios_frame(trials: pd.DataFrame) -> pd.DataFrame:
    """One row per scenario: what is possible, who solved it, and why nobody can where that is proven."""
    answers = possible(trials)
    rows = []
    for scenario_hash, group in trials.groupby("scenario_hash", sort=False):
        first, solved = group.iloc[0], group["success_executable"].fillna(False).astype(bool)
        proofs = group.dropna(subset=["impossible_reason"])
        rows.append(
            {
                "scenario_id": first["scenario_id"],
                "scenario_hash": scenario_hash,
                "family": first["family"],
                "n_obstacles": first["n_obstacles"],
                "possible": answers[scenario_hash],
                "impossible_reason": None if proofs.empty else proofs["impossible_reason"].iloc[0],
                "impossible_from_s": None if proofs.empty else proofs["impossible_from_s"].iloc[0],
                "solved_by": " ".join(sorted(set(group.loc[solved, "planner"]))),
                "failed_by": " ".join(sorted(set(group.loc[~solved, "planner"]) - set(group.loc[solved, "planner"]))),
            }
        )
    return pd.DataFrame(rows)
