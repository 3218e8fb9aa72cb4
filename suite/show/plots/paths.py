"""Ways of the tip through one scenario, from the side and from above, with the obstacles' ways until the end."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from suite.errors import SuiteError
from suite.show.plots.asked import Asked, Drawn
from suite.show.plots.style import COLUMN_IN, legend, look
from suite.show.replay.chosen import Chosen, choose

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_VIEWS = ((0, 2), (0, 1))
_AXES = "xyz"
_OBSTACLE = "0.55"


def draw(trials: pd.DataFrame, planners: tuple[str, ...], asked: Asked) -> Drawn:
    """See ``suite.show.plots``; what was executed is read from the run itself."""
    from matplotlib.figure import Figure

    del trials, planners
    if asked.run is None:
        raise SuiteError("paths: found rows only, allowed the folder of a run")
    chosen = choose(asked.run, asked.scenario, ())
    if any(trial.executed is None for trial in chosen.trials):
        raise SuiteError(f"{asked.run}: found no trajectories, allowed a run that kept its journal; see suite show")
    moved = [trial for trial in chosen.trials if trial.executed is not None and len(trial.executed.times_s)]
    figure = Figure(figsize=(COLUMN_IN, 2.1), layout="constrained")
    for axis, view in zip(figure.subplots(1, 2), _VIEWS, strict=True):
        _draw_view(axis, chosen._replace(trials=moved), view)
    legend(figure, handlelength=1.6)
    left_out = [f"Not drawn for lack of room: {', '.join(chosen.left_out)}."] if chosen.left_out else []
    shown = f"{chosen.scenario.id}: star, goal; crosses, ends of motions without success (swept); grey, obstacles."
    return Drawn(figure, [shown, *left_out])


def _draw_view(axis: Axes, chosen: Chosen, view: tuple[int, int]) -> None:
    from matplotlib.patches import Circle

    scenario, (a, b) = chosen.scenario, view
    end_s = max((float(t.executed.times_s[-1]) for t in chosen.trials if t.executed is not None), default=0.0)
    times = np.linspace(0.0, end_s, 200)
    for obstacle in scenario.obstacles:
        way = obstacle.position(times)
        axis.plot(way[:, a], way[:, b], color=_OBSTACLE, linewidth=0.6, zorder=1)
        axis.add_patch(Circle((way[-1, a], way[-1, b]), obstacle.radius_m, color=_OBSTACLE, alpha=0.35, linewidth=0))
    for position, trial in enumerate(chosen.trials):
        if trial.executed is not None:
            tips, style = scenario.arm.tips(trial.executed.configurations_rad), look(position)
            axis.plot(
                tips[:, a], tips[:, b], color=style.color, linestyle=style.linestyle, linewidth=0.9, label=trial.label
            )
            if not trial.row["success_swept"]:
                axis.plot(*tips[-1, [a, b]], marker="x", color=style.color, markersize=5)
    axis.plot(*scenario.arm.tip(scenario.start)[[a, b]], marker="o", color="black", markersize=3)
    axis.plot(*scenario.goal[[a, b]], marker="*", color="black", markersize=7)
    axis.set_aspect("equal", adjustable="datalim")
    axis.locator_params(axis="x", nbins=3)
    axis.set_xlabel(f"{_AXES[a]} [m]")
    axis.set_ylabel(f"{_AXES[b]} [m]")
