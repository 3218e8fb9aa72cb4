"""State validity: compiled, one at a time and in batches, against python-fcl and against what the machine can do."""

from __future__ import annotations

import fcl
import numpy as np
from scipy.spatial.transform import Rotation

from benchmarks import _kernels
from benchmarks.timing import Line, seconds_per_call
from scenarios import ContinuumArm, SampledWorld, are_states_valid, is_state_valid, make_world
from scenarios.arm import FloatArray
from scenarios.families.base import random_configuration

SPHERES = 6
CHORDS = 8
"""Capsules per section in FCL: 24 for the default arm."""

# Operations of ``scenarios.kernels.batch`` on one state, counted from its source: of a section's bend and place, and
# of one section against one sphere; and the numbers it reads and the one it writes.
PER_SECTION, PER_PAIR = 99, 44
BYTES = 6 * 8 + 1


def validity(quick: bool) -> list[Line]:
    """States per second and core, and the bounds that memory and arithmetic set."""
    arm, rng = ContinuumArm(), np.random.default_rng(0)
    count = 20_000 if quick else 200_000
    states = np.stack([random_configuration(rng, arm) for _ in range(count)])
    world = make_world(0.0, 1.0, np.repeat(_centers(rng)[None], 2, axis=0), rng.choice([0.02, 0.03], SPHERES))
    fcl_arm = FclArm(arm, world)
    few = states[:: count // (50 if quick else 200)]
    agree = np.mean([fcl_arm.is_valid(q) == is_state_valid(arm, q, 0.0, world) for q in few])
    batch, single, by_fcl = seconds_per_call(
        [
            lambda: are_states_valid(arm, states, 0.0, world),
            lambda: [is_state_valid(arm, q, 0.0, world) for q in few],
            lambda: [fcl_arm.is_valid(q) for q in few],
        ],
        0.2,
        rounds=3 if quick else 7,
    )
    per_second, by_fcl_per_second = count / batch, len(few) / by_fcl
    flops = arm.n_sections * (PER_SECTION + SPHERES * PER_PAIR)
    stream, arithmetic = machine()
    bound = min(stream / BYTES, arithmetic / flops)
    return [
        Line("batched, kinematics included", 1e-6 * per_second, "M states/s", ">= 8"),
        Line("one at a time from Python", 1e-6 * len(few) / single, "M states/s"),
        Line("python-fcl, 24 capsules in a dynamic tree", 1e-6 * by_fcl_per_second, "M states/s"),
        Line("answers equal to python-fcl's", 100.0 * float(agree), "%"),
        Line("batched / python-fcl", per_second / by_fcl_per_second, "x", ">= 500"),
        Line("memory: STREAM triad", 1e-9 * stream, "GB/s"),
        Line("arithmetic: multiplications and additions from first cache", 1e-9 * arithmetic, "GFlop/s"),
        Line(f"arithmetic intensity: {flops} operations on {BYTES} bytes", flops / BYTES, "Flop/B"),
        Line("roofline: states that memory would allow", 1e-6 * stream / BYTES, "M states/s"),
        Line("roofline: states that arithmetic would allow", 1e-6 * arithmetic / flops, "M states/s"),
        Line("batched / roofline", 100.0 * per_second / bound, "%"),
    ]


def machine() -> tuple[float, float]:
    """Memory bandwidth [B/s] and arithmetic [Flop/s] of one core, as compiled loops reach them."""
    a, b, c = np.zeros(4_000_000), np.ones(4_000_000), np.ones(4_000_000)
    x, rounds = np.ones(512), 1000
    triad, multiply_add = seconds_per_call(
        [lambda: _kernels.triad(a, b, c), lambda: _kernels.multiply_add(x, rounds)], 0.1, rounds=7
    )
    return 3 * a.nbytes / triad, _kernels.OPERATIONS * len(x) * rounds / multiply_add


class FclArm:
    """The arm as chord capsules in a dynamic tree of python-fcl, beside a tree of the spheres."""

    def __init__(self, arm: ContinuumArm, world: SampledWorld) -> None:
        """Build both trees once; a check only moves the capsules."""
        self._arm = arm
        chord = arm.section_length_m / CHORDS
        capsules = [fcl.Capsule(arm.radius_m, chord) for _ in range(arm.n_sections * CHORDS)]
        self._capsules = [fcl.CollisionObject(capsule) for capsule in capsules]
        spheres = zip(world.centers_m[0], world.radii_m[0], strict=True)
        self._spheres = [fcl.CollisionObject(fcl.Sphere(radius), fcl.Transform(center)) for center, radius in spheres]
        self._body, self._obstacles = fcl.DynamicAABBTreeCollisionManager(), fcl.DynamicAABBTreeCollisionManager()
        self._body.registerObjects(self._capsules)
        self._obstacles.registerObjects(self._spheres)
        self._body.setup()
        self._obstacles.setup()

    def is_valid(self, q: FloatArray) -> bool:
        """Whether the arm at ``q`` (dof,) [rad] touches no sphere."""
        points = self._arm.backbone_points(q, CHORDS)
        middles, along = (points[1:] + points[:-1]) / 2.0, np.diff(points, axis=0)
        along /= np.linalg.norm(along, axis=1)[:, None]
        # The turn that takes +z to the chord: about z x chord, as a quaternion (x, y, z, w).
        quaternions = np.column_stack([-along[:, 1], along[:, 0], np.zeros(len(along)), 1.0 + along[:, 2]])
        quaternions[quaternions[:, 3] < 1e-12] = (1.0, 0.0, 0.0, 0.0)
        turns = Rotation.from_quat(quaternions).as_matrix()
        for capsule, turn, middle in zip(self._capsules, turns, middles, strict=True):
            capsule.setTransform(fcl.Transform(turn, middle))
        self._body.update()
        data = fcl.CollisionData()
        self._body.collide(self._obstacles, data, fcl.defaultCollisionCallback)
        return not data.result.is_collision


def _centers(rng: np.random.Generator) -> FloatArray:
    """Sphere centres (6, 3) [m] within the arm's reach."""
    return rng.uniform((-0.3, -0.3, 0.0), (0.3, 0.3, 0.4), size=(SPHERES, 3))
