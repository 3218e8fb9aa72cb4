"""Hold a run against another."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from suite.cli.options import EXIT_FOUND, EXIT_INCONCLUSIVE, EXIT_NOTHING, say


def compare(
    base: Annotated[Path, typer.Argument(help="Folder of the run before; one with only trials.csv will do.")],
    new: Annotated[Path, typer.Argument(help="Folder of the run that is held against it.")],
    margin: Annotated[float, typer.Option(help="Loss of success that may be, in percentage points.")] = 5.0,
    alpha: Annotated[float, typer.Option(help="Risk of a false alarm; 0.05 asks for some 400 pairs.")] = 0.05,
    cost_margin: Annotated[float, typer.Option(help="Change of a cost that makes no difference, in percent.")] = 10.0,
    verdict: Annotated[
        Literal["per_step", "swept", "executable"], typer.Option(help="Success that is judged.")
    ] = "executable",
    across: Annotated[
        list[str] | None, typer.Option(help="A condition in which pairs may differ, such as predictor; repeatable.")
    ] = None,
    strict: Annotated[
        bool, typer.Option("--strict", help="Exit 4 when something can't be told, or has no partner.")
    ] = False,
    format: Annotated[Literal["text", "markdown", "json", "csv"], typer.Option(help="What to print.")] = "text",
) -> None:
    """Say in pairs what got better, what got worse and what can't be told; exit 1 on a regression."""
    from suite.api import load
    from suite.compare.gate import Judgement
    from suite.show.changes import FORMATS

    found = load(base).compare(
        load(new), margin=margin, alpha=alpha, cost_margin=cost_margin, verdict=verdict, across=tuple(across or ())
    )
    if not found.findings:
        for line in (*found.missing, *found.differing):
            say(line)
        say(f"{base} and {new}: found no pair of trials, allowed: the same planners on the same scenarios")
        raise typer.Exit(EXIT_NOTHING)
    print(FORMATS[format](found), end="")
    if found.of(Judgement.REGRESSION):
        raise typer.Exit(EXIT_FOUND)
    if strict and (found.of(Judgement.INCONCLUSIVE) or found.missing):
        raise typer.Exit(EXIT_INCONCLUSIVE)
