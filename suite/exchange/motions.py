"""Executed motions for other tools: ROS trajectories, and backbone points for simulators."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Literal

import numpy as np
import numpy.typing as npt
import yaml

from scenarios import ContinuumArm
from suite.errors import SuiteError

POINTS_PER_SECTION = 20

FloatArray = npt.NDArray[np.float64]


def joint_trajectory(
    arm: ContinuumArm, times_s: FloatArray, configurations_rad: FloatArray, what: Literal["lengths", "bending"]
) -> dict[str, Any]:
    """The fields of a ROS message ``trajectory_msgs/JointTrajectory``.

    Args:
        arm: The arm.
        times_s: Times from the start, shape (k,), [s].
        configurations_rad: Bending vectors, shape (k, dof), [rad].
        what: Joints are the length changes of the actuators, three per section [m], or bending vectors [rad].
    """
    if what == "lengths":
        names = [f"l{i}_section{section}" for section in range(1, arm.n_sections + 1) for i in (1, 2, 3)]
        positions = [arm.lengths_from_bending(q).reshape(-1) for q in configurations_rad]
    else:
        names = [f"{axis}_section{section}" for section in range(1, arm.n_sections + 1) for axis in "uv"]
        positions = list(configurations_rad)
    points = [
        {
            "positions": position.tolist(),
            "velocities": [],
            "accelerations": [],
            "effort": [],
            "time_from_start": _duration(time_s),
        }
        for time_s, position in zip(times_s.tolist(), positions, strict=True)
    ]
    header = {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": "base"}
    return {"header": header, "joint_names": names, "points": points}


def _duration(time_s: float) -> dict[str, int]:
    seconds, rest = divmod(round(time_s * 1e9), 10**9)
    return {"sec": seconds, "nanosec": rest}


def write_ros(file: Path, trajectory: dict[str, Any]) -> None:
    """Write a trajectory as YAML.

    Raises:
        SuiteError: The file cannot be written.
    """
    with _writing(file):
        file.write_text(yaml.dump(trajectory, Dumper=yaml.CSafeDumper, sort_keys=False, default_flow_style=None))


def write_points(file: Path, arm: ContinuumArm, times_s: FloatArray, configurations_rad: FloatArray) -> None:
    """Write an NPZ of ``time_s`` (T,), ``points_m`` (T, N, 3) along the backbone, base first, and ``radius_m``.

    Raises:
        SuiteError: The file cannot be written.
    """
    points = [arm.backbone_points(q, POINTS_PER_SECTION) for q in configurations_rad]
    with _writing(file), file.open("wb") as handle:
        np.savez(handle, time_s=times_s, points_m=np.array(points), radius_m=np.array(arm.radius_m))


@contextmanager
def _writing(file: Path) -> Iterator[None]:
    """Make one line of what goes wrong.

    Raises:
        SuiteError: The file cannot be written.
    """
    try:
        yield
    except OSError as error:
        raise SuiteError(f"{file}: cannot be written: {error.strerror}") from None
