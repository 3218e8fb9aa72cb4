"""Inverse kinematics by damped least squares."""

import math

import numpy as np

from scenarios.kernels.jit import kernel
from scenarios.kernels.kinematics import position_jacobian

DAMPING = 1e-5  # of the pseudo-inverse [m^2/rad^2]
MAX_STEPS = 60


@kernel
def reach(starts, goal, tolerance, section_length, max_bend):
    """Bend every start (K, 2n) [rad] until its tip is within ``tolerance`` [m] of ``goal`` (3,).

    Returns:
        The configurations (K, 2n) and whether each got there (K,). Bends are kept within the disc by projection.
    """
    dof = starts.shape[1]
    out = starts.copy()
    reached = np.zeros(starts.shape[0], np.bool_)
    jacobian, gap = np.empty((3, dof)), np.empty(3)
    for k in range(starts.shape[0]):
        q = out[k]
        for _ in range(MAX_STEPS):
            x, y, z = position_jacobian(q, section_length, dof // 2 * section_length, jacobian)
            gap[0], gap[1], gap[2] = goal[0] - x, goal[1] - y, goal[2] - z
            if (gap * gap).sum() <= tolerance * tolerance:
                reached[k] = True
                break
            gram = jacobian @ jacobian.T
            for i in range(3):
                gram[i, i] += DAMPING
            q += jacobian.T @ np.linalg.solve(gram, gap)
            for i in range(dof // 2):
                bend = math.hypot(q[2 * i], q[2 * i + 1])
                if bend > max_bend:
                    q[2 * i] *= max_bend / bend
                    q[2 * i + 1] *= max_bend / bend
    return out, reached
