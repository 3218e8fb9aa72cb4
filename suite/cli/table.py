"""Print the table of a run."""

from __future__ import annotations

from typing import Annotated, Literal

import typer

from suite.cli.options import EXIT_NOTHING, Run, say


def table(
    run: Run,
    format: Annotated[
        Literal["terminal", "markdown", "csv", "latex"], typer.Option(help="What to print.")
    ] = "terminal",
    against: Annotated[
        str | None, typer.Option(help="Put published numbers beside: 'published' (the paper's Table I) or a CSV file.")
    ] = None,
    reference: Annotated[str | None, typer.Option(help="Test every planner against this one, in pairs.")] = None,
    verdict: Annotated[
        Literal["per_step", "swept", "executable"], typer.Option(help="Success that is compared in pairs.")
    ] = "per_step",
) -> None:
    """Print the comparison of a run, finished or not."""
    from suite.compare.pairs import compare_in_pairs
    from suite.compare.published import beside, published_file, read_published
    from suite.compare.tables import summarize
    from suite.show import text
    from suite.show.terminal import print_summary
    from suite.store.run_folder import planner_order, read_trials

    trials = read_trials(run)
    if trials.empty:
        say(f"{run}: no trial has finished yet")
        raise typer.Exit(EXIT_NOTHING)
    summary = summarize(trials, planner_order(run))
    if against is not None:
        summary = beside(summary, read_published(published_file(against)))
    pairs = None if reference is None else compare_in_pairs(trials, reference, verdict)
    if format == "terminal":
        print_summary(summary)
    else:
        print(text.render(summary, format), end="")
    if pairs is not None:
        print()
        print(text.render_pairs(pairs, "markdown" if format == "terminal" else format), end="")
