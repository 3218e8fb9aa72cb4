"""Enumeration of an arm's configurations by the cube that holds their tip.

A configuration of n sections is coded as a number in base B: its digits, first section first, index the lattice of B
bends that every section shares.
"""

import math

import numpy as np

from scenarios.kernels.clearance import distance_to_arc
from scenarios.kernels.jit import kernel
from scenarios.kernels.kinematics import ARC_SIZE, MIN_BEND_RAD, place_section, section_arcs

UNKNOWN, FREE, HIT = 0, 1, 2


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


@kernel
def arc_table(bends, section_length):
    """What ``place_section`` needs of every lattice bend: (B, 5), so that no trigonometry is left in the loops."""
    out = np.empty((bends.shape[0], 5))
    for b in range(bends.shape[0]):
        bend = math.hypot(bends[b, 0], bends[b, 1])
        straight = bend < MIN_BEND_RAD
        out[b, 0] = 1.0 if straight else bends[b, 0] / bend
        out[b, 1] = 0.0 if straight else bends[b, 1] / bend
        bend = max(bend, MIN_BEND_RAD)
        out[b, 2], out[b, 3], out[b, 4] = section_length / bend, math.sin(bend), math.cos(bend)
    return out


@kernel
def section_hit(arc, centers, reach):
    """Whether a sphere of ``centers`` (m, 3) comes within ``reach`` (m,) of the backbone section ``arc`` [m]."""
    for j in range(centers.shape[0]):
        if distance_to_arc(arc, centers[j, 0], centers[j, 1], centers[j, 2]) <= reach[j]:
            return True
    return False


@kernel
def is_free(q, section_length, centers, reach, arcs):
    """Whether the arm at ``q`` (2n,) [rad] touches none of the spheres; ``arcs`` (n, ARC_SIZE) is work space."""
    section_arcs(q, section_length, arcs)
    for i in range(arcs.shape[0]):
        if section_hit(arcs[i], centers, reach):
            return False
    return True


@kernel
def memo_size(base, n):
    """Entries of a memo: one for each configuration of the first 1, 2, ..., n - 1 sections."""
    size, layer = 0, 1
    for _ in range(n - 1):
        layer *= base
        size += layer
    return size


@kernel
def is_code_free(code, n, table, centers, reach, memo, arcs):
    """Whether enumerated configuration ``code`` touches none of the spheres.

    Configurations of a cube share their first sections with thousands of others, so ``memo`` (``memo_size``,) int8
    keeps what was found out about the first sections at this instant.
    """
    base = table.shape[0]
    divisor = base ** (n - 1)
    begins, layer, free = 0, base, 0
    for m in range(1, n):
        seen = memo[begins + code // divisor]
        if seen == HIT:
            return False
        if seen == FREE:
            free = m
        begins += layer
        layer *= base
        divisor //= base
    divisor = base ** (n - 1)
    begins, layer = 0, base
    for i in range(n):
        prefix = code // divisor
        bend = table[prefix % base]
        place_section(arcs, i, bend[0], bend[1], bend[2], bend[3], bend[4])
        if i >= free:
            hit = section_hit(arcs[i], centers, reach)
            if i < n - 1:
                memo[begins + prefix] = HIT if hit else FREE
            if hit:
                return False
        begins += layer
        layer *= base
        divisor //= base
    return True
