"""Quality of an executed motion, whether it succeeded or not."""

import numpy as np
import numpy.typing as npt

from scenarios import ContinuumArm

FloatArray = npt.NDArray[np.float64]

TIP_SAMPLES = 8
"""Chords per timed interval when measuring the tip's path, which is curved between timed states."""


def tip_path_length_m(arm: ContinuumArm, configurations_rad: FloatArray) -> float:
    """Length of the tip's path through configurations (k, dof) [rad], linear in bending vectors between them [m]."""
    shares = np.arange(TIP_SAMPLES) / TIP_SAMPLES
    steps = np.diff(configurations_rad, axis=0)
    between = configurations_rad[:-1, None] + shares[:, None] * steps[:, None]
    tips = arm.tips(np.vstack([between.reshape(-1, arm.dof), configurations_rad[-1:]]))
    return float(np.linalg.norm(np.diff(tips, axis=0), axis=1).sum())


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
