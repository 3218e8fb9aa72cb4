"""Success over a condition: which trials make a point, which points a line, which lines a panel.

Trials under unlike conditions are never one point. A condition that goes with the one on the axis (two settings of a
family that were changed together) needs no panel of its own: at one place on the axis it has one value.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from scenarios.spec import known_name
from suite.auditor.verdicts import VERDICTS
from suite.compare.conditions import Pooled, known_conditions, line_of, pool, values_of, varying_world
from suite.compare.statistics import wilson_interval
from suite.errors import SuiteError
from suite.trial.columns import OWN


class Point(NamedTuple):
    """Success of one planner at one place on the axis."""

    at: Any
    """Value of the condition; None where the planner has no such setting."""
    trials: int
    percent: float
    low: float
    """Ends of the 95 % Wilson interval [%]."""
    high: float
    planning_s: float
    """Median of the trials' planning times [s]."""
    checks: float
    """Median of the states and motions checked in a trial."""


class Line(NamedTuple):
    """One planner, under one set of conditions of its own."""

    planner: str
    points: list[Point]
    """In the order of the axis; one without a place on it where the condition does not apply to the planner."""


class Panel(NamedTuple):
    """Lines under the same conditions of the world."""

    conditions: Mapping[str, Any]
    lines: list[Line]


class Curves(NamedTuple):
    """Everything a figure of curves shows."""

    over: str
    verdict: str
    panels: list[Panel]
    pooled: Pooled
    beside: list[str]
    """Conditions that change along with the one on the axis."""


def curves(
    trials: pd.DataFrame,
    over: str | None = None,
    verdict: str = "swept",
    by: Sequence[str] | None = None,
    planners: Sequence[str] = (),
) -> Curves:
    """Success over a condition.

    Args:
        trials: Frame of trial rows.
        over: The condition on the axis; the one with most values when None.
        verdict: Which success.
        by: Conditions that get panels of their own, all others being pooled; every one that varies, and nothing pooled,
            when None.
        planners: Labels in the order in which lines are to appear.

    Raises:
        SpecError: No trial has such a condition.
        SuiteError: Nothing is swept, or no trial was judged under the verdict.
    """
    known_name("verdict", verdict, VERDICTS)
    name = over or swept(trials)
    known_name("over", name, known_conditions(trials))
    success = f"success_{verdict}"
    judged = trials.dropna(subset=[success])
    if judged.empty:
        raise SuiteError(f"verdict: found no trial judged under {verdict}")
    pooled = pool(judged, [name, *by]) if by is not None else Pooled(judged, {})
    lines = judged["planner"].map(lambda label: line_of(label, name))
    frame = pd.DataFrame({"line": lines, "at": values_of(judged, name)})
    worlds = [each for each in varying_world(judged) if each != name and (by is None or each in by)]
    for world in worlds:
        frame[f"world {world}"] = values_of(judged, world)
    panel_by = [world for world in worlds if _varies(frame, ["at"], f"world {world}")]
    own = [] if by is not None else [column.name for column in OWN if column.name != "settings"]
    for column in own:
        frame[f"own {column}"] = judged[column]
    told = [column for column in own if _varies(frame, ["line", "at"], f"own {column}")]
    for column in told:
        frame["line"] = frame["line"] + ", " + frame[f"own {column}"].astype(str)
    frame = frame.join(judged[[success, "planning_time_s", "state_checks", "motion_checks"]])
    order = {line_of(label, name): position for position, label in reversed(list(enumerate(planners)))}
    frame["rank"] = lines.map(lambda line: order.get(line, len(order)))
    keys = [f"world {world}" for world in panel_by]
    groups: Iterable[Any] = frame.groupby(keys, dropna=False, sort=True) if keys else [((), frame)]
    panels = [Panel(dict(zip(panel_by, values, strict=True)), list(_lines(panel, success))) for values, panel in groups]
    return Curves(name, verdict, panels, pooled, [world for world in worlds if world not in panel_by])


def swept(trials: pd.DataFrame) -> str:
    """The condition with most values; of several the one in which numbers of obstacles or observations differ.

    Raises:
        SuiteError: All trials are under the same conditions.
    """
    names = dict.fromkeys([*varying_world(trials), *_varying_settings(trials)])
    counts = {name: values_of(trials, name).nunique() for name in names}
    counts = {name: count for name, count in counts.items() if count > 1 and name != "family"} or counts
    if not counts:
        raise SuiteError("over: found no condition in which trials differ, allowed a run that sweeps one")
    return max(counts, key=lambda name: counts[name])


def _varying_settings(trials: pd.DataFrame) -> list[str]:
    """Settings, and budgets, that planners' labels name."""
    labels = trials["planner"].unique()
    return [name for name in known_conditions(trials) if any(line_of(label, name) != label for label in labels)]


def _varies(frame: pd.DataFrame, at: list[str], name: str) -> bool:
    values = frame.groupby(at, dropna=False)[name].nunique(dropna=False)
    return bool(values.max() > 1)


def _lines(panel: pd.DataFrame, success: str) -> Iterator[Line]:
    for (_, label), line in panel.groupby(["rank", "line"], sort=True):
        groups = line.groupby("at", dropna=False, sort=True)
        yield Line(str(label), [_point(at, group, success) for at, group in groups])


def _point(at: Any, group: pd.DataFrame, success: str) -> Point:
    successes, trials = int(group[success].sum()), len(group)
    low, high = wilson_interval(successes, trials)
    checks = (group["state_checks"].fillna(0) + group["motion_checks"].fillna(0)).median()
    return Point(
        None if pd.isna(at) else at.item() if isinstance(at, np.generic) else at,  # a plain number, or a name
        trials,
        100 * successes / trials,
        100 * low,
        100 * high,
        float(group["planning_time_s"].median()),
        float(checks),
    )
