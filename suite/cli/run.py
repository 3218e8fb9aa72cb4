"""Run an experiment."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from suite.backends.memory import CAN_BE_MEASURED
from suite.backends.processes import Processes
from suite.cli.cores import cores
from suite.cli.options import (
    EXIT_INTERRUPTED,
    Arm,
    Family,
    Obstacles,
    Quiet,
    Seeds,
    Trials,
    complete_planners,
    experiment_of,
    names,
    numbers,
    say,
    usage,
    within,
)

if TYPE_CHECKING:
    from suite.backends.job import Backend
    from suite.experiment.experiment import Experiment


def run(
    file: Annotated[
        Path | None, typer.Argument(help="Experiment file (.yaml, .json), or the manifest.json of a run.")
    ] = None,
    planners: Annotated[
        str | None,
        typer.Option(
            help="Planners, such as 'temporal[horizon=3],rrt,pf'; see 'suite planners'.",
            autocompletion=complete_planners,
        ),
    ] = None,
    preset: Annotated[
        str | None, typer.Option(help="Start from a named experiment (table1) or the manifest.json of a run.")
    ] = None,
    family: Family = None,
    arm: Arm = None,
    obstacles: Obstacles = None,
    trials: Trials = None,
    seed: Seeds = None,
    predictor: Annotated[
        str | None, typer.Option(help="Predictors of obstacle motion. [default: own, each planner's own]")
    ] = None,
    margin: Annotated[
        str | None,
        typer.Option(help="Standard deviations by which predicted obstacles are grown. [default: each planner's own]"),
    ] = None,
    limits: Annotated[
        bool | None,
        typer.Option("--limits/--no-limits", help="Hold planners to the arm's motion limits. [default: no]"),
    ] = None,
    noise_mm: Annotated[
        str | None, typer.Option(help="Noise on observed positions, such as 0,1,2,5. [default: 0]")
    ] = None,
    dropout: Annotated[
        str | None, typer.Option(help="Share of observations lost, such as 0..0.4/5. [default: 0]")
    ] = None,
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
    memory_limit_mb: Annotated[
        float | None, typer.Option(help="A trial that takes more memory is killed. [default: no limit]")
    ] = None,
    bounds: Annotated[
        bool,
        typer.Option("--bounds", help="Say what is possible: clairvoyant solves it, or a proof says that nobody can."),
    ] = False,
    open_effort: Annotated[
        int, typer.Option(help="With --bounds: times clairvoyant's usual searches before a scenario stays open.")
    ] = 1,
    out: Annotated[Path | None, typer.Option(help="Folder of the run. [default: results/NAME]")] = None,
    fresh: Annotated[bool, typer.Option("--fresh", help="Start over what the folder holds.")] = False,
    keep_stale: Annotated[
        bool, typer.Option("--keep-stale", help="Use rows there that other code has made, as they are.")
    ] = False,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Say how many trials there are and how long they should take; run none.")
    ] = False,
    quiet: Quiet = False,
    format: Annotated[Literal["terminal", "json"], typer.Option(help="How the table is printed.")] = "terminal",
) -> None:
    """Run every planner on the same scenarios and compare them; what a run in the folder has already is kept.

    Wherever several values are given, every combination is run, each under a row of its own.
    """
    n_workers = within("--workers", cores() if workers is None else workers, 1, 1024)
    within("--hang-limit-s", hang_limit_s, 1, 1e6)
    if memory_limit_mb is not None:
        _check_memory_limit(memory_limit_mb)
    within("--open-effort", open_effort, 1, 1000)
    if fresh and keep_stale:
        raise usage("--keep-stale: found beside --fresh, allowed one of them")
    if scheduler is not None:
        _refuse_beside_scheduler(backend, workers)
    if open_effort > 1 and not bounds:
        raise usage("--open-effort: found without --bounds, allowed with it")
    fields = {
        "planners": planners,
        "family": family,
        "arm": arm,
        "obstacles": obstacles and numbers("--obstacles", obstacles, int),
        "trials": trials,
        "seed": seed and numbers("--seed", seed, int),
        "predictor": predictor and names(predictor),
        "margin": margin and numbers("--margin", margin, float),
        "limits": limits,
        "noise_mm": noise_mm and numbers("--noise-mm", noise_mm, float),
        "dropout": dropout and numbers("--dropout", dropout, float),
        "scenario_files": scenarios and tuple(map(str, scenarios)),
    }
    given = {name: value for name, value in fields.items() if value is not None}

    def asked() -> Experiment:
        experiment = experiment_of(preset, file, given)
        return experiment.with_bound(open_effort) if bounds else experiment

    if dry_run:
        _foretell(asked(), file, out, n_workers, fresh=fresh, keep_stale=keep_stale)
        return
    with ExitStack() as stack:
        # The first local process is on its way while this one imports what follows.
        where = stack.enter_context(Processes(n_workers)) if backend == "local" else _cluster(scheduler, n_workers)
        from suite.backends.job import Limits
        from suite.runner import RunInterrupted, run_experiment

        experiment = asked()
        folder = out or _folder(experiment, file)
        try:
            summary = run_experiment(
                experiment,
                folder,
                workers=where,
                limits=Limits(hang_limit_s, memory_limit_mb),
                fresh=fresh,
                keep_stale=keep_stale,
                quiet=quiet,
            )
        except RunInterrupted as stop:
            say(f"stopped: {stop} in {folder}; the same command goes on from there")
            raise typer.Exit(EXIT_INTERRUPTED) from None
    if format == "json":
        from suite.show.text import as_json

        print(as_json(summary))
        return
    from suite.show.terminal import print_summary

    print_summary(summary)
    print()
    for name in ("table.md", "table.csv", "trials.csv"):
        print(folder / name)


def _check_memory_limit(memory_limit_mb: float) -> None:
    if not CAN_BE_MEASURED:
        raise usage("--memory-limit-mb: found it on a system that does not tell, allowed on Linux")
    within("--memory-limit-mb", memory_limit_mb, 1, 1e9)


def _refuse_beside_scheduler(backend: str, workers: int | None) -> None:
    if backend != "dask":
        raise usage("--scheduler: found beside --backend local, allowed with --backend dask")
    if workers is not None:
        raise usage("--workers: found beside --scheduler, allowed without: the cluster's own are used")


def _cluster(scheduler: str | None, n_workers: int) -> Backend:
    from suite.backends.cluster.head import DaskCluster
    from suite.backends.warm_up import warm_up_parts

    return DaskCluster(scheduler, n_workers, warm_up_parts)


def _folder(experiment: Experiment, file: Path | None) -> Path:
    """Named after the experiment's file, which may be edited; else after the conditions."""
    return Path("results") / (experiment.name if file is None or file.name == "manifest.json" else file.stem)


def _foretell(
    experiment: Experiment, file: Path | None, out: Path | None, workers: int, *, fresh: bool, keep_stale: bool
) -> None:
    from suite.foresight import foresee

    folder = out or _folder(experiment, file)
    print(f"would run in {folder}")
    for line in foresee(experiment, folder, workers, fresh=fresh, keep_stale=keep_stale).lines(workers):
        print(line)
