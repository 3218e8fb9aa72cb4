"""What the verbs share: options, exit codes, and how text becomes values."""

from __future__ import annotations

import sys
from collections.abc import Callable
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

Family = Annotated[
    str | None, typer.Option(help="Scenario families, such as 'orbit[max_speed_m_s=0.005..0.03/6]'. [default: orbit]")
]
Arm = Annotated[
    list[str] | None,
    typer.Option(help="Settings of the arm, such as 'radius_m=0.015,n_sections=2'; may be repeated: several arms."),
]
Obstacles = Annotated[str | None, typer.Option(help="Numbers of obstacles, such as 1,3 or 1..10. [default: 1,3,5,6]")]
Trials = Annotated[int | None, typer.Option(help="Scenarios per number of obstacles. [default: 10]")]
Seed = Annotated[int | None, typer.Option(help="Seed of the experiment. [default: 0]")]
Seeds = Annotated[str | None, typer.Option(help="Seeds of the experiment. [default: 0]")]
By = Annotated[
    str | None,
    typer.Option(help="Conditions to tell apart, such as n_obstacles,noise_mm; the others are pooled, and it says so."),
]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="No progress and no remarks, results and errors only.")]
Run = Annotated[Path, typer.Argument(help="Folder of a run.")]


def experiment_of(preset: str | None, file: Path | None, given: dict[str, Any]) -> Experiment:
    """The fields of a preset, or of a file, with those that were given on the command line in their place."""
    from suite.experiment.experiment import make_experiment
    from suite.experiment.file import preset_fields, read_experiment_file

    if preset and file:
        raise usage(f"--preset: found beside {file}, allowed one of them; a file may name its preset")
    fields = (preset_fields(preset) if preset else read_experiment_file(file) if file else {}) | given
    clash = [name for name in ("family", "arm", "obstacles", "trials") if name in given]
    if fields.get("scenario_files") and clash:
        raise usage(f"--{clash[0]}: found beside --scenarios, allowed without: the files say it all")
    if not fields.get("planners"):
        raise usage("--planners: found nothing, allowed a list such as temporal,rrt,pf; see 'suite planners'")
    return make_experiment(**fields)


def numbers(option: str, text: str, kind: Callable[[str], _Number]) -> tuple[_Number, ...]:
    """Numbers from a list such as ``1,3,5`` or a range such as ``1..10``."""
    from suite.experiment.values import ALLOWED, listed

    try:
        return tuple(kind(part) for part in listed(text))
    except ValueError:
        raise usage(f"{option}: found {text!r}, allowed {ALLOWED}") from None


def names(text: str) -> tuple[str, ...]:
    """Names from a comma-separated list."""
    return tuple(part.strip() for part in text.split(",") if part.strip())


def complete_planners(incomplete: str) -> list[str]:
    """Lists of planners that begin with what was typed: the last name is completed, those before it stay."""
    from planners import ALIASES, PLANNERS, ompl_planners, plugins

    before, comma, begun = incomplete.rpartition(",")
    taken = set(before.split(","))
    names = [*PLANNERS, *ALIASES, *ompl_planners(), *plugins.offered()]
    return [f"{before}{comma}{name}" for name in names if name.startswith(begun) and name not in taken]


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
