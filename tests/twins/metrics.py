"""Quality of a motion, state by state and slowly: the tip by SciPy rotations, angles by complex numbers."""

import cmath
import itertools
import math

import numpy as np
from scipy.spatial.transform import Rotation

CHORDS = 3000


def tips(configurations, length: float):
    """Tips (N, 3) of configurations (N, dof), section by section."""
    frame = Rotation.from_rotvec(np.zeros((len(configurations), 3)))
    points = np.zeros((len(configurations), 3))
    for u, v in np.moveaxis(np.reshape(configurations, (len(configurations), -1, 2)), (0, 1, 2), (2, 0, 1)):
        phi = np.hypot(u, v)
        # (1 - cos phi) / phi^2 and sin phi / phi, straight sections included.
        side = 0.5 * np.sinc(phi / (2 * np.pi)) ** 2
        local = length * np.column_stack([side * u, side * v, np.sinc(phi / np.pi)])
        points = points + frame.apply(local)
        frame = frame * Rotation.from_rotvec(np.column_stack([-v, u, np.zeros_like(u)]))
    return points


def tip_path_length(configurations, length: float) -> float:
    """Length of the tip's path by very many chords per interval: short by at most some 1e-5 of it."""
    total = 0.0
    for before, after in itertools.pairwise(np.asarray(configurations)):
        shares = np.linspace(0.0, 1.0, CHORDS + 1)[:, None]
        total += np.linalg.norm(np.diff(tips(before + shares * (after - before), length), axis=0), axis=1).sum()
    return total


def smoothness_paper(configurations) -> float:
    """Section II-D, letter by letter: the turn is the angle of z1 / z0, so it is wrapped whatever the planes are."""
    total = 0.0
    for before, after in itertools.pairwise(configurations):
        for (u0, v0), (u1, v1) in zip(np.reshape(before, (-1, 2)), np.reshape(after, (-1, 2)), strict=True):
            z0, z1 = complex(u0, v0), complex(u1, v1)
            turn = cmath.phase(z1 / z0) if min(abs(z0), abs(z1)) >= 1e-9 else 0.0
            total += math.sqrt(turn**2 + (abs(z1) - abs(z0)) ** 2)
    return total


def smoothness_bending(configurations) -> float:
    """Sum over sections and steps of how far the bending vector moves."""
    return sum(
        math.dist(a, b)
        for before, after in itertools.pairwise(configurations)
        for a, b in zip(np.reshape(before, (-1, 2)), np.reshape(after, (-1, 2)), strict=True)
    )
