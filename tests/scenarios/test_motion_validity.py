"""The proof that a motion is free: never given where there is contact, hardly ever withheld where there is room."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from strategies import ARM, empty_world, random_configurations, random_world, seeds

from scenarios import ContinuumArm, SampledWorld, ScenarioError, clearances, is_motion_valid, make_world

ROOM_M = 1e-3


def densest(arm: ContinuumArm, q0: np.ndarray, t0: float, q1: np.ndarray, t1: float, world: SampledWorld) -> float:
    """Smallest clearance seen at 1001 instants."""
    shares = np.linspace(0, 1, 1001)
    return float(clearances(arm, q0 + shares[:, None] * (q1 - q0), t0 + shares * (t1 - t0), world).min())


def test_random_motions_long_and_short() -> None:
    rng = np.random.default_rng(0)
    free = touching = 0
    for k in range(400):
        arm = ContinuumArm(n_sections=1 + k % 4)
        q0, q1 = random_configurations(rng, 2, arm.n_sections)
        q1 = q0 + rng.choice([0.0, 0.02, 0.2, 1.0]) * (q1 - q0)
        t0 = rng.uniform(-3, 4)
        t1 = t0 + rng.choice([0.0, 0.1, 1.0, 5.0])
        world = random_world(rng, int(rng.integers(1, 8)), spread_m=0.2)
        seen = densest(arm, q0, t0, q1, t1, world)
        if is_motion_valid(arm, q0, t0, q1, t1, world):
            free += 1
            assert seen > 0, k
        elif seen > 0:
            assert seen < ROOM_M, k
        else:
            touching += 1
    assert min(free, touching) > 80, (free, touching)  # the draw puts both answers to the test


@settings(max_examples=60)
@given(seeds, st.floats(-4e-4, 2e-3))
def test_motions_that_just_miss(seed: int, miss: float) -> None:
    """A sphere put ``miss`` from the body of some instant of the motion, and no nearer at any other of many."""
    rng = np.random.default_rng(seed)
    q0, q1 = random_configurations(rng, 2)
    center, radius = rng.normal(scale=0.2, size=3), 0.001
    world = make_world(0.0, 1.0, np.repeat(center[None, None], 2, axis=0), np.array([radius]))
    room = densest(ARM, q0, 0.0, q1, 1.0, world)
    grown = radius + room - miss
    if grown <= 0:
        return
    near = make_world(0.0, 1.0, world.centers_m, np.array([grown]))
    proven = is_motion_valid(ARM, q0, 0.0, q1, 1.0, near)
    assert proven == (miss > 0) or 0 <= miss < ROOM_M
    if miss > ROOM_M:
        assert proven


def test_what_happens_between_two_free_ends_counts() -> None:
    q0, q1 = np.array([-0.5, 0, 0, 0, 0, 0]), np.array([0.5, 0, 0, 0, 0, 0])
    world = make_world(0.0, 1.0, np.tile([0.0, 0.0, 0.4], (2, 1, 1)), np.array([0.02]))
    assert (clearances(ARM, [q0, q1], 0.0, world) > 0.05).all()
    assert not is_motion_valid(ARM, q0, 0.0, q1, 1.0, world)


def test_an_obstacle_passing_an_arm_at_rest_counts() -> None:
    centers = np.array([[[-0.2, 0.0, 0.4]], [[0.2, 0.0, 0.4]]])
    world, q = make_world(0.0, 1.0, centers, np.array([0.02])), np.zeros(6)
    assert (clearances(ARM, [q, q], [0.0, 1.0], world) > 0.1).all()
    assert not is_motion_valid(ARM, q, 0.0, q, 1.0, world)
    assert is_motion_valid(ARM, q, 0.0, q, 0.35, world)
    assert is_motion_valid(ARM, q, 0.65, q, 1.0, world)


def test_a_bounce_between_samples_counts() -> None:
    # Comes at t = 1 and is gone again at t = 2: the speed bound must be that of the fastest piece.
    centers = np.array([[[0.3, 0, 0.4]], [[0.0, 0, 0.4]], [[0.3, 0, 0.4]], [[0.3, 0, 0.4]]])
    world, q = make_world(0.0, 1.0, centers, np.array([0.02])), np.zeros(6)
    assert not is_motion_valid(ARM, q, 0.0, q, 3.0, world)
    assert is_motion_valid(ARM, q, 2.0, q, 3.0, world)


@pytest.mark.parametrize("margin", [0.0, 0.01, 0.05])
def test_margin_is_kept(margin: float) -> None:
    world = make_world(0.0, 1.0, np.tile([0.0, 0.0, 0.6], (2, 1, 1)), np.array([0.02]))
    gap = 0.6 - 0.45 - 0.02 - 0.018
    q = np.zeros(6)
    assert is_motion_valid(ARM, q, 0.0, q, 1.0, world, margin_m=gap - 2e-4)
    assert not is_motion_valid(ARM, q, 0.0, q, 1.0, world, margin_m=gap + 1e-6)
    assert is_motion_valid(ARM, q, 0.0, q, 1.0, world, margin_m=margin)


def test_everything_is_free_without_obstacles() -> None:
    q0, q1 = random_configurations(np.random.default_rng(2), 2)
    assert is_motion_valid(ARM, q0, 0.0, q1, 1.0, empty_world())


@pytest.mark.parametrize("t1", [-0.1, -math.inf, math.nan])
def test_a_motion_back_in_time_is_refused(t1: float) -> None:
    with pytest.raises(ScenarioError, match="t1_s"):
        is_motion_valid(ARM, np.zeros(6), 0.0, np.zeros(6), t1, empty_world())


@pytest.mark.parametrize(
    ("q1", "message"), [(np.full(6, math.nan), "not finite"), (np.full(6, 3.0), "bend"), (np.zeros(6), None)]
)
def test_ends_are_checked(q1: np.ndarray, message: str | None) -> None:
    if message is None:
        assert is_motion_valid(ARM, np.zeros(6), 0.0, q1, 0.0, empty_world())  # no time at all: a state
    else:
        with pytest.raises(ScenarioError, match=message):
            is_motion_valid(ARM, np.zeros(6), 0.0, q1, 1.0, empty_world())
