"""Obstacles as the proofs see them: convex hulls of points, rounded, never larger than the obstacle.

A proof needs contact for certain, so a shape that is not such a hull is replaced by one inside it. Everything else in
``scenarios`` needs the opposite.
"""

from collections.abc import Sequence
from itertools import product
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from scenarios.motion import FloatArray
from scenarios.obstacle import Obstacle
from scenarios.shapes import Box, Capsule, Cylinder, Mesh

_CORNERS = np.array(list(product((-0.5, 0.5), repeat=3)))
_RIM = 24  # corners of the prism inside a cylinder, whose faces are 0.9 % of the radius nearer to the axis
_ROUNDING_PER_M = 1e-14  # of a law's evaluation, per metre of way run at its speed bound


class Hulls(NamedTuple):
    """m obstacles, each the points within a radius of the convex hull of some vertices about its centre."""

    vertices_m: FloatArray
    """All of them, shape (V, 3), [m]."""
    spans: npt.NDArray[np.int64]
    """First vertex of each obstacle and the one after its last, shape (m, 2)."""
    middles_m: FloatArray
    """Means of their vertices, shape (m, 3), [m]."""
    reaches_m: FloatArray
    """What is nearer to a hull than this touches an arm whose backbone it belongs to, shape (m,), [m]."""
    extents_m: FloatArray
    """Distance of the farthest vertex from the centre, shape (m,), [m]."""
    speeds_m_s: FloatArray
    """Speeds that are never exceeded, shape (m,); never 0."""


def pack_hulls(obstacles: Sequence[Obstacle], arm_radius_m: float, until_s: float) -> Hulls:
    """Pack ``obstacles`` for an arm of the given radius, to be followed until ``until_s`` [s]."""
    parts = [_rounded_hull(obstacle) for obstacle in obstacles]
    vertices = [corners for corners, _ in parts]
    ends = np.cumsum([0, *map(len, vertices)])
    speeds = np.array([obstacle.motion.speed_bound_m_s for obstacle in obstacles]) * (1.0 + 1e-9) + 1e-12
    radii = np.array([radius for _, radius in parts])
    return Hulls(
        vertices_m=np.concatenate([np.empty((0, 3)), *vertices]),
        spans=np.column_stack([ends[:-1], ends[1:]]).astype(np.int64),
        middles_m=np.array([corners.mean(axis=0) for corners in vertices]).reshape(-1, 3),
        reaches_m=radii + arm_radius_m - _ROUNDING_PER_M * speeds * until_s,
        extents_m=np.array([np.linalg.norm(corners, axis=1).max() for corners in vertices]),
        speeds_m_s=speeds,
    )


def _rounded_hull(obstacle: Obstacle) -> tuple[FloatArray, float]:
    """Vertices (V, 3) about the centre, in the world's axes, and the radius about their hull [m]."""
    shape, radius = obstacle.shape, 0.0
    match shape:
        case None:
            return np.zeros((1, 3)), obstacle.radius_m
        case Box():
            corners = _CORNERS * shape.size_m
        case Capsule():
            corners, radius = np.array([[0.0, 0.0, -0.5], [0.0, 0.0, 0.5]]) * shape.length_m, shape.radius_m
        case Cylinder():
            angles = 2.0 * np.pi / _RIM * np.arange(_RIM)
            ring = shape.radius_m * np.column_stack([np.cos(angles), np.sin(angles)])
            corners = np.concatenate([np.insert(ring, 2, end * shape.length_m, axis=1) for end in (-0.5, 0.5)])
        case Mesh():
            corners = np.array(shape.vertices_m)
    return corners @ shape.rotation.T, radius
