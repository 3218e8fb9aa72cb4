"""Write scenario files."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from suite.cli.cores import cores
from suite.cli.options import EXIT_INTERRUPTED, Arm, Family, Obstacles, Seed, Trials, numbers, say

if TYPE_CHECKING:
    from scenarios import ContinuumArm
    from suite.hard import Hard


def generate(
    file: Annotated[Path, typer.Argument(help="Scenario file to write: .yaml, .json or .jsonl.")],
    family: Family = None,
    arm: Arm = None,
    obstacles: Obstacles = None,
    trials: Trials = None,
    seed: Seed = None,
    keep: Annotated[
        Literal["all", "possible-hard"],
        typer.Option(
            help="possible-hard: go on until TRIALS scenarios are solved by somebody and failed by --failed-by."
        ),
    ] = "all",
    failed_by: Annotated[
        str, typer.Option(help="Planners of which each has to fail a scenario that is kept as hard.")
    ] = "rrt",
    workers: Annotated[int | None, typer.Option(help="Processes that try scenarios. [default: all cores]")] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace the file if it is there.")] = False,
) -> None:
    """Write scenarios of families to a file."""
    from scenarios import ContinuumArm, generate, save_scenarios
    from suite.errors import SuiteError
    from suite.experiment.values import arms_of, specs_of

    counts = numbers("--obstacles", obstacles or "1,3,5,6", int)
    arms = [ContinuumArm.from_text(text) for text in arms_of(arm or [""])]
    if file.exists() and not overwrite:
        raise SuiteError(f"{file}: found a file there, allowed with --overwrite")
    cells = [(each, spec, n) for each in arms for spec in specs_of(family or "orbit") for n in counts]
    if keep == "all":
        wanted = 10 if trials is None else trials
        drawn = [scenario for each, spec, n in cells for scenario in generate(spec, n, wanted, seed or 0, each)]
        save_scenarios(file, drawn)
        print(f"{file}: {len(drawn)} scenarios")
        return
    _keep_hard(file, cells, specs_of(failed_by), 10 if trials is None else trials, seed or 0, workers or cores())


def _keep_hard(
    file: Path,
    cells: list[tuple[ContinuumArm, str, int]],
    planners: tuple[str, ...],
    wanted: int,
    seed: int,
    workers: int,
) -> None:
    """Write what is hard, and beside it a list of who solved it, after every batch: an interrupt loses nothing."""
    from scenarios import drawn
    from suite.hard import MOST_TRIED, keep_hard
    from suite.runner import RunInterrupted

    kept: list[Hard] = []
    try:
        for arm, family, n in cells:
            tried = found = 0
            for batch in keep_hard(drawn(family, n, MOST_TRIED, seed, arm), planners, wanted, workers):
                kept += batch.kept
                tried, found = tried + batch.tried, found + len(batch.kept)
                _write_hard(file, kept, planners)
                say(f"{family}, {n} obstacles: {found} of {wanted} hard scenarios found among {tried}")
    except (RunInterrupted, KeyboardInterrupt):
        say(f"stopped: {file} has the {len(kept)} hard scenarios found so far")
        raise typer.Exit(EXIT_INTERRUPTED) from None
    print(f"{file}: {len(kept)} scenarios")
    print(file.with_suffix(".csv"))


def _write_hard(file: Path, kept: list[Hard], planners: tuple[str, ...]) -> None:
    from scenarios import save_scenarios

    save_scenarios(file, [hard.scenario for hard in kept])
    with file.with_suffix(".csv").open("w", encoding="utf-8", newline="") as handle:
        lines = csv.writer(handle, lineterminator="\n")
        lines.writerow(["scenario_id", "scenario_hash", "n_obstacles", "solved_by", "failed_by"])
        for scenario, solved_by in kept:
            lines.writerow([scenario.id, scenario.content_hash, len(scenario.obstacles), solved_by, " ".join(planners)])
