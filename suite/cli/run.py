"""Run an experiment."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from suite.backends.memory import CAN_BE_MEASURED
from suite.backends.processes import Processes
from suite.cli.cores import cores
from suite.cli.options import (
    EXIT_INTERRUPTED,
    Arm,
    Family,
    Obstacles,
    Seed,
    Trials,
    experiment_of,
    say,
    split,
    usage,
    whole_numbers,
    within,
)


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
    workers: Annotated[int | None, typer.Option(help="Processes. [default: all cores]")] = None,
    hang_limit_s: Annotated[
        float, typer.Option(help="A trial that takes longer is killed; a warm-up has 120 s at least.")
    ] = 300.0,
    memory_limit_mb: Annotated[
        float | None, typer.Option(help="A trial that takes more memory is killed. [default: no limit]")
    ] = None,
    out: Annotated[Path | None, typer.Option(help="Folder of the run. [default: results/NAME]")] = None,
    fresh: Annotated[bool, typer.Option("--fresh", help="Start over what the folder holds.")] = False,
    keep_stale: Annotated[
        bool, typer.Option("--keep-stale", help="Use rows there that other code has made, as they are.")
    ] = False,
) -> None:
    """Run every planner on the same scenarios and compare them; what a run in the folder has already is kept."""
    n_workers = within("--workers", cores() if workers is None else workers, 1, 1024)
    within("--hang-limit-s", hang_limit_s, 1, 1e6)
    if memory_limit_mb is not None:
        if not CAN_BE_MEASURED:
            raise usage("--memory-limit-mb: found it on a system that does not tell, allowed on Linux")
        within("--memory-limit-mb", memory_limit_mb, 1, 1e9)
    if fresh and keep_stale:
        raise usage("--keep-stale: found beside --fresh, allowed one of them")
    with Processes(n_workers) as processes:  # the first is on its way while this process imports what follows
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
                experiment,
                folder,
                workers=processes,
                hang_limit_s=hang_limit_s,
                memory_limit_mb=memory_limit_mb,
                fresh=fresh,
                keep_stale=keep_stale,
            )
        except RunInterrupted as stop:
            say(f"stopped: {stop} in {folder}; the same command goes on from there")
            raise typer.Exit(EXIT_INTERRUPTED) from None
    from suite.show.terminal import print_summary

    print_summary(summary)
    print()
    for name in ("table.md", "table.csv", "trials.csv"):
        print(folder / name)
