"""Draw a figure of a run."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from suite.cli.options import EXIT_NOTHING, By, Run, names, say, usage


def plot(
    run: Run,
    kind: Annotated[
        str,
        typer.Argument(
            help="curve: success over a condition; times: planning times; profile: success within a factor of the"
            " least cost; verdicts: all three, per planner; paths: of the tip, in one scenario."
        ),
    ] = "curve",
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
        typer.Option(help="curve: put points at what their median trial spent; profile: the cost. [profile: time]"),
    ] = None,
    scenario: Annotated[
        str | None, typer.Option(help="paths: id of the scenario. [default: the first that somebody failed on]")
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
    asked = Asked(over, None if by is None else names(by), verdict, spent, run, scenario)
    drawn = draw(kind, trials, planner_order(run), asked, file)
    print(file)
    for remark in drawn.remarks:
        print(remark)
