"""Make scenarios from recordings and scenes from elsewhere."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from suite.cli.options import say, usage

if TYPE_CHECKING:
    from collections.abc import Sequence

    from scenarios import Scenario
    from suite.exchange.tracks import Setting

importing = typer.Typer(help="Make scenarios from recordings and scenes from elsewhere.", rich_markup_mode=None)

Out = Annotated[Path, typer.Option("--out", "-o", help="Scenario file to write: .yaml, .json or .jsonl.")]
Overwrite = Annotated[bool, typer.Option("--overwrite", help="Replace the file if it is there.")]
Arm = Annotated[str, typer.Option(help="Settings of the arm, such as 'radius_m=0.015,n_sections=2'.")]
Start = Annotated[str | None, typer.Option(help="Start: bending vectors u1,v1,u2,... [rad]. [default: straight]")]
Goal = Annotated[
    str | None, typer.Option(help="Goal point x,y,z [m]. [default: the tip when each section bends 0.5 rad along x]")
]
TimeLimit = Annotated[float, typer.Option(help="Time limit [s].")]
Observation = Annotated[float, typer.Option(help="How long obstacles are observed before t = 0 [s].")]
Offset = Annotated[str, typer.Option(help="Added to every position: x,y,z [m].")]
Unit = Annotated[Literal["mm", "cm", "m"] | None, typer.Option(help="Unit of the file. [default: its own, or m]")]


@importing.command()
def tracks(
    file: Annotated[Path, typer.Argument(help="Recording: id,t,x,y,z[,radius]; TUM; ETH/UCY; or an export of Motive.")],
    out: Out,
    layout: Annotated[Literal["auto", "table", "tum", "eth", "motive"], typer.Option(help="Layout.")] = "auto",
    unit: Unit = None,
    up: Annotated[Literal["z", "y"], typer.Option(help="Axis of the file that points upward.")] = "z",
    offset: Offset = "0,0,0",
    radius: Annotated[float, typer.Option(help="Radius where the file says none [m].")] = 0.03,
    gap_s: Annotated[
        float | None, typer.Option(help="A longer step is a gap. [default: 1.5 usual steps of the track]")
    ] = None,
    fps: Annotated[float, typer.Option(help="Frames per second of layouts that count frames.")] = 25.0,
    begin: Annotated[float | None, typer.Option(help="Time in the file that is t = 0. [default: start + 5]")] = None,
    every: Annotated[float | None, typer.Option(help="A scenario begins every so many seconds.")] = None,
    arm: Arm = "",
    start: Start = None,
    goal: Goal = None,
    time_limit_s: TimeLimit = 120.0,
    observation_s: Observation = 5.0,
    overwrite: Overwrite = False,
) -> None:
    """Make the bodies of a recording obstacles; where it has gaps nobody sees them."""
    from suite.exchange.tracks import Placing, import_tracks

    if not 0.0 < fps <= 1e6:
        raise usage(f"--fps: found {fps:g}, allowed above 0, up to 1e6")
    setting = _setting(arm, start, goal, time_limit_s, observation_s)
    placing = Placing(unit, up, _point("--offset", offset), radius, gap_s)
    made = import_tracks(file, setting, placing, layout=layout, fps=fps, begin_s=begin, every_s=every)
    _write(out, list(made), overwrite=overwrite)


@importing.command()
def sirrt(
    file: Annotated[Path, typer.Argument(help="Scene of SI-RRT's benchmark (JSON).")],
    out: Out,
    arm: Arm = "",
    start: Start = None,
    goal: Goal = None,
    time_limit_s: TimeLimit = 120.0,
    observation_s: Observation = 5.0,
    overwrite: Overwrite = False,
) -> None:
    """Make the boxes and spheres of an SI-RRT scene obstacles."""
    from suite.exchange.sirrt import import_sirrt

    setting = _setting(arm, start, goal, time_limit_s, observation_s)
    _write(out, [import_sirrt(file, setting, say)], overwrite=overwrite)


@importing.command()
def mesh(
    files: Annotated[list[Path], typer.Argument(help="Meshes: .stl or .obj.")],
    out: Out,
    unit: Unit = None,
    offset: Offset = "0,0,0",
    arm: Arm = "",
    start: Start = None,
    goal: Goal = None,
    time_limit_s: TimeLimit = 120.0,
    overwrite: Overwrite = False,
) -> None:
    """Make meshes obstacles that stand still: each connected piece becomes its convex hull."""
    from suite.exchange.layouts import UNITS_M
    from suite.exchange.meshes import import_mesh

    setting = _setting(arm, start, goal, time_limit_s, 5.0)
    where = _point("--offset", offset)
    bodies = [body for file in files for body in import_mesh(file, UNITS_M[unit or "m"], where)]
    say(f"{len(bodies)} convex pieces")
    _write(out, [setting.scenario(out.stem, bodies, "mesh")], overwrite=overwrite)


def _setting(arm: str, start: str | None, goal: str | None, time_limit_s: float, observation_s: float) -> Setting:
    from scenarios import ContinuumArm
    from suite.exchange.tracks import Setting

    return Setting(
        ContinuumArm.from_text(arm),
        None if start is None else _numbers("--start", start),
        None if goal is None else _point("--goal", goal),
        time_limit_s,
        observation_s,
    )


def _numbers(option: str, text: str) -> tuple[float, ...]:
    try:
        return tuple(float(part) for part in text.split(","))
    except ValueError:
        raise usage(f"{option}: found {text!r}, allowed numbers such as 0,0.1,0.3") from None


def _point(option: str, text: str) -> tuple[float, float, float]:
    numbers = _numbers(option, text)
    if len(numbers) != 3:
        raise usage(f"{option}: found {len(numbers)} numbers, allowed three: x,y,z")
    return numbers[0], numbers[1], numbers[2]


def _write(file: Path, made: Sequence[Scenario], *, overwrite: bool) -> None:
    from scenarios import save_scenarios, start_is_free

    if file.exists() and not overwrite:
        raise usage(f"{file}: found a file there, allowed with --overwrite")
    hit = [scenario.id for scenario in made if not start_is_free(scenario)]
    if hit:
        say(f"{hit[0]}: an obstacle touches the arm before t = 0" + (f", and {len(hit) - 1} more" if hit[1:] else ""))
    save_scenarios(file, made)
    print(f"{file}: {len(made)} scenarios, {max(len(scenario.obstacles) for scenario in made)} obstacles at most")
