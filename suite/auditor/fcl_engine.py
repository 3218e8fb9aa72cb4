"""The second opinion: python-fcl's distances at close instants, with the kinematics and laws of ``scenarios``.

It shares nothing with the certificate and proves nothing: a contact shorter than a sample, or shallower than the bow of
an arc over its chord, can slip through. A body that moves at 0.5 m/s past a sphere is missed by at most 0.1 mm.
"""

import math

import fcl
import numpy as np

from scenarios import Obstacle, Scenario
from suite.auditor.engine import Contacts, FloatArray

SAMPLE_S = 0.01
_CAPSULES = 24  # per section: at most 0.1 mm between arc and chord
# Depths come from here: FCL 0.7's signed distance never answers for a sphere whose centre is on a capsule's axis.
_CONTACTS = fcl.CollisionRequest(num_max_contacts=1000, enable_contact=True)


def sampled_contacts(scenario: Scenario, times_s: FloatArray, states: FloatArray, end_s: float) -> Contacts:
    """Contacts at whole seconds, at timed states and every SAMPLE_S over [times_s[0], end_s]."""
    bodies = _Bodies(scenario)
    instants = _instants(times_s, end_s)
    centers = [obstacle.position(instants) for obstacle in scenario.obstacles]
    per_step_s, swept_s, smallest, touching = math.nan, math.nan, math.inf, (-1, -1)
    for i, t in enumerate(instants.tolist()):
        gap = bodies.clearance(_state_at(times_s, states, t), [center[i] for center in centers])
        smallest = min(smallest, gap)
        if gap <= 0.0:
            if math.isnan(swept_s):
                swept_s, touching = t, bodies.nearest()
            per_step_s = t if math.isnan(per_step_s) and t == math.floor(t) else per_step_s
    return Contacts(per_step_s, swept_s, smallest, *touching)


def _instants(times_s: FloatArray, end_s: float) -> FloatArray:
    count = math.floor(end_s / SAMPLE_S)
    # Divided, not multiplied: whole seconds come out whole.
    regular = np.arange(count + 1) / round(1.0 / SAMPLE_S)
    every = np.concatenate([regular, times_s, [end_s]])
    return np.unique(every[(every >= times_s[0]) & (every <= end_s)])


def _state_at(times_s: FloatArray, states: FloatArray, t: float) -> FloatArray:
    return np.array([np.interp(t, times_s, states[:, column]) for column in range(states.shape[1])])


class _Bodies:
    """The arm as capsules and the obstacles, as FCL keeps them."""

    def __init__(self, scenario: Scenario) -> None:
        self._arm = scenario.arm
        # All as long as their arcs, and so longer than their chords, by a few micrometres.
        capsule = fcl.Capsule(self._arm.radius_m, self._arm.section_length_m / _CAPSULES)
        self._capsules = [fcl.CollisionObject(capsule) for _ in range(self._arm.n_sections * _CAPSULES)]
        self._shapes = [_object(obstacle) for obstacle in scenario.obstacles]
        self._managers = _manager(self._capsules), _manager(self._shapes)

    def clearance(self, q: FloatArray, centers: list[FloatArray]) -> float:
        """Distance [m] between the arm at ``q`` (dof,) and obstacles at ``centers`` (3,) [m]; inf without.

        In contact the depth of the deepest, negative.
        """
        if not centers:
            return math.inf
        points = self._arm.backbone_points(q, _CAPSULES)
        turns, middles = _turns_z_to(np.diff(points, axis=0)), 0.5 * (points[:-1] + points[1:])
        for capsule, turn, middle in zip(self._capsules, turns, middles, strict=True):
            capsule.setTransform(fcl.Transform(turn, middle))
        for shape, center in zip(self._shapes, centers, strict=True):
            shape.setTranslation(center)
        for manager in self._managers:
            manager.update()
        data = fcl.DistanceData()
        self._managers[0].distance(self._managers[1], data, fcl.defaultDistanceCallback)
        if data.result.min_distance > 0.0:
            return float(data.result.min_distance)
        met = fcl.CollisionData(request=_CONTACTS)
        self._managers[0].collide(self._managers[1], met, fcl.defaultCollisionCallback)
        return -_depth(met.result)

    def nearest(self) -> tuple[int, int]:
        """Which obstacle and section have the smallest distance, pair by pair, as they were last placed."""
        distances = [[_gap(capsule, shape) for capsule in self._capsules] for shape in self._shapes]
        obstacle, capsule = np.unravel_index(np.argmin(distances), np.shape(distances))
        return int(obstacle), int(capsule) // _CAPSULES


def _gap(one: fcl.CollisionObject, other: fcl.CollisionObject) -> float:
    """Distance of two bodies [m], negative by the depth of their contact."""
    distance = float(fcl.distance(one, other))
    if distance > 0.0:
        return distance
    met = fcl.CollisionResult()
    fcl.collide(one, other, _CONTACTS, met)
    return -_depth(met)


def _depth(met: fcl.CollisionResult) -> float:
    """Depth of the deepest contact [m]; 0 where there is none."""
    return max((float(contact.penetration_depth) for contact in met.contacts), default=0.0)


def _manager(objects: list[fcl.CollisionObject]) -> fcl.DynamicAABBTreeCollisionManager:
    manager = fcl.DynamicAABBTreeCollisionManager()
    manager.registerObjects(objects)
    manager.setup()
    return manager


def _turns_z_to(directions: FloatArray) -> FloatArray:
    """Rotations (N, 3, 3) whose third columns point along ``directions`` (N, 3): FCL's capsules lie along z."""
    z = directions / np.linalg.norm(directions, axis=1, keepdims=True)
    helper = np.eye(3)[np.argmin(np.abs(z), axis=1)]
    x = np.cross(helper, z)
    x /= np.linalg.norm(x, axis=1, keepdims=True)
    return np.stack([x, np.cross(z, x), z], axis=2)


def _object(obstacle: Obstacle) -> fcl.CollisionObject:
    if obstacle.shape is None:
        return fcl.CollisionObject(fcl.Sphere(obstacle.radius_m))
    return fcl.CollisionObject(obstacle.shape.geometry(), fcl.Transform(obstacle.shape.rotation))
