"""The enumerated configuration space and the cubes-graph's vertices (paper, sections II-B and II-E).

The paper enumerates the C-space "with respect to some level of discretization" and maps each configuration to the
workspace cube that holds its tip. Here every section takes the same hexagonal lattice of bending vectors, which covers
the disc of allowed bends evenly; 0.5 rad gives 151 bends and reproduces the published workspace box.
"""

import functools
import hashlib
import math
import os
import shutil
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from planners.search.configurations import _kernels
from scenarios.arm import ContinuumArm, FloatArray
from scenarios.errors import ScenarioError
from scenarios.families.base import CUBE_M
from scenarios.kernels.jit import cache_folder, source_hash

MAX_CONFIGURATIONS = 100_000_000

IntArray = npt.NDArray[np.int32]


class EnumeratedSpace(NamedTuple):
    """Configurations of one arm grouped by the cube of their tip, in compressed rows over a dense grid of cubes.

    Cube (i, j, k) spans [i - half, i - half + 1] * ``cube_m`` on x, and so on; its number is (i * side + j) * side + k
    with side = 2 * half.
    """

    bends_rad: FloatArray
    """The lattice of bending vectors of one section, shape (B, 2), [rad]."""
    arc_table: FloatArray
    """Cosine and sine of theta, arc radius [m], sine and cosine of phi of every bend, shape (B, 5)."""
    n_sections: int
    cube_m: float
    half: int
    offsets: IntArray
    """Cube number c holds ``codes[offsets[c]:offsets[c + 1]]``; shape (side^3 + 1,)."""
    codes: IntArray
    """Configuration codes (base-B digits, first section first), shape (B^n,)."""

    def cube_of(self, point_m: FloatArray) -> int:
        """Number of the cube that holds a point (3,) [m], or of the nearest one when the point is off the grid."""
        edge_m = (self.half - 0.5) * self.cube_m
        x, y, z = (min(max(float(c), -edge_m), edge_m) for c in point_m)
        return int(_kernels.cube_of(x, y, z, self.cube_m, self.half))

    def center_m(self, cube: int) -> FloatArray:
        """Centre (3,) [m] of a cube."""
        index = np.array(np.unravel_index(cube, (2 * self.half,) * 3), dtype=np.float64)
        return np.asarray((index - self.half + 0.5) * self.cube_m)

    def configurations(self, cube: int) -> FloatArray:
        """Configurations (N, 2n) [rad] whose tips lie in a cube."""
        return self.decode(self.codes[self.offsets[cube] : self.offsets[cube + 1]])

    def decode(self, codes: IntArray) -> FloatArray:
        """Configurations (N, 2n) [rad] of codes (N,)."""
        digits = np.unravel_index(codes, (len(self.bends_rad),) * self.n_sections)
        return np.concatenate([self.bends_rad[digit] for digit in digits], axis=1)


def hexagonal_lattice(spacing_rad: float, max_bend_rad: float) -> FloatArray:
    """Bending vectors (B, 2) [rad] of a hexagonal lattice about (0, 0), within the disc of allowed bends."""
    reach = math.ceil(max_bend_rad / spacing_rad * 2.0)
    a, b = np.meshgrid(np.arange(-reach, reach + 1), np.arange(-reach, reach + 1), indexing="ij")
    points = spacing_rad * np.stack([a + b / 2.0, b * math.sqrt(3.0) / 2.0], axis=-1).reshape(-1, 2)
    return np.ascontiguousarray(points[np.hypot(points[:, 0], points[:, 1]) <= max_bend_rad + 1e-12])


def lattice_for(arm: ContinuumArm, spacing_rad: float) -> FloatArray:
    """The lattice of one section of ``arm``: bending vectors (B, 2) [rad].

    Raises:
        ScenarioError: The arm would have more than ``MAX_CONFIGURATIONS``.
    """
    bends = hexagonal_lattice(spacing_rad, arm.max_bend_rad)
    if len(bends) ** arm.n_sections > MAX_CONFIGURATIONS:
        raise ScenarioError(
            f"spacing_rad: found {spacing_rad} ({len(bends)} bends in each of {arm.n_sections} sections), "
            f"allowed a lattice of at most {MAX_CONFIGURATIONS} configurations: take a wider spacing"
        )
    return bends


def enumerated_space(arm: ContinuumArm, spacing_rad: float) -> EnumeratedSpace:
    """Enumerate ``arm``'s configurations, or map them from the cache when the same arm was enumerated before.

    The cache's key holds everything the result depends on, kernel sources included.

    Raises:
        ScenarioError: The lattice would hold more than ``MAX_CONFIGURATIONS``.
    """
    bends = lattice_for(arm, spacing_rad)
    half = _half(arm)
    source = source_hash(Path(_kernels.__file__))
    key = f"{source}/{bends.tobytes().hex()}/{arm.n_sections}/{arm.section_length_m}/{CUBE_M}"
    folder = cache_folder() / "configurations" / hashlib.sha256(key.encode()).hexdigest()[:16]
    table = _kernels.arc_table(bends, arm.section_length_m)
    return EnumeratedSpace(bends, table, arm.n_sections, CUBE_M, half, *_groups(folder, arm, spacing_rad))


@functools.lru_cache(maxsize=4)  # every trial asks
def _groups(folder: Path, arm: ContinuumArm, spacing_rad: float) -> tuple[IntArray, IntArray]:
    """Offsets and codes, out of the cache or into it."""
    found = _mapped(folder)
    if found is None:
        half = _half(arm)
        cubes = _kernels.enumerate_cubes(
            lattice_for(arm, spacing_rad), arm.n_sections, arm.section_length_m, CUBE_M, half
        )
        found = _kernels.group_by_cube(cubes, (2 * half) ** 3)
        _store(folder, *found)
    return _mapped(folder) or found


def _half(arm: ContinuumArm) -> int:
    """Cubes from the middle to the edge; with one to spare, a tip on the far face of the last still has a number."""
    return math.ceil(arm.length_m / CUBE_M) + 1


def _mapped(folder: Path) -> tuple[IntArray, IntArray] | None:
    """Offsets and codes, mapped, not read: worker processes share the pages. Kernels want plain arrays.

    None if they are not there, or cut off.
    """
    try:
        offsets, codes = (
            np.asarray(np.load(folder / f"{name}.npy", mmap_mode="r", allow_pickle=False))
            for name in ("offsets", "codes")
        )
    except (OSError, ValueError, EOFError):
        return None
    return (offsets, codes) if len(offsets) and offsets[-1] == len(codes) else None


def _store(folder: Path, offsets: IntArray, codes: IntArray) -> None:
    """Write the arrays so that another process sees all of them or none; on a full disk there are none."""
    scratch = folder.with_name(f"{folder.name}.{os.getpid()}")
    with suppress(OSError):
        scratch.mkdir(parents=True, exist_ok=True)
        np.save(scratch / "offsets.npy", offsets, allow_pickle=False)
        np.save(scratch / "codes.npy", codes, allow_pickle=False)
        if folder.is_dir() and _mapped(folder) is None:
            shutil.rmtree(folder)  # damaged; whoever has mapped it keeps what they have
        scratch.rename(folder)
    shutil.rmtree(scratch, ignore_errors=True)  # another process was first; its files are the same
