"""Performance profile: on which share of scenarios a planner succeeds at no more than so many times the least cost.

E. D. Dolan and J. J. More, Math. Program. 91 (2002), 201-213. A failure costs more than anything, so a line ends at the
planner's success rate; a scenario that nobody solves counts against all.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
import pandas as pd

from suite.compare.tables import are_bounds
from suite.errors import SuiteError
from suite.show.plots.asked import Asked, Drawn
from suite.show.plots.panels import counts, in_order, panels
from suite.show.plots.style import legend, look

_LEAST = {"checks": 1.0, "time": 1e-6}
"""What a cost is taken for at the least: no check at all is no infinitely good planner."""


def ratios(trials: pd.DataFrame, names: Sequence[str], success: str, spent: str) -> pd.DataFrame:
    """By scenario and planner the cost over that of the cheapest planner that succeeded; inf for a failure."""
    checks = trials["state_checks"].fillna(0) + trials["motion_checks"].fillna(0)
    cost = (checks if spent == "checks" else trials["planning_time_s"]).astype(float).clip(lower=_LEAST[spent])
    cost = cost.where(trials[success].fillna(False).astype(bool), np.inf).fillna(np.inf)
    table = trials.assign(cost=cost).pivot_table(
        index="scenario_hash", columns="planner", values="cost", aggfunc="first", dropna=False
    )
    table = table.reindex(columns=list(names)).dropna()  # scenarios that all were tried on
    least = table.min(axis=1)
    return table.div(least.where(np.isfinite(least), 1.0), axis=0)


def draw(trials: pd.DataFrame, planners: tuple[str, ...], asked: Asked) -> Drawn:
    """See ``suite.show.plots``."""
    spent, success = asked.spent or "time", f"success_{asked.verdict}"
    competing = trials[~are_bounds(trials)]
    names = in_order(competing, planners)
    figure, parts = panels(competing, "profile", 1.5)
    sizes, largest = [], 2.0
    for axis, group in parts:
        if group.duplicated(["scenario_hash", "planner"]).any():
            raise SuiteError("profile: found a planner under several conditions of its own, allowed one each")
        table = ratios(group, names, success, spent)
        if table.empty:
            raise SuiteError("profile: found no scenario that all planners were tried on, allowed where there are some")
        sizes.append(len(table))
        finite = table.to_numpy()[np.isfinite(table.to_numpy())]
        largest = max(largest, float(finite.max(initial=1.0)))
        for position, name in enumerate(names):
            style, at, share = look(position), *_steps(table[name].to_numpy())
            axis.step(at, share, where="post", label=name, color=style.color, linestyle=style.linestyle)
        axis.set_xscale("log")
        axis.set_ylim(-2, 102)
    for axis in figure.axes:
        axis.set_xlim(1.0, 1.2 * largest)
    words = {"checks": "states and motions checked", "time": "planning time"}[spent]
    figure.supxlabel(f"{words}, times the least  (n = {counts(sizes)})", fontsize="medium")
    figure.supylabel(f"success, {asked.verdict.replace('_', ' ')} [%]", fontsize="medium")
    legend(figure, handlelength=1.6)
    return Drawn(figure, [f"n = {counts(sizes)} scenarios that all planners were tried on; bounds are left out."])


def _steps(values: npt.NDArray[np.float64]) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Places and percentages of a line that goes on to the right for ever."""
    solved = np.sort(values[np.isfinite(values)])
    at = np.concatenate([[1.0], solved, [1e12]])
    share = np.concatenate([[0.0], np.arange(1, len(solved) + 1), [len(solved)]])
    return at, 100 * share / max(len(values), 1)
