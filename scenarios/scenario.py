"""A scenario: everything that defines one planning problem among moving obstacles."""

import hashlib
import json
import math
from typing import Annotated, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, model_validator

from scenarios.arm import ContinuumArm
from scenarios.motion import FloatArray, Point
from scenarios.obstacle import Obstacle

STEP_S = 1.0
"""A step is one second (paper, section V)."""

_Bend = Annotated[float, Field(ge=-math.pi, le=math.pi, allow_inf_nan=False)]
_Finite = Annotated[float, Field(allow_inf_nan=False)]
_Name = Annotated[str, Field(min_length=1, max_length=120, pattern=r"^[A-Za-z0-9._-]+$")]


class Scenario(BaseModel):
    """One problem: bring the arm's tip from a start configuration to a goal point among moving obstacles.

    The obstacles are observed once per step for ``observation_s`` before t = 0 while the arm holds its start.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    schema_version: Literal[1] = 1
    id: _Name
    family: _Name = "custom"
    seed: int = Field(default=0, ge=0, lt=2**63)
    parameters: dict[str, _Finite] = Field(default_factory=dict, max_length=50, description="of the generator")
    arm: ContinuumArm = ContinuumArm()
    start_rad: tuple[_Bend, ...] = Field(description="start configuration (u1, v1, u2, v2, ...)")
    goal_m: Point = Field(description="where the tip is to go")
    goal_tolerance_m: float = Field(default=0.01, gt=0, le=1.0, allow_inf_nan=False)
    obstacles: tuple[Obstacle, ...] = Field(default=(), max_length=1000)
    time_limit_s: float = Field(default=120.0, ge=STEP_S, le=3600.0, allow_inf_nan=False)
    observation_s: float = Field(default=5.0, ge=4.0, le=100.0, multiple_of=STEP_S, allow_inf_nan=False)

    @model_validator(mode="after")
    def _start_fits_the_arm(self) -> "Scenario":
        if len(self.start_rad) != self.arm.dof:
            raise ValueError(f"start_rad has {len(self.start_rad)} numbers, the arm needs {self.arm.dof}")
        if not self.arm.within_bends(self.start).all():
            raise ValueError(f"start_rad bends a section past max_bend_rad = {self.arm.max_bend_rad:.6f}")
        return self

    @property
    def start(self) -> FloatArray:
        """Start configuration, shape (dof,), [rad]."""
        return np.array(self.start_rad)

    @property
    def goal(self) -> FloatArray:
        """Goal point, shape (3,), [m]."""
        return np.array(self.goal_m)

    @property
    def content_hash(self) -> str:
        """16 hexadecimal digits of everything that defines the problem; names and provenance do not count."""
        content = self.model_dump(mode="json", exclude={"id", "family", "seed", "parameters"})
        text = json.dumps(content, sort_keys=True, separators=(",", ":"))
        return hashlib.sha256(text.encode()).hexdigest()[:16]
