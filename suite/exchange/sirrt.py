"""Scenes of SI-RRT's benchmark (an arm among boxes and spheres that move, ICAPS 2025) as scenarios.

Their robot is another: start and goal are joint angles of it, so both come from the setting here. Obstacles have a pose
per frame; here a body keeps its orientation, so a box that turns becomes the sphere about its centre that holds it.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from scenarios import Box, Obstacle, Scenario, Still, Track
from scenarios.reading import read_json
from suite.errors import SuiteError, one_line
from suite.exchange.text import MAX_FILE_BYTES
from suite.exchange.tracks import Setting

_Number = Annotated[float, Field(allow_inf_nan=False)]
_Pose = tuple[_Number, _Number, _Number, _Number, _Number, _Number, _Number]
"""Position [m] and quaternion x, y, z, w."""


class _Moving(BaseModel):
    model_config = ConfigDict(extra="ignore")

    name: str = ""
    type: Literal["static_box", "dynamic_box", "static_sphere", "dynamic_sphere"]
    positions: list[_Pose] = Field(min_length=1, max_length=100_000)
    dimensions: tuple[_Number, _Number, _Number] | None = None
    radius: _Number | None = None


class _Robot(BaseModel):
    model_config = ConfigDict(extra="ignore")

    type: Literal["dynamic_robot"]


class _Scene(BaseModel):
    model_config = ConfigDict(extra="ignore")

    fps: float = Field(gt=0, le=10_000)
    obstacles: list[Annotated[_Moving | _Robot, Field(discriminator="type")]] = Field(max_length=1000)


def import_sirrt(file: Path, setting: Setting, note: Callable[[str], None]) -> Scenario:
    """The scene in a file; its first frame is where the observation begins, so planners see some of it before t = 0.

    Args:
        file: JSON with fps and obstacles.
        setting: Arm, start, goal and times.
        note: Told, a line each, what is not the same here.

    Raises:
        FileError: The file cannot be read, or is no JSON.
        SuiteError: It is no such scene.
    """
    try:
        scene = _Scene.model_validate(read_json(file, MAX_FILE_BYTES))
    except ValidationError as error:
        raise SuiteError(f"{file}: {one_line(error)}"[:300]) from None
    moving = [one for one in scene.obstacles if isinstance(one, _Moving)]
    if len(moving) < len(scene.obstacles):
        note(f"{file}: {len(scene.obstacles) - len(moving)} robots among the obstacles are left out")
    turning = sum(_turns(one) for one in moving)
    if turning:
        note(f"{file}: {turning} boxes turn on their way; each is the sphere that holds it")
    try:
        obstacles = [_obstacle(one, scene.fps, setting.observation_s) for one in moving]
    except ValidationError as error:
        raise SuiteError(f"{file}: {one_line(error)}"[:300]) from None
    return setting.scenario(file.stem.replace(" ", "-")[:100], obstacles, "sirrt")


def _obstacle(one: _Moving, fps: float, observation_s: float) -> Obstacle:
    points = [pose[:3] for pose in one.positions]
    times = np.arange(len(points)) / fps - observation_s
    motion: Still | Track = Still(point_m=points[0])
    if one.type.startswith("dynamic"):
        motion = Track(times_s=tuple(times.tolist()), positions_m=tuple(points))
    if one.type.endswith("sphere"):
        if one.radius is None:
            raise SuiteError(f"{one.name}: found no radius, allowed one for a sphere")
        return Obstacle(radius_m=one.radius, motion=motion)
    if one.dimensions is None:
        raise SuiteError(f"{one.name}: found no dimensions, allowed three for a box")
    if _turns(one):
        return Obstacle(radius_m=0.5 * float(np.linalg.norm(one.dimensions)), motion=motion)
    return Obstacle(shape=Box(size_m=one.dimensions, rotation_rad=_rotation(one.positions[0])), motion=motion)


def _turns(one: _Moving) -> bool:
    """Whether a box changes its orientation; a quaternion and its negative are one."""
    if one.type != "dynamic_box":
        return False
    quaternions = np.array([pose[3:] for pose in one.positions])
    return bool((np.abs(quaternions @ quaternions[0]) < (1.0 - 1e-9) * (quaternions[0] @ quaternions[0])).any())


def _rotation(pose: _Pose) -> tuple[float, float, float]:
    from scipy.spatial.transform import Rotation

    quaternion = np.array(pose[3:])
    if not np.linalg.norm(quaternion) > 0.0:
        raise SuiteError("positions: found a quaternion of zeros, allowed one of length 1")
    x, y, z = Rotation.from_quat(quaternion).as_rotvec().tolist()
    return x, y, z
