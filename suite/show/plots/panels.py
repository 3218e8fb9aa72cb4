"""Panels of a figure: one per set of conditions of the world, so that unlike trials are never one mark."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import pandas as pd

from suite.compare.tables import WORLDS
from suite.errors import SuiteError
from suite.show.plots.style import COLUMN_IN, named

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MAX_PANELS = 12


def panels(
    trials: pd.DataFrame, kind: str, height_in: float, across: int = 2
) -> tuple[Figure, Iterator[tuple[Axes, pd.DataFrame]]]:
    """A figure with a titled panel per set of conditions, and the trials that belong into each.

    Raises:
        SuiteError: There would be too many, or none.
    """
    from matplotlib.figure import Figure

    groups = [group for _, group in trials.groupby(WORLDS, sort=True, dropna=False)]
    if not groups:
        raise SuiteError(f"{kind}: found no trials to draw, allowed a run with some of planners that are no bounds")
    if len(groups) > MAX_PANELS:
        raise SuiteError(f"{kind}: found {len(groups)} sets of conditions, allowed {MAX_PANELS} panels")
    varied = [name for name in WORLDS if len(trials[name].unique()) > 1]
    across = min(across, len(groups))
    down = math.ceil(len(groups) / across)
    figure = Figure(figsize=(COLUMN_IN, height_in * down + 0.3), layout="constrained")
    axes = figure.subplots(down, across, sharex=True, sharey=True, squeeze=False).ravel()
    for axis, group in zip(axes, groups, strict=False):
        first = group.iloc[0]
        axis.set_title(", ".join(named(name, first[name]) for name in varied), fontsize="small")
    for axis in axes[len(groups) :]:
        axis.set_visible(False)
    return figure, zip(axes, groups, strict=False)


def in_order(trials: pd.DataFrame, planners: Sequence[str]) -> list[str]:
    """Labels of the planners that have trials, those that were asked for first."""
    there = set(trials["planner"])
    return [label for label in dict.fromkeys([*planners, *trials["planner"]]) if label in there]


def counts(numbers: Sequence[int]) -> str:
    """``100``, or ``90 to 100``."""
    return f"{min(numbers)}" if min(numbers) == max(numbers) else f"{min(numbers)} to {max(numbers)}"
