"""Clearance of one state and of many, against a sampled backbone and against FCL."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from strategies import ARM, configurations, empty_world, random_configurations, random_world, seeds
from twins.clearance import fcl_clearance, sampled_clearance, spheres_at

from scenarios import ContinuumArm, ScenarioError, are_states_valid, clearance, clearances, is_state_valid, make_world

# The nearest backbone point lies at most half a spacing from a sample: 0.15 m / 400 / 2.
SAMPLING_M = 0.15 / 400 / 2


def world_of(centers: object, radii: object):
    return make_world(0.0, 1.0, np.repeat(np.atleast_2d(centers)[None], 2, axis=0), np.atleast_1d(radii))


@given(configurations(), seeds, st.integers(1, 6), st.floats(-4, 6))
def test_clearance_is_that_of_a_sampled_backbone(q: np.ndarray, seed: int, m: int, time: float) -> None:
    world = random_world(np.random.default_rng(seed), m)
    centers, radii = spheres_at(time, world.start_s, world.step_s, world.centers_m, world.radii_m)
    sampled = sampled_clearance(q, ARM.section_length_m, ARM.radius_m, centers, radii)
    exact = clearance(ARM, q, time, world)
    assert sampled - SAMPLING_M - 1e-6 <= exact <= sampled + 1e-6


@given(seeds, st.floats(0, math.pi), st.integers(1, 4))
def test_spheres_at_every_kind_of_place_about_one_section(seed: int, phi: float, n: int) -> None:
    # Beside, inside and beyond the arc, on its far side and past either end: each case of the closed form.
    rng = np.random.default_rng(seed)
    arm = ContinuumArm(n_sections=n)
    q = random_configurations(rng, 1, n)[0]
    q[:2] = phi, 0.0
    centers = rng.normal(scale=0.1, size=(8, 3)) + np.array([0.05, 0.0, 0.05])
    for center in centers:
        sampled = sampled_clearance(q, 0.15, arm.radius_m, center[None], np.array([0.01]))
        exact = clearance(arm, q, 0.0, world_of(center, 0.01))
        assert sampled - SAMPLING_M - 1e-6 <= exact <= sampled + 1e-6


@settings(max_examples=30)
@given(configurations(), seeds, st.integers(1, 4))
def test_clearance_is_that_of_fcl(q: np.ndarray, seed: int, m: int) -> None:
    world = random_world(np.random.default_rng(seed), m)
    by_fcl = fcl_clearance(q, ARM.section_length_m, ARM.radius_m, world.centers_m[0], world.radii_m[0])
    exact = clearance(ARM, q, world.start_s, world)
    # Chords cut the corner of the arc by at most ds^2 / (8 R), with R = L / pi.
    assert max(exact, 0.0) == pytest.approx(by_fcl, abs=(0.15 / 20) ** 2 / (8 * 0.15 / math.pi) + 1e-6)


@pytest.mark.parametrize(
    ("q", "center", "distance"),
    [
        (np.zeros(6), [0.1, 0, 0.2], 0.1),
        (np.zeros(6), [0, 0, 0.5], 0.05),
        (np.zeros(6), [0, -0.03, -0.04], 0.05),
        (np.zeros(6), [0, 0, 0.3], 0.0),
        ([math.pi, 0, 0, 0, 0, 0], [0.15 / math.pi, 0, 0], 0.15 / math.pi),
        ([math.pi, 0, 0, 0, 0, 0], [0.15 / math.pi, 0.02, 0], math.hypot(0.15 / math.pi, 0.02)),
        ([math.pi, 0, 0, 0, 0, 0], [0.15 / math.pi, 0, 0.15 / math.pi + 0.07], 0.07),
        ([math.pi, 0, 0, 0, 0, 0], [0.3 / math.pi + 0.02, 0, -0.1], 0.02),
        ([math.pi, 0, 0, 0, 0, 0], [0.3 / math.pi, 0, -0.31], 0.01),
    ],
    ids=[
        "beside a straight arm",
        "above its tip",
        "below its base",
        "on the backbone",
        "centre of a half circle",
        "off the centre's plane",
        "over the half circle's top",
        "beside the straight rest",
        "below the hanging tip",
    ],
)
def test_distances_one_can_measure(q: object, center: list[float], distance: float) -> None:
    assert clearance(ARM, q, 0.0, world_of(center, 0.03)) == pytest.approx(distance - 0.03 - 0.018, abs=1e-6)


def test_no_obstacles_is_infinitely_clear() -> None:
    assert clearance(ARM, np.zeros(6), 0.0, empty_world()) == math.inf
    assert is_state_valid(ARM, np.zeros(6), 0.0, empty_world())


def test_a_touch_is_a_collision() -> None:
    # Below the base of a thick arm nothing is rounded: 1 - (0.5 + 0.5).
    arm = ContinuumArm(radius_m=0.5)
    assert clearance(arm, np.zeros(6), 0.0, world_of([0, 0, -1], 0.5)) == 0.0
    assert not is_state_valid(arm, np.zeros(6), 0.0, world_of([0, 0, -1], 0.5))
    assert is_state_valid(arm, np.zeros(6), 0.0, world_of([0, 0, -1], 0.5 - 1e-15))


def test_depth_of_penetration_is_negative_and_bounded_by_the_radii() -> None:
    assert clearance(ARM, np.zeros(6), 0.0, world_of([0, 0, 0.2], 0.03)) == pytest.approx(-0.048, abs=1e-6)


def test_more_obstacles_are_never_farther() -> None:
    rng = np.random.default_rng(3)
    world = random_world(rng, 5)
    for q in random_configurations(rng, 20):
        alone = [
            clearance(ARM, q, 0.5, world._replace(centers_m=world.centers_m[:, [j]], radii_m=world.radii_m[:, [j]]))
            for j in range(5)
        ]
        assert clearance(ARM, q, 0.5, world) == min(alone)


@pytest.mark.parametrize("n", [1, 3, 5])
def test_many_at_once_equal_one_by_one(n: int) -> None:
    rng = np.random.default_rng(n)
    arm, world = ContinuumArm(n_sections=n), random_world(rng, 4)
    q, times = random_configurations(rng, 50, n), rng.uniform(-4, 6, size=50)
    together = clearances(arm, q, times, world)
    np.testing.assert_array_equal(together, [clearance(arm, *pair, world) for pair in zip(q, times, strict=True)])
    np.testing.assert_array_equal(clearances(arm, q, 0.25, world), clearances(arm, q, np.full(50, 0.25), world))


@pytest.mark.parametrize("count", [1, 63, 64, 65, 1000])
@pytest.mark.parametrize("n", [1, 3, 5])
def test_a_block_of_states_is_judged_as_each_of_them(n: int, count: int) -> None:
    rng = np.random.default_rng(count)
    arm, world = ContinuumArm(n_sections=n), random_world(rng, 6, spread_m=0.2)
    q = random_configurations(rng, count, n)
    q[::5, :2] = 0.0
    q[1::5, -2:] = math.pi, 0.0
    q[2::5] *= 1e-7
    gaps = clearances(arm, q, 0.3, world)
    free = are_states_valid(arm, q, 0.3, world)
    assert ((gaps > 1e-9) <= free).all()
    assert ((gaps < -1e-9) <= ~free).all()
    assert min(n, count) == 1 or 0.02 < free.mean() < 0.98
    assert are_states_valid(arm, q, 0.3, empty_world()).all()


@pytest.mark.parametrize(
    ("q", "times", "message"),
    [
        (np.zeros((2, 4)), 0.0, "shape"),
        (np.full((2, 6), math.nan), 0.0, "not finite"),
        (np.full((2, 6), 3.0), 0.0, "bend"),
        (np.zeros((2, 6)), [0.0, math.nan], "time"),
        (np.zeros((2, 6)), math.inf, "time"),
        (np.zeros((2, 6)), math.nan, "time"),
    ],
)
def test_nonsense_is_refused(q: np.ndarray, times: object, message: str) -> None:
    with pytest.raises(ScenarioError, match=message):
        clearances(ARM, q, times, empty_world())
    if np.ndim(times) == 0:
        with pytest.raises(ScenarioError, match=message):
            are_states_valid(ARM, q, float(times), empty_world())
