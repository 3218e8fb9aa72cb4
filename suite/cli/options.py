"""What the verbs share: options, exit codes, and how text becomes values."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeVar

import typer

if TYPE_CHECKING:
    from suite.experiment.experiment import Experiment

EXIT_FOUND = 1
EXIT_USAGE = 2
EXIT_NOTHING = 3
EXIT_INCONCLUSIVE = 4
EXIT_INTERRUPTED = 130

_Number = TypeVar("_Number", int, float)

Family = Annotated[str | None, typer.Option(help="Scenario family. [default: orbit]")]
Arm = Annotated[str | None, typer.Option(help="Settings of the arm, such as 'radius_m=0.015,n_sections=2'.")]
Obstacles = Annotated[str | None, typer.Option(help="Numbers of obstacles. [default: 1,3,5,6]")]
Trials = Annotated[int | None, typer.Option(help="Scenarios per number of obstacles. [default: 10]")]
Seed = Annotated[int | None, typer.Option(help="Seed of the experiment. [default: 0]")]
Run = Annotated[Path, typer.Argument(help="Folder of a run.")]


def experiment_of(preset: str | None, given: dict[str, Any]) -> Experiment:
    """The preset's fields with those that were given on the command line in their place."""
    from suite.experiment.experiment import make_experiment, preset_fields

    fields = (preset_fields(preset) if preset else {}) | given
    clash = [name for name in ("family", "arm", "obstacles", "trials") if name in given]
    if fields.get("scenario_files") and clash:
        raise usage(f"--{clash[0]}: found beside --scenarios, allowed without: the files say it all")
    if not fields.get("planners"):
        raise usage("--planners: found nothing, allowed a list such as temporal,rrt,pf; see 'suite planners'")
    return make_experiment(**fields)


def split(specs: str) -> tuple[str, ...]:
    """Planners from a comma-separated list."""
    from scenarios.spec import split_specs

    return tuple(split_specs(specs))


def whole_numbers(text: str) -> tuple[int, ...]:
    """Numbers of obstacles from a comma-separated list."""
    try:
        return tuple(int(part) for part in text.split(","))
    except ValueError:
        raise usage(f"--obstacles: found {text!r}, allowed whole numbers such as 1,3,5,6") from None


def within(option: str, value: _Number, low: float, high: float) -> _Number:
    """Return ``value`` if it is within the limits of its option."""
    if not low <= value <= high:
        raise usage(f"{option}: found {value}, allowed {low:g} to {high:g}")
    return value


def usage(message: str) -> ValueError:
    """A usage error; ``main`` prints its line."""
    from suite.errors import SuiteError

    return SuiteError(message)


def say(line: str) -> None:
    """Tell the user something that is no result."""
    print(f"suite: {line}", file=sys.stderr)
