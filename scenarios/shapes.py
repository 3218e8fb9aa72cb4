"""Shapes of obstacles that are no spheres: convex bodies that keep their orientation while their centre moves.

A new shape is one subclass of ``Body`` and one entry in ``Shape``. Three questions are all that collision checks ask of
it: which spheres hold it, how far it reaches along a direction, and what FCL calls it.

SciPy is imported where it is used: it takes a tenth of a second, and spheres do not need it.
"""

import functools
from abc import ABC, abstractmethod
from typing import Annotated, Literal, NamedTuple

import fcl
import numpy as np
import numpy.typing as npt
from pydantic import BaseModel, ConfigDict, Field, field_validator

from scenarios.motion import FloatArray, Point

_Size = Annotated[float, Field(gt=0, le=5.0, allow_inf_nan=False)]
_Local = Annotated[float, Field(ge=-5.0, le=5.0, allow_inf_nan=False)]

_CELLS = 4  # a cover has at most this many spheres along an axis of its shape


class Cover(NamedTuple):
    """Spheres that together hold a shape, about the shape's centre."""

    centers_m: FloatArray
    """Shape (k, 3), [m]."""
    radii_m: FloatArray
    """Shape (k,), [m]."""


class Body(BaseModel, ABC):
    """A convex shape about its own origin, turned into the world's axes by ``rotation_rad``."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    rotation_rad: Point = Field(default=(0.0, 0.0, 0.0), description="rotation vector: axis times angle")

    @property
    def rotation(self) -> FloatArray:
        """Rotation matrix (3, 3) from the shape's axes to the world's."""
        return _rotation(self.rotation_rad)

    @property
    @abstractmethod
    def bounding_radius_m(self) -> float:
        """Radius of a sphere about the origin that holds the shape."""

    @abstractmethod
    def local_cover(self) -> Cover:
        """Spheres that hold the shape, in its own axes."""

    @abstractmethod
    def local_reach(self, direction: FloatArray) -> float:
        """Largest component [m] of the shape's points along a unit ``direction`` (3,), in its own axes."""

    @abstractmethod
    def geometry(self) -> fcl.CollisionGeometry:
        """The shape in its own axes, as FCL knows it."""

    def cover(self) -> Cover:
        """Spheres that hold the shape, in the world's axes."""
        return _cover(self)

    def reach(self, direction: FloatArray) -> float:
        """Largest component [m] of the shape's points along a unit ``direction`` (3,), in the world's axes."""
        return self.local_reach(direction @ self.rotation)


class Box(Body):
    """A box about its centre."""

    kind: Literal["box"] = "box"
    size_m: tuple[_Size, _Size, _Size] = Field(description="lengths of its edges")

    @property
    def bounding_radius_m(self) -> float:
        """Half the diagonal."""
        return 0.5 * float(np.linalg.norm(self.size_m))

    def local_cover(self) -> Cover:
        """See ``Body``."""
        half = 0.5 * np.array(self.size_m)
        return _box_cover(-half, half)

    def local_reach(self, direction: FloatArray) -> float:
        """See ``Body``."""
        return 0.5 * float(np.abs(direction) @ self.size_m)

    def geometry(self) -> fcl.CollisionGeometry:
        """See ``Body``."""
        return fcl.Box(*self.size_m)


class Capsule(Body):
    """Everything within ``radius_m`` of a segment along z about the centre."""

    kind: Literal["capsule"] = "capsule"
    radius_m: _Size
    length_m: _Size = Field(description="of the segment; the whole capsule is longer by twice the radius")

    @property
    def bounding_radius_m(self) -> float:
        """Half the whole length."""
        return 0.5 * self.length_m + self.radius_m

    def local_cover(self) -> Cover:
        """See ``Body``."""
        return _row_cover(self.radius_m, self.length_m, with_caps=True)

    def local_reach(self, direction: FloatArray) -> float:
        """See ``Body``."""
        return 0.5 * self.length_m * abs(float(direction[2])) + self.radius_m

    def geometry(self) -> fcl.CollisionGeometry:
        """See ``Body``."""
        return fcl.Capsule(self.radius_m, self.length_m)


class Cylinder(Body):
    """A cylinder along z about the centre."""

    kind: Literal["cylinder"] = "cylinder"
    radius_m: _Size
    length_m: _Size

    @property
    def bounding_radius_m(self) -> float:
        """Distance of the rims."""
        return float(np.hypot(self.radius_m, 0.5 * self.length_m))

    def local_cover(self) -> Cover:
        """See ``Body``."""
        return _row_cover(self.radius_m, self.length_m, with_caps=False)

    def local_reach(self, direction: FloatArray) -> float:
        """See ``Body``."""
        x, y, z = direction
        return self.radius_m * float(np.hypot(x, y)) + 0.5 * self.length_m * abs(float(z))

    def geometry(self) -> fcl.CollisionGeometry:
        """See ``Body``."""
        return fcl.Cylinder(self.radius_m, self.length_m)


class Mesh(Body):
    """The convex hull of points given about the centre, which need not lie inside."""

    kind: Literal["mesh"] = "mesh"
    vertices_m: tuple[tuple[_Local, _Local, _Local], ...] = Field(min_length=4, max_length=200)

    @field_validator("vertices_m")
    @classmethod
    def _spans_a_volume(cls, vertices: tuple[Point, ...]) -> tuple[Point, ...]:
        from scipy.spatial import ConvexHull, QhullError

        try:
            ConvexHull(vertices)
        except QhullError:
            raise ValueError("4 or more points that are not all in one plane") from None
        return vertices

    @property
    def bounding_radius_m(self) -> float:
        """Distance of the farthest vertex."""
        return float(np.linalg.norm(self.vertices_m, axis=1).max())

    def local_cover(self) -> Cover:
        """See ``Body``."""
        vertices = np.array(self.vertices_m)
        return _box_cover(vertices.min(axis=0), vertices.max(axis=0))

    def local_reach(self, direction: FloatArray) -> float:
        """See ``Body``."""
        return float((np.array(self.vertices_m) @ direction).max())

    def geometry(self) -> fcl.CollisionGeometry:
        """See ``Body``."""
        points, faces = self.hull()
        counted = np.column_stack([np.full(len(faces), 3), faces])
        return fcl.Convex(points, len(faces), counted.reshape(-1))

    def hull(self) -> tuple[FloatArray, npt.NDArray[np.int64]]:
        """Corners (k, 3) [m] of the hull, and of each triangle (n, 3) which, counter-clockwise seen from outside."""
        from scipy.spatial import ConvexHull

        vertices = np.array(self.vertices_m)
        hull = ConvexHull(vertices)
        used, corners = np.unique(hull.simplices, return_inverse=True)
        points, faces = vertices[used], corners.reshape(-1, 3)
        a, b, c = (points[faces[:, k]] for k in range(3))
        inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), hull.equations[:, :3]) < 0
        faces[inward] = faces[inward, ::-1]
        return points, faces


Shape = Annotated[Box | Capsule | Cylinder | Mesh, Field(discriminator="kind")]


@functools.lru_cache(maxsize=1024)
def _rotation(vector: Point) -> FloatArray:
    from scipy.spatial.transform import Rotation

    return np.asarray(Rotation.from_rotvec(vector).as_matrix())


@functools.lru_cache(maxsize=1024)
def _cover(shape: Body) -> Cover:
    centers, radii = shape.local_cover()
    if shape.bounding_radius_m <= radii.max():
        return Cover(np.zeros((1, 3)), np.array([shape.bounding_radius_m]))
    return Cover(centers @ shape.rotation.T, radii)


def _box_cover(low: FloatArray, high: FloatArray) -> Cover:
    """A grid of spheres, each about a cell of the box between two corners (3,); cells are nearly cubes."""
    size = high - low
    counts = np.clip(np.rint(size / size.min()), 1, _CELLS).astype(int)
    shares = np.stack(np.meshgrid(*((np.arange(n) + 0.5) / n for n in counts), indexing="ij"), axis=-1)
    centers = low + shares.reshape(-1, 3) * size
    return Cover(centers, np.full(len(centers), 0.5 * np.linalg.norm(size / counts)))


def _row_cover(radius: float, length: float, with_caps: bool) -> Cover:
    """Equal spheres in a row along z, each about a slice of the cylinder.

    The caps of a capsule take spheres at both ends of its segment; without caps the end slices are whole ones.
    """
    slices = int(np.clip(np.rint(length / (2.0 * radius)), 1, _CELLS))
    z = np.linspace(-0.5, 0.5, slices + 1) if with_caps else (np.arange(slices) + 0.5) / slices - 0.5
    centers = np.column_stack([np.zeros((len(z), 2)), length * z])
    return Cover(centers, np.full(len(z), np.hypot(radius, 0.5 * length / slices)))
