"""The obstacles' shapes, packed into plain arrays for the audit's kernels."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from scenarios import Box, Capsule, Cylinder, Mesh, Obstacle
from suite.auditor.shapes._kernels import BOX, CAPSULE, CYLINDER, MESH, SPHERE

FloatArray = npt.NDArray[np.float64]


class Bodies(NamedTuple):
    """m shapes about their own centres; a mesh is a span of triangles."""

    kinds: npt.NDArray[np.int64]
    """SPHERE, BOX, CAPSULE, CYLINDER or MESH, shape (m,)."""
    turns: FloatArray
    """Rotations from a shape's axes to the world's, shape (m, 3, 3)."""
    sizes_m: FloatArray
    """Half edges of a box; radius and half length of a capsule or cylinder; radius of a sphere; shape (m, 3)."""
    planes: FloatArray
    """Outward unit normals and offsets of triangles, shape (F, 4)."""
    faces_m: FloatArray
    """Corners of triangles, counter-clockwise from outside, shape (F, 3, 3)."""
    spans: npt.NDArray[np.int64]
    """First triangle and the one after the last, shape (m, 2)."""


def pack_shapes(obstacles: Sequence[Obstacle]) -> Bodies:
    """Pack what the obstacles look like."""
    kinds, sizes, planes, faces, spans, count = [], [], [np.empty((0, 4))], [np.empty((0, 3, 3))], [], 0
    for obstacle in obstacles:
        shape, first = obstacle.shape, count
        match shape:
            case Box():
                kind, size = BOX, [0.5 * edge for edge in shape.size_m]
            case Capsule():
                kind, size = CAPSULE, [shape.radius_m, 0.5 * shape.length_m, 0.0]
            case Cylinder():
                kind, size = CYLINDER, [shape.radius_m, 0.5 * shape.length_m, 0.0]
            case Mesh():
                kind, size = MESH, [0.0, 0.0, 0.0]
                normals, corners = _triangles(np.array(shape.vertices_m))
                planes.append(normals)
                faces.append(corners)
                count += len(normals)
            case None:
                kind, size = SPHERE, [obstacle.radius_m, 0.0, 0.0]
        kinds.append(kind)
        sizes.append(size)
        spans.append((first, count))
    vectors = [obstacle.shape.rotation_rad if obstacle.shape else (0.0, 0.0, 0.0) for obstacle in obstacles]
    return Bodies(
        kinds=np.array(kinds, dtype=np.int64),
        turns=_turns(np.array(vectors).reshape(-1, 3)),
        sizes_m=np.array(sizes, dtype=np.float64).reshape(-1, 3),
        planes=np.concatenate(planes),
        faces_m=np.concatenate(faces),
        spans=np.array(spans, dtype=np.int64).reshape(-1, 2),
    )


def _turns(vectors: FloatArray) -> FloatArray:
    """Rotation matrices (m, 3, 3) of rotation vectors (m, 3)."""
    if not vectors.any():  # SciPy takes a tenth of a second to import, and spheres do not turn
        return np.tile(np.eye(3), (len(vectors), 1, 1))
    from scipy.spatial.transform import Rotation

    return np.asarray(Rotation.from_rotvec(vectors).as_matrix())


def _triangles(vertices: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Planes (F, 4) and corners (F, 3, 3) of the hull's triangles."""
    from scipy.spatial import ConvexHull

    hull = ConvexHull(vertices)
    corners = vertices[hull.simplices]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    inward = np.einsum("fk,fk->f", normals, hull.equations[:, :3]) < 0.0
    corners[inward] = corners[inward, ::-1]
    return hull.equations, corners
