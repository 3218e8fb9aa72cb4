"""Judge trajectories from anywhere."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer


def audit(
    trajectories: Annotated[Path, typer.Argument(help="CSV: scenario_id, planner, time_s, u1_rad, v1_rad, ...")],
    scenarios: Annotated[Path, typer.Argument(help="Scenario file that holds every scenario named there.")],
    engine: Annotated[
        Literal["certificate", "fcl"], typer.Option(help="Conservative advancement, or FCL sampled densely.")
    ] = "certificate",
) -> None:
    """Judge trajectories from anywhere against the true motion of the obstacles."""
    from suite.auditor.command import audit_file

    for line in audit_file(trajectories, scenarios, engine):
        print(line)
