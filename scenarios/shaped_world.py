"""Obstacles of any shape, exactly: what decides where the spheres that hold them are hit.

The arm is cut into chords, each the core of a capsule as thick as the arm plus the arc's bow. FCL finds the direction
in which a chord and a shape are nearest; how far apart they are along it is then worked out here. FCL's own distances
err, by up to 7 mm for a capsule 10 cm from a cylinder; a gap between two planes is a proof, whichever way they face.
"""

from collections.abc import Sequence

import fcl
import numpy as np
import numpy.typing as npt

from scenarios.arm import ContinuumArm, FloatArray
from scenarios.collision import CONTACT_TOLERANCE_M
from scenarios.kernels import clearance as kernels
from scenarios.obstacle import Obstacle
from scenarios.shapes import Cover, Shape
from scenarios.world import SampledWorld, make_world, obstacles_at

_CHORDS = 24  # per section: an arc bows at most 0.1 mm over its chord
_THIN_M = 1e-6  # FCL's chords are as thin as its arithmetic bears: thickness is added outside, where it is exact
_ENOUGH_M = 0.01  # on the way along a motion, a gap that the cover proves and that is no smaller will do


class ShapedWorld:
    """Spheres and other shapes among the obstacles of one world, apart."""

    def __init__(self, spheres: SampledWorld, others: SampledWorld, shapes: Sequence[Shape]) -> None:
        """Place ``shapes`` at the centres of ``others``, whose radii are the margins by which the shapes are grown."""
        self._spheres, self._others, self._shapes = spheres, others, shapes
        covers = [shape.cover() for shape in shapes]
        counts = [len(cover.radii_m) for cover in covers]
        self._owners, self._firsts = np.repeat(np.arange(len(covers)), counts), np.cumsum([0, *counts[:-1]])
        self._cover = Cover(*(np.concatenate(parts) for parts in zip(*covers, strict=True)))
        # Shapes stay at the origin and chords come to them.
        self._objects = [fcl.CollisionObject(shape.geometry(), fcl.Transform(shape.rotation)) for shape in shapes]

    def clearance(self, arm: ContinuumArm, q: FloatArray, time_s: float) -> float:
        """Signed distance [m] of the arm at ``q`` (dof,) [rad] from the nearest obstacle, never overstated.

        Understated by the bow of an arc over its chord, 0.1 mm at most; inside a shape by more.
        """
        times = np.array([time_s])
        to_spheres = kernels.clearances(q[None], times, arm.section_length_m, arm.radius_m, self._spheres)[0]
        return float(min(to_spheres, self._gaps(arm, q, time_s, parts=1)[0]))

    def is_motion_valid(
        self, arm: ContinuumArm, q0: FloatArray, t0_s: float, q1: FloatArray, t1_s: float, margin_m: float = 0.0
    ) -> bool:
        """As ``scenarios.collision.is_motion_valid``: conservative advancement, now on the distance to shapes."""
        length = arm.section_length_m
        share, _ = kernels.motion_clear_until(
            q0, t0_s, q1, t1_s, margin_m, CONTACT_TOLERANCE_M, length, arm.radius_m, self._spheres
        )
        if share < 1.0:
            return False
        bounds = np.empty(arm.n_sections)
        kernels.motion_bounds(q0, q1, t1_s - t0_s, length, self._others.speed_m_s, bounds)
        share = 0.0
        while True:
            q, time_s = q0 + share * (q1 - q0), t0_s + share * (t1_s - t0_s)
            gaps = self._gaps(arm, q, time_s, parts=arm.n_sections, enough_m=_ENOUGH_M) - margin_m
            if (gaps <= CONTACT_TOLERANCE_M).any():
                return False
            if share >= 1.0 or not bounds.any():
                return True
            share = min(1.0, share + 1.0 / float((bounds / gaps).max()))

    def _gaps(
        self, arm: ContinuumArm, q: FloatArray, time_s: float, parts: int, enough_m: float = np.inf
    ) -> FloatArray:
        """Signed distance (parts,) [m] of equal parts of the arm from the nearest shape, never overstated.

        What the cover proves is improved upon, where it is smallest first, until the smallest has been looked into or
        is ``enough_m``.
        """
        points = arm.backbone_points(q, _CHORDS)
        middles, turns = 0.5 * (points[:-1] + points[1:]), _turns_z_to(np.diff(points, axis=0))
        core = fcl.CollisionObject(fcl.Capsule(_THIN_M, arm.section_length_m / _CHORDS))
        bow = arm.section_length_m * np.hypot(q[0::2], q[1::2]) / (8.0 * _CHORDS**2)  # at most: docs/audit.md
        thickness = arm.radius_m + np.repeat(bow, _CHORDS)
        centers, margins = obstacles_at(self._others, time_s)
        to_cover = _to_chords(points, centers[self._owners] + self._cover.centers_m) - self._cover.radii_m
        proven = np.minimum.reduceat(to_cover, self._firsts, axis=1) - thickness[:, None] - margins
        looked_into = np.zeros(proven.shape, dtype=np.bool_)
        per_part = len(middles) // parts
        gaps = np.empty(parts)
        for part in range(parts):
            mine = slice(part * per_part, (part + 1) * per_part)
            while True:
                chord, j = divmod(int(np.argmin(proven[mine])) + mine.start * len(self._shapes), len(self._shapes))
                gaps[part] = proven[chord, j]
                if looked_into[chord, j] or gaps[part] >= enough_m:
                    break
                looked_into[chord, j] = True
                core.setTransform(fcl.Transform(turns[chord], middles[chord] - centers[j]))
                direction = self._direction(core, j)
                if direction is None:
                    continue
                # The plane parts every chord from the shape, some better than what was known.
                beyond = points @ direction - (centers[j] @ direction + self._shapes[j].reach(direction))
                apart = np.minimum(beyond[:-1], beyond[1:]) - thickness - margins[j]
                proven[:, j] = np.maximum(proven[:, j], apart)
        return gaps

    def _direction(self, chord: fcl.CollisionObject, j: int) -> FloatArray | None:
        """Unit vector (3,) from shape ``j`` to ``chord`` where they are nearest; None where they meet."""
        request, result = fcl.DistanceRequest(enable_nearest_points=True), fcl.DistanceResult()
        if fcl.distance(chord, self._objects[j], request, result) <= 0.0:
            return None
        on_chord, on_shape = result.nearest_points
        away = on_chord - on_shape
        return np.asarray(away / np.linalg.norm(away))


def shaped_world(
    obstacles: Sequence[Obstacle], start_s: float, step_s: float, centers_m: FloatArray, margins_m: npt.ArrayLike = 0.0
) -> ShapedWorld | None:
    """Obstacles as they are, with the arguments of ``scenarios.world.cover_world``; None where all are spheres.

    Then the cover is exact already.
    """
    shapes = [obstacle.shape for obstacle in obstacles if obstacle.shape is not None]
    if not shapes:
        return None
    margins = np.broadcast_to(np.asarray(margins_m, dtype=np.float64), centers_m.shape[:2])
    is_sphere = np.array([obstacle.shape is None for obstacle in obstacles])
    radii = np.array([obstacle.radius_m for obstacle in obstacles])
    spheres = make_world(start_s, step_s, centers_m[:, is_sphere], (radii + margins)[:, is_sphere])
    others = make_world(start_s, step_s, centers_m[:, ~is_sphere], margins[:, ~is_sphere])
    return ShapedWorld(spheres, others, shapes)


def _to_chords(points: FloatArray, others: FloatArray) -> FloatArray:
    """Distance (C, K) [m] from each chord between ``points`` (C + 1, 3) to each of ``others`` (K, 3)."""
    along = np.diff(points, axis=0)
    to = others - points[:-1, None]
    shares = np.einsum("ckx,cx->ck", to, along) / np.einsum("cx,cx->c", along, along)[:, None]
    to -= np.clip(shares, 0.0, 1.0)[:, :, None] * along[:, None]
    return np.asarray(np.sqrt(np.einsum("ckx,ckx->ck", to, to)))


def _turns_z_to(directions: FloatArray) -> FloatArray:
    """Rotations (C, 3, 3) whose third columns point along ``directions`` (C, 3): FCL's capsules lie along z."""
    x, y, z = (directions / np.linalg.norm(directions, axis=1, keepdims=True)).T
    # Duff et al., Building an Orthonormal Basis, Revisited, JCGT 2017.
    sign = np.copysign(1.0, z)
    a = -1.0 / (sign + z)
    b = x * y * a
    columns = [1.0 + sign * x * x * a, sign * b, -sign * x, b, sign + y * y * a, -y, x, y, z]
    return np.stack(columns, axis=1).reshape(-1, 3, 3).transpose(0, 2, 1)
