"""Meshes (STL, OBJ) as bodies that stand still: each connected piece becomes its convex hull.

A hull fills every hollow of its piece. That is on the safe side. So is what a hull of too many corners becomes: that of
a few of them, grown about its middle until it holds them all.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt
from pydantic import ValidationError

from scenarios import Mesh, Obstacle, Still
from scenarios.reading import open_regular, read_text
from suite.errors import SuiteError, one_line
from suite.exchange.text import MAX_FILE_BYTES

MAX_TRIANGLES = 2_000_000
MAX_PIECES = 1000
MAX_CORNERS = 200
"""Of a mesh in a scenario."""

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]


def import_mesh(file: Path, unit_m: float, offset_m: tuple[float, float, float]) -> list[Obstacle]:
    """The pieces of a mesh file, each a convex body at rest.

    Args:
        file: ``.stl``, text or binary, or ``.obj``.
        unit_m: Length of the file's unit [m].
        offset_m: Added to every corner [m].

    Raises:
        FileError: The file cannot be read.
        SuiteError: It is no mesh, or has a piece that is flat or too large.
    """
    triangles = _stl(file) if file.suffix.lower() == ".stl" else _obj(file)
    if not 0 < len(triangles) <= MAX_TRIANGLES:
        raise SuiteError(f"{file}: found {len(triangles)} triangles, allowed 1 to {MAX_TRIANGLES}")
    if not np.isfinite(triangles).all():
        raise SuiteError(f"{file}: found a number that is not finite, allowed finite ones")
    pieces = _pieces(unit_m * triangles + np.asarray(offset_m))
    if len(pieces) > MAX_PIECES:
        raise SuiteError(f"{file}: found {len(pieces)} pieces, allowed {MAX_PIECES}")
    return [_body(file, k, piece) for k, piece in enumerate(pieces, start=1)]


def _body(file: Path, number: int, points: FloatArray) -> Obstacle:
    from scipy.spatial import ConvexHull, QhullError

    try:
        corners = _few(points[ConvexHull(points).vertices])
    except QhullError:
        raise SuiteError(f"{file}: piece {number}: found a flat one, allowed pieces with a volume") from None
    middle = 0.5 * (corners.min(axis=0) + corners.max(axis=0))
    try:
        shape = Mesh(vertices_m=tuple(map(tuple, (corners - middle).tolist())))
        return Obstacle(shape=shape, motion=Still(point_m=tuple(middle.tolist())))
    except ValidationError as error:
        raise SuiteError(f"{file}: piece {number}: {one_line(error)}"[:300]) from None


def _few(corners: FloatArray) -> FloatArray:
    """Corners as they are, or ``MAX_CORNERS`` of them, far apart, grown about their middle so that all are held."""
    from scipy.spatial import ConvexHull

    if len(corners) <= MAX_CORNERS:
        return corners
    chosen = [0]
    apart = np.linalg.norm(corners - corners[0], axis=1)
    while len(chosen) < MAX_CORNERS:
        chosen.append(int(apart.argmax()))
        apart = np.minimum(apart, np.linalg.norm(corners - corners[chosen[-1]], axis=1))
    some = corners[chosen]
    middle = some.mean(axis=0)
    hull = ConvexHull(some)
    depths = -(hull.equations[:, :3] @ middle + hull.equations[:, 3])
    reach = ((corners - middle) @ hull.equations[:, :3].T).max(axis=0)
    return np.asarray(middle + max(1.0, float((reach / depths).max())) * (1.0 + 1e-9) * (some - middle))


def _pieces(triangles: FloatArray) -> list[FloatArray]:
    """Points of each connected piece: triangles (k, 3, 3) hang together where they share a corner."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    points, index = np.unique(triangles.reshape(-1, 3), axis=0, return_inverse=True)
    corners = index.reshape(-1, 3)
    rows, columns = corners[:, [0, 1]].reshape(-1), corners[:, [1, 2]].reshape(-1)
    links = coo_array((np.ones(len(rows)), (rows, columns)), shape=(len(points), len(points)))
    count, piece_of = connected_components(links, directed=False)
    return [points[piece_of == k] for k in range(count)]


def _stl(file: Path) -> FloatArray:
    """Triangles (k, 3, 3) of an STL file."""
    with open_regular(file, MAX_FILE_BYTES) as handle:
        data = handle.read()
    count = int.from_bytes(data[80:84], "little") if len(data) >= 84 else -1
    if len(data) == 84 + 50 * count:
        record = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("rest", "<u2")])
        return np.frombuffer(data, record, offset=84)["corners"].astype(np.float64)
    words = [line.split() for line in read_text(file, MAX_FILE_BYTES).splitlines()]
    corners = [_point(file, k, word[1:]) for k, word in enumerate(words, start=1) if word[:1] == ["vertex"]]
    if len(corners) % 3:
        raise SuiteError(f"{file}: found {len(corners)} corners, allowed three for each triangle (truncated?)")
    return np.array(corners, dtype=np.float64).reshape(-1, 3, 3)


def _obj(file: Path) -> FloatArray:
    """Triangles (k, 3, 3) of an OBJ file; faces of more corners are fans of them."""
    if file.suffix.lower() != ".obj":
        raise SuiteError(f"{file}: found suffix {file.suffix!r}, allowed .stl, .obj")
    points: list[list[float]] = []
    fans: list[tuple[int, int, int]] = []
    for line, content in enumerate(read_text(file, MAX_FILE_BYTES).splitlines(), start=1):
        word = content.split()
        if word[:1] == ["v"]:
            points.append(_point(file, line, word[1:4]))
        elif word[:1] == ["f"]:
            face = [_corner(file, line, text, len(points)) for text in word[1:]]
            fans += [(face[0], face[k], face[k + 1]) for k in range(1, len(face) - 1)]
    return np.array(points, dtype=np.float64).reshape(-1, 3)[np.array(fans, dtype=np.int64).reshape(-1, 3)]


def _point(file: Path, line: int, words: list[str]) -> list[float]:
    try:
        x, y, z = map(float, words)
    except ValueError:
        raise SuiteError(f"{file}: line {line}: found {' '.join(words)[:40]!r}, allowed three numbers") from None
    return [x, y, z]


def _corner(file: Path, line: int, text: str, points: int) -> int:
    """Index from 0 of a corner such as ``3/1/2``; negative ones count from the last point."""
    try:
        index = int(text.partition("/")[0])
    except ValueError:
        index = 0
    if not 1 <= (index if index > 0 else points + index + 1) <= points or index == 0:
        raise SuiteError(f"{file}: line {line}: found corner {text[:20]!r}, allowed one of the {points} points before")
    return index - 1 if index > 0 else points + index
