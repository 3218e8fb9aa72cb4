from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapes import KINDS, moving, random_shape
from strategies import ARM, random_configurations
from twins.shapes import shaped_clearance, signed_distance

import scenarios
from scenarios import (
    Box,
    Capsule,
    Cylinder,
    Line,
    Mesh,
    Obstacle,
    Scenario,
    ScenarioError,
    clearance,
    cover_world,
    is_motion_valid,
    load_scenarios,
    save_scenarios,
    shaped_world,
    start_is_free,
)

EXAMPLE = Path(scenarios.__file__).parent / "examples" / "shapes.yaml"
STRAIGHT = np.zeros(6)
ACROSS = (0.0, np.pi / 2, 0.0)  # turns z to x
CUBE = Mesh(vertices_m=tuple((x, y, z) for x in (-0.02, 0.02) for y in (-0.02, 0.02) for z in (-0.02, 0.02)))

seeds = st.integers(0, 2**32 - 1)
kinds = st.sampled_from(KINDS)


def resting(shapes, centers):
    obstacles = [moving(shape, center) for shape, center in zip(shapes, centers, strict=True)]
    where = np.tile(centers, (2, 1, 1))
    return cover_world(obstacles, 0.0, 1.0, where), shaped_world(obstacles, 0.0, 1.0, where)


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
    _, exact = resting([shape], [(0.2, 0.0, 0.3)])
    assert exact.clearance(ARM, STRAIGHT, 0.0) == pytest.approx(0.2 - to_surface_m - ARM.radius_m, abs=2e-6)


def test_a_sphere_against_the_straight_arm_is_a_sphere_whatever_stands_beside_it():
    obstacles = [moving(CUBE, (0.3, 0, 0.3)), Obstacle(radius_m=0.02, motion=moving(CUBE, (0, 0.1, 0.3)).motion)]
    exact = shaped_world(obstacles, 0.0, 1.0, np.tile([[0.3, 0, 0.3], [0, 0.1, 0.3]], (2, 1, 1)))
    assert exact.clearance(ARM, STRAIGHT, 0.0) == pytest.approx(0.1 - 0.02 - ARM.radius_m)


def test_margins_grow_shapes_and_their_covers():
    obstacles, where = [moving(CUBE, (0.2, 0, 0.3))], np.tile([0.2, 0, 0.3], (2, 1, 1))
    gaps = [shaped_world(obstacles, 0.0, 1.0, where, m).clearance(ARM, STRAIGHT, 0.5) for m in (0.0, 0.03)]
    assert gaps[0] - gaps[1] == pytest.approx(0.03)
    grown = cover_world(obstacles, 0.0, 1.0, where, [[0.0], [0.03]])
    np.testing.assert_allclose(grown.radii_m[1] - grown.radii_m[0], 0.03)


@settings(max_examples=50)
@given(seed=seeds, kind=kinds)
def test_covers_and_bounding_spheres_hold_the_shape(seed, kind):
    rng = np.random.default_rng(seed)
    shape = random_shape(rng, kind)
    points = rng.uniform(-1, 1, size=(4000, 3)) * shape.bounding_radius_m
    inside = points[signed_distance(shape, points) <= 0]
    cover = shape.cover()
    away = np.linalg.norm(inside[:, None] - cover.centers_m, axis=2) - cover.radii_m
    assert (away.min(axis=1, initial=np.inf) <= 1e-12).all()
    assert len(cover.radii_m) <= 64
    direction = rng.normal(size=3)
    direction /= np.linalg.norm(direction)
    assert (inside @ direction).max(initial=-np.inf) <= shape.reach(direction) <= shape.bounding_radius_m + 1e-12


@settings(max_examples=60)
@given(seed=seeds)
def test_clearance_agrees_with_dense_points_and_never_overstates(seed):
    rng = np.random.default_rng(seed)
    q = random_configurations(rng, 1)[0]
    shapes = [random_shape(rng, kind) for kind in rng.choice(KINDS, 2)]
    centers = rng.uniform([-0.25, -0.25, -0.1], [0.25, 0.25, 0.4], size=(2, 3))
    cover, exact = resting(shapes, centers)
    dense = shaped_clearance(q, ARM.section_length_m, ARM.radius_m, shapes, centers, 200)
    found = exact.clearance(ARM, q, 0.0)
    assert found <= dense + 1e-9
    assert clearance(ARM, q, 0.0, cover) <= dense + 1e-9
    if dense > 0:
        assert found >= dense - ARM.section_length_m / 200 - 1e-3


@settings(max_examples=40)
@given(seed=seeds, kind=kinds)
def test_motions_called_valid_are_free_and_clear_ones_are_called_valid(seed, kind):
    rng = np.random.default_rng(seed)
    q0, q1 = 0.9 * random_configurations(rng, 2)
    q1 = q0 + 0.1 * (q1 - q0)
    shape, velocity = random_shape(rng, kind), 0.05 * rng.normal(size=3)
    on_arm = ARM.backbone_points(q0)[rng.integers(20, 61)]
    start = on_arm + (ARM.radius_m + rng.uniform(0, shape.bounding_radius_m + 0.03)) * rng.normal(size=3)
    where = np.array([[start], [start + velocity]])
    obstacles = [moving(shape, start, velocity)]
    exact = shaped_world(obstacles, 0.0, 1.0, where)
    valid = exact.is_motion_valid(ARM, q0, 0.0, q1, 1.0)
    gaps = [
        shaped_clearance(q0 + s * (q1 - q0), ARM.section_length_m, ARM.radius_m, [shape], [start + s * velocity], 60)
        for s in np.linspace(0, 1, 51)
    ]
    if valid:
        assert min(gaps) > 0
    if min(gaps) > 0.02:  # between two of the twin's 51 instants things come up to 15 mm nearer
        assert valid
    if is_motion_valid(ARM, q0, 0.0, q1, 1.0, cover_world(obstacles, 0.0, 1.0, where)):
        assert valid


def test_a_start_between_the_spheres_that_hold_a_plate_is_free():
    plate = Box(size_m=(0.3, 0.3, 0.004))
    above = moving(plate, (0.0, 0.0, 0.475))
    scenario = Scenario(id="plate", start_rad=(0,) * 6, goal_m=(0.1, 0, 0.3), obstacles=(above,))
    cover, _ = resting([plate], [(0.0, 0.0, 0.475)])
    assert clearance(ARM, STRAIGHT, 0.0, cover) < 0
    assert start_is_free(scenario)


def test_a_sphere_is_stored_as_ever_and_a_shape_without_what_is_derived():
    at_rest = Line(point_m=(0, 0, 0), velocity_m_s=(0, 0, 0))
    assert set(Obstacle(radius_m=0.02, motion=at_rest).model_dump()) == {"radius_m", "motion"}
    box = Obstacle(shape=Box(size_m=(0.02, 0.04, 0.04)), motion=at_rest)
    assert set(box.model_dump()) == {"shape", "motion"}
    assert box.radius_m == pytest.approx(0.03)


@pytest.mark.parametrize("suffix", [".yaml", ".json", ".jsonl"])
def test_the_example_survives_saving(tmp_path, suffix):
    loaded = load_scenarios(EXAMPLE)
    assert {o.shape.kind for s in loaded for o in s.obstacles if o.shape} == set(KINDS)
    assert {o.motion.kind for s in loaded for o in s.obstacles} == {"orbit", "line", "wander", "track"}
    save_scenarios(tmp_path / f"s{suffix}", loaded)
    again = load_scenarios(tmp_path / f"s{suffix}")
    assert again == loaded
    assert [s.content_hash for s in again] == [s.content_hash for s in loaded]


@pytest.mark.parametrize(
    ("looks", "says"),
    [
        ("", "either radius_m"),
        ("radius_m: 0.02, shape: {kind: box, size_m: [1, 1, 1]},", "either radius_m"),
        ("radius_m: 0,", "greater than 0"),
        ("shape: {kind: cone},", "'box', 'capsule', 'cylinder', 'mesh'"),
        ("shape: {kind: box, size_m: [1, 1]},", "size_m"),
        ("shape: {kind: box, size_m: [1, -1, 1]},", "size_m.1: found -1"),
        ("shape: {kind: capsule, radius_m: 0.1},", "length_m: found nothing"),
        ("shape: {kind: cylinder, radius_m: 0.1, length_m: 0.1, rotation_rad: [0, 0, .nan]},", "rotation_rad"),
        ("shape: {kind: mesh, vertices_m: [[0, 0, 0], [1, 0, 0], [0, 1, 0]]},", "vertices_m"),
        ("shape: {kind: mesh, vertices_m: [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]},", "not all in one plane"),
        ("shape: 5,", "shape"),
    ],
)
def test_a_wrong_shape_in_a_file_is_one_line(tmp_path, looks, says):
    file = tmp_path / "s.yaml"
    motion = "{kind: line, point_m: [0, 0, 0], velocity_m_s: [0, 0, 0]}"
    obstacle = f"{{{looks} motion: {motion}}}"
    file.write_text(f"{{id: a, start_rad: [0, 0, 0, 0, 0, 0], goal_m: [0, 0, 0.4], obstacles: [{obstacle}]}}")
    with pytest.raises(ScenarioError) as error:
        load_scenarios(file)
    assert says in str(error.value)
    assert "\n" not in str(error.value)
