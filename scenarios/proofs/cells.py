"""The bends of a section, cut into square cells, and where its backbone runs at the middle of each."""

import functools
import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.spatial.transform import Rotation

from scenarios.motion import FloatArray
from scenarios.proofs.allowance import STRAY_RAD

POINTS = 24
"""Backbone points at which a section is looked at."""


class Cells(NamedTuple):
    """An N x N grid over the bending vectors (u, v) of a section, its middle cell about (0, 0)."""

    edge_rad: float
    middles_rad: FloatArray
    """Of the cells along either axis, shape (N,), [rad]."""
    allowed: npt.NDArray[np.bool_]
    """Cells of which some part is within the largest bend, ``STRAY_RAD`` included, shape (N, N); none outermost."""
    points_m: FloatArray
    """Backbone points at the cells' middles, in the section's base frame, shape (N, N, POINTS, 3), [m]."""
    shares: FloatArray
    """Where along the section they are, shape (POINTS,); the last is its end."""

    @property
    def half_rad(self) -> float:
        """How far a bending vector of a cell is from its middle at most, ``STRAY_RAD`` included."""
        return self.edge_rad / math.sqrt(2.0) + STRAY_RAD

    def around(self, bending_rad: FloatArray) -> npt.NDArray[np.bool_]:
        """Cells (N, N) that hold a bending vector (2,), rounding included."""
        u, v = (np.abs(self.middles_rad - value) <= 0.5 * self.edge_rad + 1e-9 for value in bending_rad)
        return np.outer(u, v)

    def offsets(self, rad: float) -> npt.NDArray[np.int64]:
        """Offsets (O, 2) between cells that are no farther apart than ``rad``; the nearest first."""
        far = int(np.ceil(rad / self.edge_rad)) + 1
        steps = np.arange(-far, far + 1)
        apart = np.maximum(np.abs(steps) - 1, 0) * self.edge_rad
        offsets = np.argwhere(np.hypot(apart[:, None], apart) <= rad + 1e-9) - far
        return np.ascontiguousarray(offsets[np.argsort(np.abs(offsets).sum(axis=1), kind="stable")])


@functools.lru_cache(maxsize=4)
def cells_of(length_m: float, max_bend_rad: float, per_radius: int) -> Cells:
    """Cells of a section; ``per_radius`` of them, side by side, are as long as the largest bend."""
    limit, far = max_bend_rad + STRAY_RAD, per_radius + 1
    edge = limit / per_radius
    middles = edge * np.arange(-far, far + 1, dtype=np.float64)
    nearest = np.maximum(np.abs(middles) - 0.5 * edge, 0.0)
    bends = np.stack(np.meshgrid(middles, middles, indexing="ij"), axis=-1)
    shares = np.arange(1, POINTS + 1) / POINTS
    return Cells(
        edge_rad=edge,
        middles_rad=middles,
        allowed=np.hypot(nearest[:, None], nearest) <= limit,
        points_m=np.ascontiguousarray(arc_points(bends[..., None, :] * shares[:, None]) * (length_m * shares)[:, None]),
        shares=shares,
    )


def arc_points(bendings_rad: FloatArray) -> FloatArray:
    """Ends (..., 3) of arcs of length 1 with bending vectors (..., 2) [rad], in their base frames."""
    half = 0.5 * np.linalg.norm(bendings_rad, axis=-1, keepdims=True)
    aside = 0.5 * np.sinc(half / np.pi) ** 2 * bendings_rad
    return np.concatenate([aside, np.sinc(2.0 * half / np.pi)], axis=-1)


def end_frames(bendings_rad: FloatArray) -> FloatArray:
    """Rotations (K, 3, 3) from the frames at the ends of arcs with bending vectors (K, 2) [rad] to their base's."""
    u, v = bendings_rad.T
    return np.asarray(Rotation.from_rotvec(np.column_stack([-v, u, np.zeros(len(u))])).as_matrix())
