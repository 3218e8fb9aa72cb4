"""Write scenario files."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from suite.cli.options import Arm, Family, Obstacles, Seed, Trials, whole_numbers


def generate(
    file: Annotated[Path, typer.Argument(help="Scenario file to write: .yaml, .json or .jsonl.")],
    family: Family = None,
    arm: Arm = None,
    obstacles: Obstacles = None,
    trials: Trials = None,
    seed: Seed = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace the file if it is there.")] = False,
) -> None:
    """Write the scenarios of a family to a file."""
    from scenarios import ContinuumArm, generate, save_scenarios
    from suite.errors import SuiteError

    numbers = whole_numbers(obstacles or "1,3,5,6")
    if file.exists() and not overwrite:
        raise SuiteError(f"{file}: found a file there, allowed with --overwrite")
    drawn = [
        scenario
        for n in numbers
        for scenario in generate(
            family or "orbit", n, 10 if trials is None else trials, seed or 0, ContinuumArm.from_text(arm or "")
        )
    ]
    save_scenarios(file, drawn)
    print(f"{file}: {len(drawn)} scenarios")
