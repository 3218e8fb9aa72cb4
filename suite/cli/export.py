"""Write a run for other tools."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from suite.cli.options import Run, usage


def export(
    run: Run,
    kind: Annotated[
        Literal["planner-arena", "ros", "points", "parquet"],
        typer.Argument(
            help="Trials as a database for Planner Arena or as parquet; a motion as a ROS JointTrajectory (YAML) or as"
            " backbone points (NPZ)."
        ),
    ],
    file: Annotated[Path, typer.Argument(help="File to write.")],
    scenario: Annotated[str | None, typer.Option(help="Scenario of the motion, by its id.")] = None,
    planner: Annotated[str | None, typer.Option(help="Planner of the motion, by its label.")] = None,
    joints: Annotated[
        Literal["lengths", "bending"], typer.Option(help="Joints of a ROS trajectory: actuators or bending vectors.")
    ] = "lengths",
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace the file if it is there.")] = False,
) -> None:
    """Write trials or a motion of a run in a form that other tools read."""
    from suite.api import load
    from suite.exchange.motions import joint_trajectory, write_points, write_ros
    from suite.exchange.trials import write_parquet, write_planner_arena_of

    if file.exists() and not overwrite:
        raise usage(f"{file}: found a file there, allowed with --overwrite")
    if not file.parent.is_dir():
        raise usage(f"{file}: found no folder {str(file.parent)!r}, allowed one that is there")
    read = load(run)
    if kind == "planner-arena":
        write_planner_arena_of(run, read.trials, file)
    elif kind == "parquet":
        write_parquet(read.trials, file)
    else:
        if scenario is None or planner is None:
            raise usage(f"--{'planner' if scenario else 'scenario'}: found nothing, allowed the one whose motion it is")
        arm, motion = read.scenario(scenario).arm, read.trajectory(scenario, planner)
        if not len(motion.times_s):
            raise usage(f"{run}: found no motion of {planner!r} on {scenario!r}: the planner failed before it moved")
        if kind == "ros":
            write_ros(file, joint_trajectory(arm, motion.times_s, motion.configurations_rad, joints))
        else:
            write_points(file, arm, motion.times_s, motion.configurations_rad)
    print(file)
