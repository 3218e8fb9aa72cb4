"""Print the table of a run."""

from __future__ import annotations

from typing import Annotated, Literal

import typer

from suite.cli.options import EXIT_NOTHING, Run, say, usage


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
    ] = "swept",
) -> None:
    """Print the comparison of a run, finished or not."""
    from suite.compare.pairs import compare_in_pairs
    from suite.compare.published import beside, published_file, read_published
    from suite.compare.tables import SUMMED_UP, summarize
    from suite.show import text
    from suite.show.conditions import sentence
    from suite.show.terminal import print_summary
    from suite.store.run_folder import planner_order, present_codes, read_manifest, read_table, read_trials

    trials = read_trials(run) if reference is not None else read_trials(run, SUMMED_UP)
    if trials is not None and trials.empty:
        say(f"{run}: no trial has finished yet")
        raise typer.Exit(EXIT_NOTHING)
    if trials is None and reference is not None:
        raise usage(f"--reference: found no trials in {run}, allowed where they were kept")
    if trials is None:
        summary = read_table(run)
    else:
        summary = summarize(trials, planner_order(run), present_codes(read_manifest(run)))
    if against is not None:
        summary = beside(summary, read_published(published_file(against)))
    pairs = None if trials is None or reference is None else compare_in_pairs(trials, reference, verdict)
    if format == "terminal":
        print_summary(summary)
    else:
        if format == "markdown" and (said := sentence(summary)):
            print(f"{said}\n")
        print(text.render(summary, format), end="")
    if pairs is not None:
        print()
        print(text.render_pairs(pairs, "markdown" if format == "terminal" else format), end="")
