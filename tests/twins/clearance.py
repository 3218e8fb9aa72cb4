"""Clearance from a densely sampled backbone, and by FCL on capsules."""

from itertools import pairwise

import fcl
import numpy as np
from scipy.spatial.transform import Rotation

from twins.kinematics import backbone


def spheres_at(time, start, step, centers, radii):
    """Centres (m, 3) and radii (m,) at ``time``: np.interp holds the ends and is linear between samples."""
    times = start + step * np.arange(len(centers))
    flat = np.column_stack([centers.reshape(len(times), -1), radii])
    values = np.array([np.interp(time, times, column) for column in flat.T])
    m = radii.shape[1]
    return values[: 3 * m].reshape(m, 3), values[3 * m :]


def sampled_clearance(q, length, arm_radius, centers, radii, per_section=400):
    """Distance from the sampled backbone to the nearest sphere, less both radii."""
    if not len(radii):
        return np.inf
    gaps = np.linalg.norm(backbone(q, length, per_section)[:, None] - centers, axis=2)
    return float((gaps - radii).min() - arm_radius)


def fcl_clearance(q, length, arm_radius, centers, radii, per_section=20):
    """FCL's distance between chord capsules and spheres; 0 when they touch."""
    points = backbone(q, length, per_section)
    spheres = [
        fcl.CollisionObject(fcl.Sphere(r), fcl.Transform(center)) for center, r in zip(centers, radii, strict=True)
    ]
    smallest = np.inf
    for a, b in pairwise(points):
        along = (b - a) / np.linalg.norm(b - a)
        turn, _ = Rotation.align_vectors([along], [[0.0, 0.0, 1.0]])
        capsule = fcl.CollisionObject(
            fcl.Capsule(arm_radius, np.linalg.norm(b - a)), fcl.Transform(turn.as_matrix(), (a + b) / 2)
        )
        for sphere in spheres:
            request = fcl.DistanceRequest(enable_signed_distance=False)
            smallest = min(smallest, fcl.distance(capsule, sphere, request, fcl.DistanceResult()))
    return max(smallest, 0.0)
