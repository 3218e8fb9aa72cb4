"""Signed distance to shapes, and the clearance of an arm, from dense points in plain NumPy."""

import numpy as np
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from twins.kinematics import backbone


def signed_distance(shape, points):
    """Signed distance (N,) of points (N, 3) given about the shape's centre, in the world's axes."""
    local = Rotation.from_rotvec(shape.rotation_rad).inv().apply(points)
    return {"box": _box, "capsule": _capsule, "cylinder": _cylinder, "mesh": _mesh}[shape.kind](shape, local)


def _rounded(beyond):
    return np.linalg.norm(np.maximum(beyond, 0), axis=1) + np.minimum(beyond.max(axis=1), 0)


def _box(shape, points):
    return _rounded(np.abs(points) - np.array(shape.size_m) / 2)


def _capsule(shape, points):
    nearest = np.clip(points[:, 2], -shape.length_m / 2, shape.length_m / 2)
    return np.linalg.norm(points - np.outer(nearest, [0, 0, 1]), axis=1) - shape.radius_m


def _cylinder(shape, points):
    across = np.hypot(points[:, 0], points[:, 1]) - shape.radius_m
    return _rounded(np.column_stack([across, np.abs(points[:, 2]) - shape.length_m / 2]))


def _mesh(shape, points):
    vertices = np.array(shape.vertices_m)
    hull = ConvexHull(vertices)
    inside = (points @ hull.equations[:, :3].T + hull.equations[:, 3]).max(axis=1)
    away = np.min([_to_triangle(vertices[corners], points) for corners in hull.simplices], axis=0)
    return np.where(inside <= 0, inside, away)


def _to_triangle(corners, points):
    """Where the foot on the plane lies within the triangle, the foot; else the nearest point of an edge."""
    a, b, c = corners
    edges = [_to_segment(a, b, points), _to_segment(b, c, points), _to_segment(c, a, points)]
    foot = np.linalg.lstsq(np.column_stack([b - a, c - a]), (points - a).T, rcond=None)[0]
    off = np.linalg.norm(a + foot.T @ np.array([b - a, c - a]) - points, axis=1)
    within = (foot >= 0).all(axis=0) & (foot.sum(axis=0) <= 1)
    return np.where(within, off, np.min(edges, axis=0))


def _to_segment(a, b, points):
    shares = np.clip((points - a) @ (b - a) / ((b - a) @ (b - a)), 0, 1)
    return np.linalg.norm(points - a - np.outer(shares, b - a), axis=1)


def shaped_clearance(q, length, arm_radius, shapes, centers, per_section=400):
    """Clearance of the sampled backbone from ``shapes`` about ``centers`` (m, 3): too large by a spacing's half."""
    points = backbone(q, length, per_section)
    gaps = [signed_distance(shape, points - center).min() for shape, center in zip(shapes, centers, strict=True)]
    return min(gaps) - arm_radius
