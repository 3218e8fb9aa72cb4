import numpy as np
import pytest
from audit_twin import random_bending
from hypothesis import given, settings
from hypothesis import strategies as st
from shapes import KINDS, moving, random_shape
from twins.shapes import shaped_clearance, signed_distance

from scenarios import Box, Capsule, ContinuumArm, Cylinder, Mesh, Scenario, shaped_world
from scenarios.world import positions
from suite.auditor import Kind, audit, clearance
from suite.auditor.fcl_engine import sampled_contacts
from suite.auditor.shapes import _kernels as kernels
from suite.auditor.shapes import pack_shapes

ARM = ContinuumArm()
STRAIGHT = np.zeros(6)
CUBE = Mesh(vertices_m=tuple((x, y, z) for x in (-0.02, 0.02) for y in (-0.02, 0.02) for z in (-0.02, 0.02)))
ACROSS = (0.0, np.pi / 2, 0.0)  # turns z to x


def scenario(*obstacles, arm=ARM, start=STRAIGHT):
    return Scenario(id="shapes", arm=arm, start_rad=tuple(start), goal_m=(5, 5, 5), obstacles=obstacles)


@pytest.mark.parametrize(
    ("shape", "to_surface_m"),
    [
        (Box(size_m=(0.04, 0.2, 0.2)), 0.02),
        (Box(size_m=(0.04, 0.04, 0.2), rotation_rad=(0, 0, np.pi / 4)), 0.02 * np.sqrt(2)),
        (Capsule(radius_m=0.01, length_m=0.1), 0.01),
        (Capsule(radius_m=0.01, length_m=0.1, rotation_rad=ACROSS), 0.06),
        (Cylinder(radius_m=0.03, length_m=0.1), 0.03),
        (Cylinder(radius_m=0.03, length_m=0.1, rotation_rad=ACROSS), 0.05),
        (CUBE, 0.02),
    ],
)
def test_clearance_of_the_straight_arm_by_hand(shape, to_surface_m):
    found = clearance(scenario(moving(shape, (0.2, 0.0, 0.3))), STRAIGHT, 0.0)
    exact = 0.2 - to_surface_m - ARM.radius_m
    assert (1 - kernels.SLACK) * exact - 1e-9 <= found <= exact + 1e-12


@settings(max_examples=60)
@given(seed=st.integers(0, 2**32 - 1), kind=st.sampled_from(KINDS))
def test_signed_distances_agree_with_the_twin(seed, kind):
    rng = np.random.default_rng(seed)
    shape = random_shape(rng, kind)
    points = rng.normal(size=(20, 3)) * rng.choice([0.01, 0.05, 0.2])
    bodies = pack_shapes([moving(shape, (0, 0, 0))])
    ours = [kernels.signed_distance(bodies, 0, *point) for point in points]
    np.testing.assert_allclose(ours, signed_distance(shape, points), atol=1e-9)


@settings(max_examples=60)
@given(seed=st.integers(0, 2**32 - 1), kind=st.sampled_from(KINDS))
def test_clearance_never_overstates_and_agrees_with_fcl_and_dense_points(seed, kind):
    rng = np.random.default_rng(seed)
    shape, center, q = (
        random_shape(rng, kind),
        rng.uniform([-0.25, -0.25, -0.1], [0.25, 0.25, 0.4]),
        random_bending(rng, 3),
    )
    found = clearance(scenario(moving(shape, center)), q, 0.0)
    dense = shaped_clearance(q, ARM.section_length_m, ARM.radius_m, [shape], [center], 300)
    spacing = ARM.section_length_m / 300
    assert found <= dense + 1e-9
    assert found >= dense - spacing - max(kernels.SLACK * abs(dense), kernels.FINE_M)
    by_fcl = shaped_world([moving(shape, center)], 0.0, 1.0, np.tile(center, (2, 1, 1))).clearance(ARM, q, 0.0)
    assert by_fcl <= dense + 1e-9
    if dense > 0:
        assert by_fcl >= dense - spacing - 1e-3


@settings(max_examples=60)
@given(seed=st.integers(0, 2**32 - 1), kind=st.sampled_from(KINDS))
def test_motions_certified_free_are_free_every_millisecond(seed, kind):
    rng = np.random.default_rng(seed)
    arm = ContinuumArm(n_sections=int(rng.integers(1, 4)))
    q0 = random_bending(rng, arm.n_sections, np.pi - 0.3)
    q1 = q0 + 0.2 * rng.uniform() * random_bending(rng, arm.n_sections, 1.0)
    on_arm = arm.backbone_points(0.5 * (q0 + q1))[rng.integers(1, 20 * arm.n_sections)]
    shape = random_shape(rng, kind)
    velocity = 0.2 * rng.normal(size=3)
    away = (arm.radius_m + rng.uniform(0.0, shape.bounding_radius_m + 0.02)) * rng.normal(size=3)
    obstacle = moving(shape, on_arm + away - 0.05 * velocity, velocity)
    judged = audit(scenario(obstacle, arm=arm, start=q0), [0.0, 0.1], [q0, q1])
    times = np.arange(0.0, 0.1 + 1e-9, 1e-3)
    gaps = [
        shaped_clearance(q0 + t / 0.1 * (q1 - q0), arm.section_length_m, arm.radius_m, [shape], center, 60)
        for t, center in zip(times, positions([obstacle], times), strict=True)
    ]
    if judged.swept.violation_kind != Kind.COLLISION:
        assert min(gaps) > 0.0
    elif min(gaps) > 0.0:
        assert min(gaps) < 2.5e-3  # no false alarm: 60 points a section see 1.3 mm too much, milliseconds 1 mm
    sampled = audit(scenario(obstacle, arm=arm, start=q0), [0.0, 0.1], [q0, q1], sampled_contacts)
    if sampled.swept.violation_kind == Kind.COLLISION:
        assert judged.swept.violation_kind == Kind.COLLISION
