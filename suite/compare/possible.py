"""What is possible, from both sides: solved by somebody, or proven impossible (docs/possible.md)."""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

YES, IMPOSSIBLE, OPEN = "yes", "impossible", "open"
"""Solved, executable, by somebody; proven impossible; neither."""


def numbered(trials: pd.DataFrame) -> NDArray[np.int64]:
    """A number for the scenario of every trial, equal where scenarios are, shape (len(trials),).

    They are told apart by 64 bits: to look up a hundred thousand texts takes much memory.
    """
    bits = pd.util.hash_array(trials["scenario_hash"].to_numpy(dtype=object), categorize=False)
    return pd.factorize(bits)[0]


def possible(trials: pd.DataFrame, numbers: NDArray[np.int64]) -> pd.Series[str]:
    """``yes``, ``impossible`` or ``open`` for the scenario of every trial, whose ``numbers`` are given.

    A success under any conditions counts, the noise of observations and the planner's knowledge of the future included:
    the motion is one that the arm can make. Proofs stand in the rows of bounds that failed.
    """
    solved, proven = np.zeros((2, len(trials)), bool)
    solved[numbers[trials["success_executable"].fillna(False).astype(bool)]] = True
    proven[numbers[trials["impossible_reason"].notna()]] = True
    answers = np.select([solved, proven], [YES, IMPOSSIBLE], OPEN)
    return pd.Series(answers[numbers], trials.index, dtype="category")


def scenarios_frame(trials: pd.DataFrame) -> pd.DataFrame:
    """One row per scenario: what is possible, who solved it, and why nobody can where that is proven."""
    rows = []
    for scenario_hash, group in trials.assign(possible=possible(trials, numbered(trials))).groupby(
        "scenario_hash", sort=False
    ):
        first, solved = group.iloc[0], group["success_executable"].fillna(False).astype(bool)
        proofs = group.dropna(subset=["impossible_reason"])
        rows.append(
            {
                "scenario_id": first["scenario_id"],
                "scenario_hash": scenario_hash,
                "family": first["family"],
                "n_obstacles": first["n_obstacles"],
                "possible": first["possible"],
                "impossible_reason": None if proofs.empty else proofs["impossible_reason"].iloc[0],
                "impossible_from_s": None if proofs.empty else proofs["impossible_from_s"].iloc[0],
                "solved_by": " ".join(sorted(set(group.loc[solved, "planner"]))),
                "failed_by": " ".join(sorted(set(group.loc[~solved, "planner"]) - set(group.loc[solved, "planner"]))),
            }
        )
    return pd.DataFrame(rows)
