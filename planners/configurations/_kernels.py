"""Enumeration of an arm's configurations by the cube that holds their tip.

A configuration of n sections is coded as a number in base B: its digits, first section first, index the lattice of B
bends that every section shares.
"""

import numpy as np

from scenarios.kernels.jit import kernel
from scenarios.kernels.kinematics import ARC_SIZE, section_arcs


@kernel
def decode(code, bends, q):
    """Write the bending vectors of configuration ``code`` into ``q`` (2n,) [rad]."""
    for i in range(q.shape[0] // 2 - 1, -1, -1):
        digit = code % bends.shape[0]
        code //= bends.shape[0]
        q[2 * i], q[2 * i + 1] = bends[digit, 0], bends[digit, 1]


@kernel
def cube_of(x, y, z, cube, half):
    """Number of the cube that holds the point, in a grid of (2 half)^3 cubes centred on the base."""
    side = 2 * half
    i, j, k = int(np.floor(x / cube)) + half, int(np.floor(y / cube)) + half, int(np.floor(z / cube)) + half
    return (i * side + j) * side + k


@kernel
def enumerate_cubes(bends, n_sections, section_length, cube, half):
    """Cube of every configuration's tip, by code: (B^n,) int32."""
    out = np.empty(bends.shape[0] ** n_sections, dtype=np.int32)
    q, arcs = np.empty(2 * n_sections), np.empty((n_sections, ARC_SIZE))
    for code in range(out.shape[0]):
        decode(code, bends, q)
        section_arcs(q, section_length, arcs)
        tip = arcs[n_sections - 1]
        out[code] = cube_of(tip[12], tip[13], tip[14], cube, half)
    return out


@kernel
def group_by_cube(cubes, n_cubes):
    """Counting sort of codes by cube: offsets (n_cubes + 1,) and codes (N,), ascending within a cube."""
    offsets = np.zeros(n_cubes + 1, dtype=np.int32)
    for cube in cubes:
        offsets[cube + 1] += 1
    for k in range(n_cubes):
        offsets[k + 1] += offsets[k]
    filled = offsets[:-1].copy()
    codes = np.empty(cubes.shape[0], dtype=np.int32)
    for code in range(cubes.shape[0]):
        codes[filled[cubes[code]]] = code
        filled[cubes[code]] += 1
    return offsets, codes
