"""Run an experiment."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from suite.backends.processes import Processes
from suite.cli.options import (
    EXIT_INTERRUPTED,
    Arm,
    Family,
    Obstacles,
    Seed,
    Trials,
    cores,
    experiment_of,
    say,
    split,
    usage,
    whole_numbers,
    within,
)

if TYPE_CHECKING:
    from suite.backends.job import Backend


def run(
    planners: Annotated[
        str | None, typer.Option(help="Planners, such as 'temporal[horizon=3],rrt,pf'; see 'suite planners'.")
    ] = None,
    preset: Annotated[
        str | None, typer.Option(help="Start from a named experiment (table1) or the manifest.json of a run.")
    ] = None,
    family: Family = None,
    arm: Arm = None,
    obstacles: Obstacles = None,
    trials: Trials = None,
    seed: Seed = None,
    predictor: Annotated[
        str | None, typer.Option(help="Predictor of obstacle motion. [default: each planner's own]")
    ] = None,
    margin: Annotated[
        float | None,
        typer.Option(help="Standard deviations by which predicted obstacles are grown. [default: each planner's own]"),
    ] = None,
    limits: Annotated[
        bool | None,
        typer.Option("--limits/--no-limits", help="Hold planners to the arm's motion limits. [default: no]"),
    ] = None,
    noise_mm: Annotated[float | None, typer.Option(help="Noise on observed positions. [default: 0]")] = None,
    dropout: Annotated[float | None, typer.Option(help="Share of observations lost. [default: 0]")] = None,
    scenarios: Annotated[
        list[Path] | None, typer.Option(help="Scenario file to use instead of a family; may be repeated.")
    ] = None,
    backend: Annotated[
        Literal["local", "dask"], typer.Option(help="Where trials run: on this machine, or on a Dask cluster.")
    ] = "local",
    scheduler: Annotated[
        str | None,
        typer.Option(help="Address of the cluster's scheduler. [default: a cluster on this machine is started]"),
    ] = None,
    workers: Annotated[int | None, typer.Option(help="Processes on this machine. [default: all cores]")] = None,
    hang_limit_s: Annotated[
        float, typer.Option(help="A trial that takes longer is killed; a warm-up has 120 s at least.")
    ] = 300.0,
    out: Annotated[Path | None, typer.Option(help="Folder of the run. [default: results/NAME]")] = None,
    fresh: Annotated[bool, typer.Option("--fresh", help="Start over what the folder holds.")] = False,
    keep_stale: Annotated[
        bool, typer.Option("--keep-stale", help="Use rows there that other code has made, as they are.")
    ] = False,
) -> None:
    """Run every planner on the same scenarios and compare them; what a run in the folder has already is kept."""
    n_workers = within("--workers", cores() if workers is None else workers, 1, 1024)
    within("--hang-limit-s", hang_limit_s, 1, 1e6)
    if fresh and keep_stale:
        raise usage("--keep-stale: found beside --fresh, allowed one of them")
    if scheduler is not None and backend != "dask":
        raise usage("--scheduler: found beside --backend local, allowed with --backend dask")
    if scheduler is not None and workers is not None:
        raise usage("--workers: found beside --scheduler, allowed without: the cluster's own are used")
    with ExitStack() as stack:
        # The first local process is on its way while this one imports what follows.
        where = stack.enter_context(Processes(n_workers)) if backend == "local" else _cluster(scheduler, n_workers)
        from suite.runner import RunInterrupted, run_experiment

        fields = {
            "planners": planners and split(planners),
            "family": family,
            "arm": arm,
            "obstacles": obstacles and whole_numbers(obstacles),
            "trials": trials,
            "seed": seed,
            "predictor": predictor,
            "margin": margin,
            "limits": limits,
            "noise_mm": noise_mm,
            "dropout": dropout,
            "scenario_files": scenarios and tuple(str(file) for file in scenarios),
        }
        experiment = experiment_of(preset, {name: value for name, value in fields.items() if value is not None})
        folder = out or Path("results") / experiment.name
        try:
            summary = run_experiment(
                experiment, folder, workers=where, hang_limit_s=hang_limit_s, fresh=fresh, keep_stale=keep_stale
            )
        except RunInterrupted as stop:
            say(f"stopped: {stop} in {folder}; the same command goes on from there")
            raise typer.Exit(EXIT_INTERRUPTED) from None
    from suite.show.terminal import print_summary

    print_summary(summary)
    print()
    for name in ("table.md", "table.csv", "trials.csv"):
        print(folder / name)


def _cluster(scheduler: str | None, n_workers: int) -> Backend:
    from suite.backends.cluster.head import DaskCluster
    from suite.backends.warm_up import warm_up_parts

    return DaskCluster(scheduler, n_workers, warm_up_parts)
