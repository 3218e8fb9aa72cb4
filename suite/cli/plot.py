"""Draw a figure of a run."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from suite.cli.options import EXIT_NOTHING, By, Run, names, say, usage


def plot(
    run: Run,
    kind: Annotated[str, typer.Argument(help="curve: success over a condition, a line per planner.")] = "curve",
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="File: .png, .pdf or .svg. [default: RUN/KIND.png]")
    ] = None,
    over: Annotated[
        str | None, typer.Option(help="Condition on the axis, such as noise_mm. [default: that with most values]")
    ] = None,
    by: By = None,
    verdict: Annotated[
        Literal["per_step", "swept", "executable"], typer.Option(help="Success that is drawn.")
    ] = "swept",
    spent: Annotated[
        Literal["checks", "time"] | None,
        typer.Option(help="Put each point at what its median trial spent, in place of the condition's value."),
    ] = None,
) -> None:
    """Draw a figure of a run, finished or not; needs matplotlib."""
    from suite.show.plots import plot as draw
    from suite.show.plots.asked import Asked
    from suite.store.run_folder import planner_order, read_trials

    trials = read_trials(run)
    if trials is None:
        raise usage(f"{run}: found no trials, allowed the folder of a run where they were kept")
    if trials.empty:
        say(f"{run}: no trial has finished yet")
        raise typer.Exit(EXIT_NOTHING)
    file = output or run / f"{kind}.png"
    asked = Asked(over, None if by is None else names(by), verdict, spent)
    drawn = draw(kind, trials, planner_order(run), asked, file)
    print(file)
    for remark in drawn.remarks:
        print(remark)
