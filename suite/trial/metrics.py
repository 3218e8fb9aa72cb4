"""Quality of an executed motion, whether it succeeded or not."""

import numpy as np
import numpy.typing as npt

from scenarios import ContinuumArm

FloatArray = npt.NDArray[np.float64]

TIP_PATH_ERROR = 1e-4
"""A tip path's length is wrong by no more than this share of it."""

_CHORDS = 8  # per timed interval, to begin with
_LAST_CHANGE, _ROUNDING_M = 1e-3, 1e-9


def tip_path_length_m(arm: ContinuumArm, configurations_rad: FloatArray) -> float:
    """Length of the tip's path through configurations (k, dof) [rad], linear in bending vectors between them [m].

    The path is curved between timed states. Each interval is measured by chords, halved until that changes its length
    by no more than a thousandth. Chords fall short by the square of their size, so a third of the last change is still
    missing and is added (Richardson); what then remains is an order of magnitude below ``TIP_PATH_ERROR``.
    """
    starts, steps = configurations_rad[:-1], np.diff(configurations_rad, axis=0)
    total, chords = 0.0, _CHORDS
    while len(steps):
        shares = np.arange(chords + 1) / chords
        between = starts[:, None] + shares[:, None] * steps[:, None]
        tips = arm.tips(between.reshape(-1, arm.dof)).reshape(len(steps), chords + 1, 3)
        fine, coarse = _chord_lengths(tips), _chord_lengths(tips[:, ::2])
        wanted = fine - coarse > _LAST_CHANGE * fine + _ROUNDING_M
        total += float((fine + (fine - coarse) / 3.0)[~wanted].sum())
        starts, steps, chords = starts[wanted], steps[wanted], 2 * chords
    return total


def _chord_lengths(points_m: FloatArray) -> FloatArray:
    """Lengths (N,) [m] of polygons through points (N, k, 3) [m]."""
    return np.asarray(np.linalg.norm(np.diff(points_m, axis=1), axis=2).sum(axis=1))


def smoothness_paper_rad(configurations_rad: FloatArray) -> float:
    """The paper's S (section II-D): cumulative change of (theta, phi) over sections and steps, theta wrapped [rad].

    A straight section has no theta; its bending plane is taken to be its neighbour's.
    """
    u, v = configurations_rad[:, 0::2], configurations_rad[:, 1::2]
    phi, theta = np.hypot(u, v), np.arctan2(v, u)
    turn = np.abs(np.diff(theta, axis=0))
    turn = np.minimum(turn, 2.0 * np.pi - turn)
    straight = phi < 1e-9
    turn[straight[1:] | straight[:-1]] = 0.0
    return float(np.hypot(turn, np.diff(phi, axis=0)).sum())


def smoothness_bending_rad(configurations_rad: FloatArray) -> float:
    """Cumulative change of the bending vectors, summed over sections and steps [rad]: free of theta's singularity."""
    steps = np.diff(configurations_rad, axis=0)
    return float(np.hypot(steps[:, 0::2], steps[:, 1::2]).sum())
