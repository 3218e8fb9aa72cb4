"""The command line: options in, one call, exit code out.

Whatever is heavy to import is imported inside the commands, so that ``suite --help`` answers at once.
"""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Sequence
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeVar

import typer
from typer.exceptions import TyperException

if TYPE_CHECKING:
    from suite.experiment import Experiment

EXIT_USAGE = 2
EXIT_NOTHING = 3
EXIT_INTERRUPTED = 130

app = typer.Typer(
    help="Compare motion planners for continuum arms among moving obstacles.",
    rich_markup_mode=None,  # rich help would double the time of --help
    pretty_exceptions_enable=False,
)

_Number = TypeVar("_Number", int, float)

Family = Annotated[str | None, typer.Option(help="Scenario family. [default: orbit]")]
Arm = Annotated[str | None, typer.Option(help="Settings of the arm, such as 'radius_m=0.015,n_sections=2'.")]
Obstacles = Annotated[str | None, typer.Option(help="Numbers of obstacles. [default: 1,3,5,6]")]
Trials = Annotated[int | None, typer.Option(help="Scenarios per number of obstacles. [default: 10]")]
Seed = Annotated[int | None, typer.Option(help="Seed of the experiment. [default: 0]")]
Run = Annotated[Path, typer.Argument(help="Folder of a run.")]


@app.command()
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
    hang_limit_s: Annotated[float, typer.Option(help="A trial that takes longer is killed.")] = 300.0,
    out: Annotated[Path | None, typer.Option(help="Folder of the run. [default: results/NAME]")] = None,
    fresh: Annotated[bool, typer.Option("--fresh", help="Start over what the folder holds.")] = False,
) -> None:
    """Run every planner on the same scenarios and compare them; a stopped run goes on where it was."""
    from suite.run import RunInterrupted, run_experiment
    from suite.terminal import print_summary

    fields = {
        "planners": planners and _split(planners),
        "family": family,
        "arm": arm,
        "obstacles": obstacles and _whole_numbers(obstacles),
        "trials": trials,
        "seed": seed,
        "predictor": predictor,
        "limits": limits,
        "noise_mm": noise_mm,
        "dropout": dropout,
        "scenario_files": scenarios and tuple(str(file) for file in scenarios),
    }
    n_workers = _within("--workers", _cores() if workers is None else workers, 1, 1024)
    _within("--hang-limit-s", hang_limit_s, 1, 1e6)
    experiment = _experiment(preset, {name: value for name, value in fields.items() if value is not None})
    folder = out or Path("results") / experiment.name
    try:
        summary = run_experiment(experiment, folder, workers=n_workers, hang_limit_s=hang_limit_s, fresh=fresh)
    except RunInterrupted as stop:
        _say(f"stopped: {stop} in {folder}; the same command goes on from there")
        raise typer.Exit(EXIT_INTERRUPTED) from None
    print_summary(summary)
    print()
    for name in ("table.md", "table.csv", "trials.csv"):
        print(folder / name)


@app.command()
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
    ] = "per_step",
) -> None:
    """Print the comparison of a run, finished or not."""
    from suite import text
    from suite.pairs import compare_in_pairs
    from suite.published import beside, published_file, read_published
    from suite.run_folder import planner_order, read_trials
    from suite.tables import summarize
    from suite.terminal import print_summary

    trials = read_trials(run)
    if trials.empty:
        _say(f"{run}: no trial has finished yet")
        raise typer.Exit(EXIT_NOTHING)
    summary = summarize(trials, planner_order(run))
    if against is not None:
        summary = beside(summary, read_published(published_file(against)))
    pairs = None if reference is None else compare_in_pairs(trials, reference, verdict)
    if format == "terminal":
        print_summary(summary)
    else:
        print(text.render(summary, format), end="")
    if pairs is not None:
        print()
        print(text.render_pairs(pairs, "markdown" if format == "terminal" else format), end="")


@app.command()
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

    numbers = _whole_numbers(obstacles or "1,3,5,6")
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


@app.command()
def planners() -> None:
    """List planners with their settings, and predictors."""
    from suite.listing import planners_text

    print(planners_text(), end="")


@app.command()
def predictors(
    family: Annotated[str, typer.Option(help="Scenario family.")] = "orbit",
    obstacles: Annotated[int, typer.Option(help="Number of obstacles.")] = 3,
    trials: Annotated[int, typer.Option(help="Number of scenarios.")] = 100,
    seed: Annotated[int, typer.Option(help="Seed of the scenarios and of the noise.")] = 1000,
    noise_mm: Annotated[float, typer.Option(help="Noise on observed positions.")] = 0.0,
    dropout: Annotated[float, typer.Option(help="Share of observations lost.")] = 0.0,
    out: Annotated[Path | None, typer.Option(help="File to write as well: .csv or .md.")] = None,
) -> None:
    """Measure the predictors: error over horizon, honesty of their bounds, time per call."""
    from suite.files import write_text
    from suite.predictors import NOTES, Conditions, as_markdown, as_table, measure
    from suite.text import as_csv

    if out is not None and out.suffix not in {".csv", ".md"}:
        raise _usage(f"--out: found {str(out)!r}, allowed a file that ends in .csv or .md")
    if out is not None and not out.parent.is_dir():
        raise _usage(f"--out: found no folder {str(out.parent)!r}, allowed one that is there")
    conditions = Conditions(family, obstacles, trials, seed, noise_mm, dropout)
    measured = measure(conditions)
    print(f"{conditions}\n\n{as_table(measured, 'simple')}\n{NOTES}")
    if out is not None:
        write_text(out, as_csv(measured) if out.suffix == ".csv" else as_markdown(conditions, measured))


@app.command()
def check(files: Annotated[list[Path], typer.Argument(help="Scenario files.")]) -> None:
    """Check scenario files: format, fields, and whether each start is free."""
    from scenarios import load_scenarios, start_is_free
    from suite.errors import SuiteError

    for file in files:
        found = load_scenarios(file)
        hit = [scenario.id for scenario in found if not start_is_free(scenario)]
        if hit:
            raise SuiteError(
                f"{file}: {hit[0]}: found a start that an obstacle touches before t = 0, allowed a free one"
            )
        print(f"{file}: {len(found)} scenarios, all sound")


@app.command()
def audit(
    trajectories: Annotated[Path, typer.Argument(help="CSV: scenario_id, planner, time_s, u1_rad, v1_rad, ...")],
    scenarios: Annotated[Path, typer.Argument(help="Scenario file that holds every scenario named there.")],
    engine: Annotated[
        Literal["certificate", "fcl"], typer.Option(help="Conservative advancement, or FCL sampled densely.")
    ] = "certificate",
) -> None:
    """Judge trajectories from anywhere against the true motion of the obstacles."""
    from suite.audit.command import audit_file

    for line in audit_file(trajectories, scenarios, engine):
        print(line)


@app.command()
def version() -> None:
    """Print the versions of the suite and of what its numbers depend on."""
    from suite.manifest import DISTRIBUTION, installed, versions

    for name, number in ({DISTRIBUTION: installed(DISTRIBUTION)} | versions()).items():
        print(name, number or "not installed")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code.

    0 is done, 2 a usage or input error, 3 nothing to compare, 130 interrupted with everything finished saved.
    """
    signal.signal(signal.SIGTERM, _interrupt)
    given = list(sys.argv[1:] if arguments is None else arguments)
    try:
        code = app(given or ["--help"], prog_name="suite", standalone_mode=False)
    except TyperException as error:
        _say(f"error: {error.format_message()}")
        return EXIT_USAGE
    except ValueError as error:
        if not _is_a_users(error):
            raise
        _say(f"error: {error}")
        return EXIT_USAGE
    except (KeyboardInterrupt, typer.Abort):
        _say("stopped before anything ran")
        return EXIT_INTERRUPTED
    return code if isinstance(code, int) else 0


def _experiment(preset: str | None, given: dict[str, Any]) -> Experiment:
    """The preset's fields with those that were given on the command line in their place."""
    from suite.experiment import make_experiment, preset_fields

    fields = (preset_fields(preset) if preset else {}) | given
    clash = [name for name in ("family", "arm", "obstacles", "trials") if name in given]
    if fields.get("scenario_files") and clash:
        raise _usage(f"--{clash[0]}: found beside --scenarios, allowed without: the files say it all")
    if not fields.get("planners"):
        raise _usage("--planners: found nothing, allowed a list such as temporal,rrt,pf; see 'suite planners'")
    return make_experiment(**fields)


def _split(specs: str) -> tuple[str, ...]:
    from scenarios.spec import split_specs

    return tuple(split_specs(specs))


def _whole_numbers(text: str) -> tuple[int, ...]:
    try:
        return tuple(int(part) for part in text.split(","))
    except ValueError:
        raise _usage(f"--obstacles: found {text!r}, allowed whole numbers such as 1,3,5,6") from None


def _within(option: str, value: _Number, low: float, high: float) -> _Number:
    if not low <= value <= high:
        raise _usage(f"{option}: found {value}, allowed {low:g} to {high:g}")
    return value


def _usage(message: str) -> ValueError:
    from suite.errors import SuiteError

    return SuiteError(message)


def _is_a_users(error: ValueError) -> bool:
    """Whether the error is a mistake of the user, with a line written for them."""
    from scenarios import ScenarioError, SpecError
    from suite.errors import SuiteError

    return isinstance(error, (ScenarioError, SpecError, SuiteError))


def _cores() -> int:
    """Cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _say(line: str) -> None:
    print(f"suite: {line}", file=sys.stderr)


def _interrupt(number: int, frame: FrameType | None) -> None:
    """Let a request to terminate end a run as Ctrl-C does: saved and without orphans."""
    raise KeyboardInterrupt


if __name__ == "__main__":
    sys.exit(main())
