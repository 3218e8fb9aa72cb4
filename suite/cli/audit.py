"""Judge trajectories from anywhere."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from suite.cli.options import EXIT_FOUND

if TYPE_CHECKING:
    from suite.auditor.command import Judged


def audit(
    trajectories: Annotated[Path, typer.Argument(help="CSV: scenario_id, planner, time_s, u1_rad, v1_rad, ...")],
    scenarios: Annotated[Path, typer.Argument(help="Scenario file that holds every scenario named there.")],
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
    from suite.auditor.command import audit_file
    from suite.auditor.report import FORMATS

    violated = 0

    def counted(found: Iterable[Judged]) -> Iterator[Judged]:
        nonlocal violated
        for one in found:
            violated += not one.is_sound
            yield one

    for line in FORMATS[format](counted(audit_file(trajectories, scenarios, engine))):
        print(line)
    if strict and violated:
        raise typer.Exit(EXIT_FOUND)
