"""Planners compared in pairs, on the scenarios that both were tried on, under the same conditions."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pandas as pd

from suite.compare.statistics import holm, mcnemar_p
from suite.compare.tables import ENTRANT, WORLDS, are_bounds
from suite.errors import SuiteError

PAIR_NAMES = (
    *WORLDS,
    *ENTRANT,
    "reference",
    "scenarios",  # that both were tried on
    "only_planner",  # scenarios on which only the planner succeeded
    "only_reference",
    "p_mcnemar",  # two-sided exact McNemar test
    "p_holm",  # the same, corrected for the number of pairs in the table
)
"""Columns of a comparison in pairs."""


def compare_in_pairs(trials: pd.DataFrame, reference: str, verdict: str = "swept") -> pd.DataFrame:
    """Test every planner against ``reference``, but for bounds, which do not compete.

    Args:
        trials: Frame of trial rows.
        reference: Label of the planner that the others are compared with. Where it ran with several predictors, each
            planner meets it with its own.
        verdict: Which success is compared.

    Returns:
        One row per pair, with the columns ``PAIR_NAMES``.

    Raises:
        SuiteError: The reference is not among the planners.
    """
    labels = list(dict.fromkeys(trials["planner"]))
    if reference not in labels:
        raise SuiteError(f"reference: found {reference!r}, allowed: {', '.join(labels)}")
    pairs = pd.DataFrame(list(_pairs(trials, reference, f"success_{verdict}")), columns=list(PAIR_NAMES))
    return pairs.assign(p_holm=holm(pairs["p_mcnemar"].tolist()))


def _pairs(trials: pd.DataFrame, reference: str, success: str) -> Iterator[dict[str, Any]]:
    judged = trials.dropna(subset=[success])
    for world, among in judged.groupby(WORLDS, dropna=False):
        groups = list(among.groupby(ENTRANT, dropna=False))
        won: dict[Any, pd.Series[bool]] = {
            entrant: group.groupby("scenario_hash")[success].first().astype(bool) for entrant, group in groups
        }
        bounds = {entrant for entrant, group in groups if are_bounds(group).iloc[0]}
        references = [entrant for entrant in won if entrant[0] == reference]
        for entrant, wins in won.items():
            if entrant[0] == reference or entrant in bounds:
                continue
            for theirs in references if len(references) == 1 else _alike(references, entrant):
                both = pd.concat({"planner": wins, "reference": won[theirs]}, axis=1, join="inner")
                only_planner = int((both["planner"] & ~both["reference"]).sum())
                only_reference = int((both["reference"] & ~both["planner"]).sum())
                named = dict(zip(WORLDS + ENTRANT, (*world, *entrant), strict=True))
                yield named | {
                    "reference": reference,
                    "scenarios": len(both),
                    "only_planner": only_planner,
                    "only_reference": only_reference,
                    "p_mcnemar": mcnemar_p(only_planner, only_reference),
                }


def _alike(references: list[tuple[Any, ...]], entrant: tuple[Any, ...]) -> list[tuple[Any, ...]]:
    """Those that had the same predictor."""
    predictor = ENTRANT.index("predictor")
    return [reference for reference in references if str(reference[predictor]) == str(entrant[predictor])]
