"""What a search of the paper's planners is about: where the arm is, and the obstacles it is shown."""

import functools
import math
from typing import NamedTuple

import numpy as np

from planners.search.configurations import EnumeratedSpace
from planners.search.layers._kernels import change_table, changes_from
from scenarios.arm import ContinuumArm, FloatArray
from scenarios.scenario import STEP_S
from scenarios.world import SampledWorld


class ObstacleSteps(NamedTuple):
    """Where obstacles are at whole seconds from now on, ready for the kernels."""

    centers_m: FloatArray
    """Centres, shape (h + 1, m, 3), [m]; row 0 is now."""
    reach_m: FloatArray
    """Obstacle radius plus arm radius, shape (h + 1, m), [m]."""

    @classmethod
    def from_world(cls, world: SampledWorld, now_s: float, horizon: int, arm_radius_m: float) -> "ObstacleSteps":
        """Read rows now, now + 1 s, ..., now + ``horizon`` s out of a world sampled each second or finer."""
        last = len(world.centers_m) - 1
        passed = (now_s + STEP_S * np.arange(horizon + 1) - world.start_s) / world.step_s
        rows = np.clip(np.rint(passed).astype(int), 0, last)
        return cls(
            np.ascontiguousarray(world.centers_m[rows]), np.ascontiguousarray(world.radii_m[rows]) + arm_radius_m
        )


class Scene(NamedTuple):
    """What a solve is about, ready for the kernels."""

    q: FloatArray
    """Present configuration, shape (dof,), [rad]."""
    cube: int
    """Number of the cube that holds its tip."""
    now_s: float
    space: EnumeratedSpace
    steps: ObstacleSteps
    """Obstacles at whole steps."""
    world: SampledWorld
    """The same obstacles at every instant."""
    section_length: float
    arm_radius: float
    bend_rate: float
    """Limit on every motion, inf where limits do not bind [rad/s]."""
    tip_speed: float
    """The same for the tip [m/s]."""
    changes: FloatArray
    """Orientation change between all lattice bends, shape (B, B), [rad]."""
    changes_now: FloatArray
    """The same from each section's present bend, shape (n, B + 1), [rad]."""

    @property
    def horizon(self) -> int:
        """Number of steps ahead, h."""
        return len(self.steps.centers_m) - 1


def scene_of(
    arm: ContinuumArm,
    space: EnumeratedSpace,
    q: FloatArray,
    now_s: float,
    world: SampledWorld,
    horizon: int,
    limits: bool = False,
) -> Scene:
    """Lay out a solve of ``horizon`` steps.

    Args:
        arm: The arm.
        space: Its enumerated configurations.
        q: Present configuration, shape (dof,), [rad].
        now_s: Present time [s].
        world: Obstacles from now on.
        horizon: Steps ahead.
        limits: Whether motions are held to the arm's rates.
    """
    return Scene(
        q,
        space.cube_of(arm.tip(q)),
        float(now_s),
        space,
        ObstacleSteps.from_world(world, now_s, horizon, arm.radius_m),
        world,
        arm.section_length_m,
        arm.radius_m,
        arm.max_bend_rate_rad_s if limits else math.inf,
        arm.max_tip_speed_m_s if limits else math.inf,
        _change_table(space.bends_rad.tobytes()),
        changes_from(q, space.bends_rad),
    )


def frozen(world: SampledWorld) -> SampledWorld:
    """The obstacles as they are at the first sample, at rest: the view of a planner that does not predict."""
    centers, radii = np.repeat(world.centers_m[:1], 2, axis=0), np.repeat(world.radii_m[:1], 2, axis=0)
    return SampledWorld(world.start_s, world.step_s, centers, radii, 0.0)


def without_obstacles(world: SampledWorld) -> SampledWorld:
    """The same span of time with nothing in it."""
    rows = len(world.centers_m)
    return SampledWorld(world.start_s, world.step_s, np.empty((rows, 0, 3)), np.empty((rows, 0)), 0.0)


@functools.lru_cache(maxsize=8)
def _change_table(bends: bytes) -> FloatArray:
    """Orientation changes between all lattice bends, computed once per lattice."""
    table: FloatArray = change_table(np.frombuffer(bends).reshape(-1, 2))
    return table
