"""Checked collision queries of an arm among moving spheres; a touch (clearance <= 0) is a collision."""

import math

import numpy as np
import numpy.typing as npt

from scenarios.arm import ContinuumArm, FloatArray
from scenarios.errors import ScenarioError
from scenarios.kernels import batch
from scenarios.kernels import clearance as kernels
from scenarios.world import SampledWorld, obstacles_at

# Advancing along a motion stops this close to contact (design: section 5's certificate).
CONTACT_TOLERANCE_M = 1e-4


def clearance(arm: ContinuumArm, q: npt.ArrayLike, time_s: float, world: SampledWorld) -> float:
    """Signed distance [m] from the arm's body to the nearest obstacle, negative inside; inf without obstacles.

    Args:
        arm: The arm.
        q: Configuration, shape (dof,), [rad].
        time_s: Instant at which the obstacles are taken [s].
        world: The obstacles.
    """
    return float(clearances(arm, np.atleast_2d(np.asarray(q, dtype=np.float64)), np.array([time_s]), world)[0])


def clearances(
    arm: ContinuumArm, configurations: npt.ArrayLike, times_s: npt.ArrayLike, world: SampledWorld
) -> FloatArray:
    """Signed distance (N,) [m] of each configuration (N, dof) [rad] at its own time (N,) [s].

    Raises:
        ScenarioError: Wrong shapes, numbers that are not finite, bends past the limit.
    """
    q = arm.check_configurations(configurations)
    times = np.ascontiguousarray(np.broadcast_to(np.asarray(times_s, dtype=np.float64), (len(q),)))
    if not np.isfinite(times).all():
        raise ScenarioError("times_s: found a number that is not finite, allowed finite seconds")
    distances: FloatArray = kernels.clearances(q, times, arm.section_length_m, arm.radius_m, world)
    return distances


def is_state_valid(arm: ContinuumArm, q: npt.ArrayLike, time_s: float, world: SampledWorld) -> bool:
    """Whether the arm at ``q`` (dof,) [rad] is free of every obstacle at ``time_s`` [s]."""
    return clearance(arm, q, time_s, world) > 0.0


def are_states_valid(
    arm: ContinuumArm, configurations: npt.ArrayLike, time_s: float, world: SampledWorld
) -> npt.NDArray[np.bool_]:
    """Whether each configuration (N, dof) [rad] is free of every obstacle at ``time_s`` [s]: (N,).

    Many times faster per state than ``is_state_valid``.

    Raises:
        ScenarioError: Wrong shapes, numbers that are not finite, bends past the limit.
    """
    q = arm.check_configurations(configurations)
    if not math.isfinite(time_s):
        raise ScenarioError(f"time_s: found {time_s}, allowed finite seconds")
    centers, radii = obstacles_at(world, time_s)
    free: npt.NDArray[np.bool_] = batch.states_free(q, arm.section_length_m, centers, radii + arm.radius_m)
    return free


def is_motion_valid(
    arm: ContinuumArm,
    q0: npt.ArrayLike,
    t0_s: float,
    q1: npt.ArrayLike,
    t1_s: float,
    world: SampledWorld,
    margin_m: float = 0.0,
) -> bool:
    """Whether the motion, linear in bending vectors, keeps more than ``margin_m`` clear at every instant.

    A proof by conservative advancement: True is certain, False may also mean that the clearance drops below
    ``margin_m`` + 0.1 mm.

    Raises:
        ScenarioError: ``t1_s`` before ``t0_s``, wrong shapes, bends past the limit.
    """
    ends = arm.check_configurations(np.stack([np.asarray(q0, dtype=np.float64), np.asarray(q1, dtype=np.float64)]))
    if not t1_s >= t0_s:
        raise ScenarioError(f"t1_s: found {t1_s}, allowed a time at or after t0_s = {t0_s}")
    share, _ = kernels.motion_clear_until(
        ends[0], t0_s, ends[1], t1_s, margin_m, CONTACT_TOLERANCE_M, arm.section_length_m, arm.radius_m, world
    )
    return bool(share >= 1.0)
