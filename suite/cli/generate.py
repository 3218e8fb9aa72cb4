"""Write scenario files."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from suite.cli.options import Arm, Family, Obstacles, Seed, Trials, numbers


def generate(
    file: Annotated[Path, typer.Argument(help="Scenario file to write: .yaml, .json or .jsonl.")],
    family: Family = None,
    arm: Arm = None,
    obstacles: Obstacles = None,
    trials: Trials = None,
    seed: Seed = None,
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
    drawn = [
        scenario
        for each in arms
        for spec in specs_of(family or "orbit")
        for n in counts
        for scenario in generate(spec, n, 10 if trials is None else trials, seed or 0, each)
    ]
    save_scenarios(file, drawn)
    print(f"{file}: {len(drawn)} scenarios")
