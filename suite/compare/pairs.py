"""Planners compared in pairs, on the scenarios that both were tried on."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import pandas as pd

from planners import is_bound
from suite.compare.statistics import holm, mcnemar_p
from suite.errors import SuiteError


class Pair(NamedTuple):
    """A planner against the reference, for one family and number of obstacles."""

    family: str
    n_obstacles: int
    planner: str
    reference: str
    scenarios: int
    """Scenarios that both were tried on."""
    only_planner: int
    """Scenarios on which only the planner succeeded."""
    only_reference: int
    p_mcnemar: float
    """Two-sided exact McNemar test."""
    p_holm: float
    """The same, corrected for the number of pairs in the table."""


def compare_in_pairs(trials: pd.DataFrame, reference: str, verdict: str = "per_step") -> pd.DataFrame:
    """Test every planner against ``reference``, but for bounds, which do not compete.

    Args:
        trials: Frame of trial rows.
        reference: Label of the planner that the others are compared with.
        verdict: Which success is compared.

    Returns:
        One row per ``Pair``.

    Raises:
        SuiteError: The reference is not among the planners.
    """
    labels = list(dict.fromkeys(trials["planner"]))
    if reference not in labels:
        raise SuiteError(f"reference: found {reference!r}, allowed: {', '.join(labels)}")
    pairs = list(_pairs(trials, reference, f"success_{verdict}"))
    adjusted = holm([pair.p_mcnemar for pair in pairs])
    rows = [pair._replace(p_holm=p) for pair, p in zip(pairs, adjusted, strict=True)]
    return pd.DataFrame(rows, columns=list(Pair._fields))


def _pairs(trials: pd.DataFrame, reference: str, success: str) -> Iterator[Pair]:
    judged = trials.dropna(subset=[success])
    for _, group in judged.groupby(["family", "n_obstacles"]):
        family, n_obstacles = str(group["family"].iloc[0]), int(group["n_obstacles"].iloc[0])
        won = group.pivot_table(index="scenario_hash", columns="planner", values=success, aggfunc="first")
        for label in won.columns.drop(reference) if reference in won else ():
            if is_bound(label):
                continue
            both = won[[label, reference]].dropna().astype(bool)
            only_planner = int((both[label] & ~both[reference]).sum())
            only_reference = int((both[reference] & ~both[label]).sum())
            p = mcnemar_p(only_planner, only_reference)
            yield Pair(family, n_obstacles, label, reference, len(both), only_planner, only_reference, p, p)
