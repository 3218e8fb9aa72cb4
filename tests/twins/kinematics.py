"""The arm by SciPy rotations: as written in RoboSoft 2022, and by integrating the backbone's tangent."""

import numpy as np
from scipy.spatial.transform import Rotation

# 24 Gauss-Legendre nodes integrate the tangent of a section bent by pi to rounding.
NODES, WEIGHTS = np.polynomial.legendre.leggauss(24)


def section_end_by_angles(theta: float, phi: float, length: float, share: float = 1.0):
    """Rotation and position of a section's cross-section at ``share`` of its length: Rz(theta) Px Ry Rz(-theta)."""
    turn = Rotation.from_euler("z", theta) * Rotation.from_euler("y", share * phi) * Rotation.from_euler("z", -theta)
    radius = length / phi
    in_plane = np.array([radius * (1 - np.cos(share * phi)), 0.0, radius * np.sin(share * phi)])
    return turn, Rotation.from_euler("z", theta).apply(in_plane)


def section_end_by_vector(u: float, v: float, length: float, share: float = 1.0):
    """The same from the rotation vector (-v, u, 0), the position by quadrature of the tangent; no straight case."""
    shares = share * (NODES + 1) / 2
    tangents = Rotation.from_rotvec(np.outer(shares, [-v, u, 0.0])).apply([0.0, 0.0, 1.0])
    return Rotation.from_rotvec([-share * v, share * u, 0.0]), length * share * (WEIGHTS / 2) @ tangents


def backbone_point(q, length: float, arc_length: float, by_angles: bool = False):
    """Point (3,) of the backbone at ``arc_length``, section by section."""
    frame, point = Rotation.identity(), np.zeros(3)
    for u, v in np.reshape(q, (-1, 2)):
        share = min(1.0, arc_length / length)
        if by_angles:
            turn, moved = section_end_by_angles(np.arctan2(v, u), np.hypot(u, v), length, share)
        else:
            turn, moved = section_end_by_vector(u, v, length, share)
        point = point + frame.apply(moved)
        frame = frame * turn
        arc_length -= share * length
        if arc_length <= 0:
            break
    return point


def backbone(q, length: float, per_section: int):
    """Points (n * per_section + 1, 3) at equal spacing, from the arcs' closed form in NumPy alone."""
    frame, base, points = np.eye(3), np.zeros(3), [np.zeros((1, 3))]
    shares = np.arange(1, per_section + 1) / per_section
    for u, v in np.reshape(q, (-1, 2)):
        phi = np.hypot(u, v)
        angles = shares * phi
        # (1 - cos a) / phi and sin a / phi, straight sections included.
        side = shares * np.sinc(angles / (2 * np.pi)) * np.sin(angles / 2)
        along = shares * np.sinc(angles / np.pi)
        direction = np.array([u, v]) / phi if phi > 0 else np.zeros(2)
        local = length * np.column_stack([side * direction[0], side * direction[1], along])
        points.append(base + local @ frame.T)
        base = points[-1][-1]
        frame = frame @ Rotation.from_rotvec([-v, u, 0.0]).as_matrix()
    return np.concatenate(points)
