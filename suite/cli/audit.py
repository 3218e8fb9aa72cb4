"""Judge trajectories from anywhere."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from suite.cli.options import EXIT_FOUND, usage

if TYPE_CHECKING:
    from suite.auditor.command import Judged


def audit(
    files: Annotated[
        list[Path],
        typer.Argument(
            metavar="[TRAJECTORIES] SCENARIOS",
            help="CSV (scenario_id, planner, time_s, u1_rad, v1_rad, ...) and the file of the scenarios named there;"
            " with --points the scenario file alone.",
        ),
    ],
    points: Annotated[
        Path | None, typer.Option(help="Judge backbone points instead: NPZ of time_s, points_m, radius_m.")
    ] = None,
    scenario: Annotated[
        str | None, typer.Option(help="With --points: id of the scenario. [default: the only one in the file]")
    ] = None,
    engine: Annotated[
        Literal["certificate", "fcl"], typer.Option(help="Conservative advancement, or FCL sampled densely.")
    ] = "certificate",
    format: Annotated[
        Literal["text", "json", "csv"], typer.Option(help="A line for people, or a row with full numbers.")
    ] = "text",
    strict: Annotated[
        bool, typer.Option("--strict", help="Exit 1 when a trajectory violates any of the verdicts.")
    ] = False,
) -> None:
    """Judge trajectories from anywhere against the true motion of the obstacles."""
    from suite.auditor.command import audit_file, audit_points_file
    from suite.auditor.report import FORMATS, POINTS_FORMATS

    if len(files) != (2 if points is None else 1):
        allowed = "TRAJECTORIES SCENARIOS" if points is None else "the scenario file beside --points"
        raise usage(f"files: found {len(files)}, allowed {allowed}")
    violated = 0

    def counted(found: Iterable[Judged]) -> Iterator[Judged]:
        nonlocal violated
        for one in found:
            violated += not one.is_sound
            yield one

    if points is not None:
        judged = audit_points_file(points, files[0], scenario)
        violated = not (judged.audit.per_step.success and judged.audit.swept.success)
        lines: Iterable[str] = POINTS_FORMATS[format](judged)
    else:
        lines = FORMATS[format](counted(audit_file(files[0], files[1], engine)))
    for line in lines:
        print(line)
    if strict and violated:
        raise typer.Exit(EXIT_FOUND)
