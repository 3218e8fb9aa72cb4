"""Check files: scenarios and experiments."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def check(files: Annotated[list[Path], typer.Argument(help="Scenario files and experiment files.")]) -> None:
    """Check files: format, fields, whether each scenario's start is free, and what an experiment would run."""
    from suite.experiment.file import is_experiment_file

    for file in files:
        print(_experiment(file) if is_experiment_file(file) else _scenarios(file))


def _scenarios(file: Path) -> str:
    from scenarios import load_scenarios, start_is_free
    from suite.errors import SuiteError

    found = load_scenarios(file)
    hit = [scenario.id for scenario in found if not start_is_free(scenario)]
    if hit:
        raise SuiteError(f"{file}: {hit[0]}: found a start that an obstacle touches before t = 0, allowed a free one")
    return f"{file}: {len(found)} scenarios, all sound"


def _experiment(file: Path) -> str:
    from suite.experiment.file import check_experiment_file

    experiment = check_experiment_file(file)
    return f"{file}: an experiment of {len(experiment.planners)} planners, sound; suite run --dry-run counts its trials"
