"""Success over a condition: a line per planner with 95 % Wilson intervals, a panel per other condition of the world."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import pandas as pd

from suite.compare.curves import Curves, Line, Panel, Point, curves
from suite.errors import SuiteError
from suite.show.plots.asked import Asked, Drawn
from suite.show.plots.style import COLUMN_IN, Look, axis_label, legend, look, named

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MAX_PANELS = 12
LOGARITHMIC = 50.0
"""An axis whose largest value is so many times its smallest is logarithmic."""
_ROOM = 0.07
"""Share of the axis that is left free at either end."""
_SPENT = {"checks": "states and motions checked in a trial", "time": "planning time of a trial [s]"}
_DODGE_PT = 1.2
"""Lines stand so far apart sideways [points], so that equal values and their bars can be told apart."""

Place = Callable[[Point], float | None]


def draw(trials: pd.DataFrame, planners: tuple[str, ...], asked: Asked) -> Drawn:
    """See ``suite.show.plots``."""
    from matplotlib.figure import Figure

    found = curves(trials, asked.over, asked.verdict, asked.by, planners)
    if len(found.panels) > MAX_PANELS:
        varied = ", ".join(found.panels[0].conditions)
        raise SuiteError(
            f"curve: found {len(found.panels)} combinations of {varied}, allowed {MAX_PANELS} panels: pool with --by"
        )
    names = list(dict.fromkeys(line.planner for panel in found.panels for line in panel.lines))
    looks = {name: look(position) for position, name in enumerate(names)}
    n_columns = min(2, len(found.panels))
    n_rows = math.ceil(len(found.panels) / n_columns)
    size = (COLUMN_IN, (1.3 if n_columns > 1 else 2.1) * n_rows + 0.5)
    figure = Figure(figsize=size, layout="constrained")
    axes = figure.subplots(n_rows, n_columns, sharex=asked.spent is None, sharey=True, squeeze=False).ravel()
    place = _place(found, asked)
    for axis, panel in zip(axes, found.panels, strict=False):
        _draw_panel(figure, axis, panel, looks, place)
        _scale(axis, found, asked, place)
    for axis in axes[len(found.panels) :]:
        axis.set_visible(False)
    label = _SPENT[asked.spent] if asked.spent else axis_label(found.over)
    figure.supxlabel(f"{label}  (n = {_counts(found)} a point)", fontsize="medium")
    figure.supylabel(f"success, {found.verdict.replace('_', ' ')} [%]", fontsize="medium")
    legend(figure, handlelength=1.6)
    return Drawn(figure, _remarks(found))


def _draw_panel(figure: Figure, axis: Axes, panel: Panel, looks: dict[str, Look], place: Place) -> None:
    from matplotlib.transforms import offset_copy

    positions = {name: position for position, name in enumerate(looks)}
    for line in panel.lines:
        style = looks[line.planner]
        dodge = _DODGE_PT * (positions[line.planner] - (len(looks) - 1) / 2)
        moved = offset_copy(axis.transData, figure, x=dodge, units="points")
        placed = [(at, point) for point in line.points if (at := place(point)) is not None]
        if placed:
            xs, points = [at for at, _ in placed], [point for _, point in placed]
            below = [max(0.0, point.percent - point.low) for point in points]
            above = [max(0.0, point.high - point.percent) for point in points]
            ys = [point.percent for point in points]
            axis.errorbar(
                xs, ys, yerr=[below, above], label=line.planner, elinewidth=0.6, transform=moved, **style._asdict()
            )
        else:
            _draw_level(axis, line, style)
    axis.set_ylim(-3, 103)
    if panel.conditions:
        axis.set_title("\n".join(named(*condition) for condition in panel.conditions.items()), fontsize="small")


def _draw_level(axis: Axes, line: Line, style: Look) -> None:
    """A planner to which the condition does not apply has one success everywhere."""
    (point,) = line.points
    axis.axhline(point.percent, label=line.planner, color=style.color, linestyle="--", linewidth=0.8)
    axis.axhspan(point.low, point.high, color=style.color, alpha=0.08, linewidth=0)


def _place(found: Curves, asked: Asked) -> Place:
    """Where a point stands on the axis: at what was spent, at a number, or one after another."""
    if asked.spent:
        return lambda point: point.checks if asked.spent == "checks" else point.planning_s
    categories = _categories(found)
    if categories:
        return lambda point: None if point.at is None else float(categories.index(str(point.at)))
    return lambda point: None if point.at is None else float(point.at)


def _categories(found: Curves) -> list[str]:
    """Names on an axis that has no numbers."""
    values = _values(found)
    numbers = all(isinstance(value, int | float) and not isinstance(value, bool) for value in values)
    return [] if numbers else list(dict.fromkeys(map(str, values)))


def _values(found: Curves) -> list[Any]:
    return [point.at for panel in found.panels for line in panel.lines for point in line.points if point.at is not None]


def _scale(axis: Axes, found: Curves, asked: Asked, place: Place) -> None:
    from matplotlib.ticker import MaxNLocator

    points = [point for panel in found.panels for line in panel.lines for point in line.points]
    at = sorted({at for point in points if (at := place(point)) is not None})
    if not at:
        return
    if categories := [] if asked.spent else _categories(found):
        axis.set_xticks(range(len(categories)), categories)
    elif all(float(each).is_integer() for each in at):
        axis.xaxis.set_major_locator(MaxNLocator(integer=True))
    low, high = at[0], at[-1]
    if low > 0 and (asked.spent or high >= LOGARITHMIC * low):
        axis.set_xscale("log")
        room = (high / low) ** _ROOM if high > low else 2.0
        axis.set_xlim(low / room, high * room)
    else:
        room = _ROOM * (high - low) or 1.0
        axis.set_xlim(low - room, high + room)


def _counts(found: Curves) -> str:
    counts = [point.trials for panel in found.panels for line in panel.lines for point in line.points]
    return f"{min(counts)}" if min(counts) == max(counts) else f"{min(counts)} to {max(counts)}"


def _remarks(found: Curves) -> list[str]:
    remarks = [f"n = {_counts(found)} trials a point; bars are 95 % Wilson intervals."]
    if found.beside:
        remarks.append(f"Along with {found.over} change: {', '.join(found.beside)}.")
    return [*remarks, *filter(None, [str(found.pooled)])]
