"""The three verdicts side by side: what is lost from whole seconds to every instant to what an arm can do."""

from __future__ import annotations

import pandas as pd

from suite.auditor.verdicts import VERDICTS
from suite.compare.statistics import wilson_interval
from suite.errors import SuiteError
from suite.show.plots.asked import Asked, Drawn
from suite.show.plots.panels import counts, in_order, panels
from suite.show.plots.style import COLOURS, legend

_MARKERS = dict(zip(VERDICTS, "osD", strict=True))
_APART = 0.24


def draw(trials: pd.DataFrame, planners: tuple[str, ...], asked: Asked) -> Drawn:
    """See ``suite.show.plots``."""
    del asked  # all verdicts are drawn
    names = in_order(trials, planners)
    figure, parts = panels(trials, "verdicts", 0.5 + 0.24 * len(names))
    sizes = []
    for axis, group in parts:
        if group.duplicated(["scenario_hash", "planner"]).any():
            raise SuiteError("verdicts: found a planner under several conditions of its own, allowed one each")
        for k, verdict in enumerate(VERDICTS):
            for place, name in enumerate(names):
                judged = group.loc[group["planner"] == name, f"success_{verdict}"].dropna()
                if judged.empty:
                    continue
                sizes.append(len(judged))
                successes = int(judged.sum())
                percent, (low, high) = 100 * successes / len(judged), wilson_interval(successes, len(judged))
                axis.errorbar(
                    percent,
                    place + _APART * (k - 1),
                    xerr=[[max(0.0, percent - 100 * low)], [max(0.0, 100 * high - percent)]],
                    color=COLOURS[k],
                    marker=_MARKERS[verdict],
                    markersize=3.5,
                    elinewidth=0.7,
                    capsize=0,
                    linestyle="none",
                    label=verdict.replace("_", " ") if place == 0 else None,
                )
        axis.set_xlim(-4, 104)
        axis.set_yticks(range(len(names)), names)
        axis.set_ylim(len(names) - 0.5, -0.5)
    if not sizes:
        raise SuiteError("verdicts: found no judged trial, allowed trials that were audited")
    figure.supxlabel(f"success [%]  (n = {counts(sizes)})", fontsize="medium")
    legend(figure)
    return Drawn(figure, [f"n = {counts(sizes)} trials a mark; bars are 95 % Wilson intervals."])
