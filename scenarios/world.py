"""Obstacles as the kernels see them: spheres, sampled in time, of true or of predicted motion alike."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from scenarios.kernels.approach import fastest_approach
from scenarios.motion import FloatArray
from scenarios.obstacle import Obstacle


class SampledWorld(NamedTuple):
    """Spheres sampled at ``start_s + k * step_s``; linear in time between samples, at rest outside them."""

    start_s: float
    step_s: float
    centers_m: FloatArray
    """Centres, shape (T, m, 3) with T >= 2, [m]."""
    radii_m: FloatArray
    """Radii, shape (T, m), [m]; they may grow with time where a prediction becomes less certain."""
    speed_m_s: float
    """Fastest approach of any surface: the centre's speed plus the radius's growth."""


def make_world(start_s: float, step_s: float, centers_m: FloatArray, radii_m: FloatArray) -> SampledWorld:
    """Assemble a world from samples (T, m, 3) and radii (T, m) or (m,), deriving its speed.

    Raises:
        ValueError: Fewer than two samples, shapes that do not match, or a number that is not finite.
    """
    centers = np.ascontiguousarray(centers_m, dtype=np.float64)
    if centers.ndim != 3 or centers.shape[0] < 2 or centers.shape[2] != 3:
        raise ValueError(f"centers_m: found shape {centers.shape}, allowed (T >= 2, m, 3)")
    # A copy: a broadcast array is read-only, for which every kernel would be compiled once more.
    radii = np.empty(centers.shape[:2])
    radii[:] = radii_m
    approach = float(fastest_approach(centers, radii))
    if math.isnan(approach) or not step_s > 0:
        raise ValueError("world: samples must be finite and step_s positive")
    speed = approach / step_s
    return SampledWorld(float(start_s), float(step_s), centers, radii, speed)


def cover_world(
    obstacles: Sequence[Obstacle], start_s: float, step_s: float, centers_m: FloatArray, margins_m: npt.ArrayLike = 0.0
) -> SampledWorld:
    """Spheres that hold every obstacle, each grown by its margin; exact where all obstacles are spheres.

    Args:
        obstacles: What they look like; their motion is not looked at.
        start_s: Time of the first sample [s].
        step_s: Time between samples [s].
        centers_m: Where they are, shape (T, m, 3), [m].
        margins_m: By how much they are to be grown, broadcast to (T, m), [m].
    """
    margins = np.broadcast_to(np.asarray(margins_m, dtype=np.float64), centers_m.shape[:2])
    covers = [obstacle.cover for obstacle in obstacles]
    if not covers:
        return make_world(start_s, step_s, centers_m, np.empty(0))
    owners = np.repeat(np.arange(len(covers)), [len(cover.radii_m) for cover in covers])
    offsets = np.concatenate([cover.centers_m for cover in covers])
    radii = np.concatenate([cover.radii_m for cover in covers])
    return make_world(start_s, step_s, centers_m[:, owners] + offsets, radii + margins[:, owners])


def sample_times(start_s: float, end_s: float, step_s: float) -> FloatArray:
    """Two or more times from ``start_s`` on, every ``step_s``, the last at or after ``end_s``: (T,) [s]."""
    count = max(2, int(np.ceil((end_s - start_s) / step_s - 1e-9)) + 1)
    return start_s + step_s * np.arange(count, dtype=np.float64)


def positions(obstacles: Sequence[Obstacle], times_s: FloatArray) -> FloatArray:
    """True centres (T, m, 3) [m] at times (T,) [s]."""
    centers = np.empty((len(times_s), len(obstacles), 3))
    for j, obstacle in enumerate(obstacles):
        centers[:, j] = obstacle.position(times_s)
    return centers


def sample_world(obstacles: Sequence[Obstacle], start_s: float, end_s: float, step_s: float) -> SampledWorld:
    """Sample the true motion of spheres that hold ``obstacles`` over [start_s, end_s], every ``step_s``."""
    centers = positions(obstacles, sample_times(start_s, end_s, step_s))
    return cover_world(obstacles, start_s, step_s, centers)


def obstacles_at(world: SampledWorld, time_s: float) -> tuple[FloatArray, FloatArray]:
    """Centres (m, 3) and radii (m,) [m] at ``time_s`` [s]."""
    passed = float(np.clip((time_s - world.start_s) / world.step_s, 0.0, len(world.centers_m) - 1))
    k = min(int(passed), len(world.centers_m) - 2)
    before, after = 1.0 - (passed - k), passed - k
    centers = before * world.centers_m[k] + after * world.centers_m[k + 1]
    return centers, before * world.radii_m[k] + after * world.radii_m[k + 1]
