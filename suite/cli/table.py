"""Print the table of a run."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal, NamedTuple

import typer

from suite.cli.options import EXIT_NOTHING, By, Run, names, say, usage

if TYPE_CHECKING:
    import pandas as pd

    from suite.compare.conditions import Pooled

Format = Literal["terminal", "markdown", "csv", "latex", "json"]


def table(
    run: Run,
    format: Annotated[Format, typer.Option(help="What to print.")] = "terminal",
    by: By = None,
    columns: Annotated[
        str | None, typer.Option(help="Columns to print, such as 'planner,n,swept'. [default: all that say something]")
    ] = None,
    against: Annotated[
        str | None, typer.Option(help="Put published numbers beside: 'published' (the paper's Table I) or a CSV file.")
    ] = None,
    reference: Annotated[str | None, typer.Option(help="Test every planner against this one, in pairs.")] = None,
    verdict: Annotated[
        Literal["per_step", "swept", "executable"], typer.Option(help="Success that is compared in pairs.")
    ] = "swept",
) -> None:
    """Print the comparison of a run, finished or not."""
    from suite.compare.conditions import Pooled, pool
    from suite.compare.pairs import compare_in_pairs
    from suite.compare.published import beside, published_file, read_published
    from suite.compare.tables import SUMMED_UP, summarize
    from suite.store.run_folder import planner_order, present_codes, read_manifest, read_table, read_trials

    trials = read_trials(run) if reference is not None else read_trials(run, SUMMED_UP)
    if trials is not None and trials.empty:
        say(f"{run}: no trial has finished yet")
        raise typer.Exit(EXIT_NOTHING)
    pairs, pooled = None, None
    if trials is None:
        for option, value in (("--reference", reference), ("--by", by)):
            if value is not None:
                raise usage(f"{option}: found no trials in {run}, allowed where they were kept")
        summary = read_table(run)
    else:
        pooled = Pooled(trials, {}) if by is None else pool(trials, names(by))
        summary = summarize(pooled.trials, planner_order(run), present_codes(read_manifest(run)))
        pairs = None if reference is None else compare_in_pairs(pooled.trials, reference, verdict)
    if against is not None:
        summary = beside(summary, read_published(published_file(against)))
    chosen = None if columns is None else names(columns)
    if chosen is not None and format in {"csv", "json"}:
        raise usage(f"--columns: found beside --format {format}, allowed with terminal, markdown, latex")
    _print(run, Printed(summary, pairs, pooled, chosen), format)


class Printed(NamedTuple):
    """What there is to print."""

    summary: pd.DataFrame
    pairs: pd.DataFrame | None
    pooled: Pooled | None
    columns: tuple[str, ...] | None
    """Those that were asked for."""


def _print(run: Path, printed: Printed, format: Format) -> None:
    from suite.show import text
    from suite.show.conditions import sentence
    from suite.show.latex import as_latex
    from suite.show.terminal import print_pairs, print_summary

    summary, pairs, pooled, columns = printed
    if format == "json":
        print(text.as_json(summary, pairs, pooled))
        return
    if pooled is not None and pooled.over and format != "csv":
        print(f"% {pooled}" if format == "latex" else f"{pooled}\n")
    if format == "terminal":
        print_summary(summary, columns)
    elif format == "latex":
        print(as_latex(run.resolve().name, summary, columns), end="")
    else:
        rendered = text.render(summary, format, columns)
        if format == "markdown" and (said := sentence(summary)):
            print(f"{said}\n")
        print(rendered, end="")
    if pairs is not None:
        print()
        if format == "terminal":
            print_pairs(pairs)
        else:
            print(text.render_pairs(pairs, format), end="")
