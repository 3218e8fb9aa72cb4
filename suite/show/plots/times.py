"""Planning times: the share of all trials, failures too, whose solves took no longer in all."""

from __future__ import annotations

import numpy as np
import pandas as pd

from suite.errors import SuiteError
from suite.show.plots.asked import Asked, Drawn
from suite.show.plots.panels import counts, in_order, panels
from suite.show.plots.style import legend, look


def draw(trials: pd.DataFrame, planners: tuple[str, ...], asked: Asked) -> Drawn:
    """See ``suite.show.plots``."""
    del asked  # times are of all trials, whatever the verdict
    timed = trials.dropna(subset=["planning_time_s"])
    if timed.empty:
        raise SuiteError("times: found no planning times, allowed trials that were planned")
    names = in_order(timed, planners)
    figure, parts = panels(timed, "times", 1.5)
    sizes = []
    for axis, group in parts:
        for position, name in enumerate(names):
            spent = np.sort(group.loc[group["planner"] == name, "planning_time_s"].to_numpy(dtype=float))
            if len(spent):
                sizes.append(len(spent))
                style = look(position)
                axis.step(
                    np.concatenate([spent[:1], spent]),
                    100 * np.arange(len(spent) + 1) / len(spent),
                    where="post",
                    label=name,
                    color=style.color,
                    linestyle=style.linestyle,
                )
        axis.set_xscale("log")
        axis.set_ylim(-2, 102)
    figure.supxlabel(f"planning time of a trial [s]  (n = {counts(sizes)})", fontsize="medium")
    figure.supylabel("trials [%]", fontsize="medium")
    legend(figure, handlelength=1.6)
    return Drawn(figure, [f"n = {counts(sizes)} trials a line, failures too; wall clock of one machine."])
