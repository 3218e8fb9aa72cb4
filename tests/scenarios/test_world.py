"""Sampled worlds: linear between samples, at rest outside them, with a speed nothing in them exceeds."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from strategies import ARM, empty_world, orbits, random_world, seeds
from twins.clearance import spheres_at

from scenarios import Obstacle, Orbit, clearance, make_world, sample_world

STRAIGHT = np.zeros(6)


def gap(world: object, time: float) -> float:
    """Clearance of the straight arm: all of one sphere above it that can be seen from outside."""
    return clearance(ARM, STRAIGHT, time, world)


def falling(radii: object):
    """A sphere above the tip at z = 0.8, 0.7, 0.55 from t = 10 on, every 2 s."""
    centers = np.zeros((3, 1, 3))
    centers[:, 0, 2] = 0.8, 0.7, 0.55
    return make_world(10.0, 2.0, centers, np.asarray(radii))


@pytest.mark.parametrize(
    ("time", "height"),
    [(10, 0.8), (11, 0.75), (12, 0.7), (12.5, 0.6625), (14, 0.55), (9.9, 0.8), (-1e6, 0.8), (14.1, 0.55), (1e6, 0.55)],
)
def test_linear_between_samples_and_held_outside(time: float, height: float) -> None:
    assert gap(falling([0.02]), time) == pytest.approx(height - 0.45 - 0.02 - 0.018, abs=1e-6)


@pytest.mark.parametrize(("time", "radius"), [(10, 0.01), (11, 0.015), (12, 0.02), (13, 0.06), (99, 0.1)])
def test_radii_grow_with_time(time: float, radius: float) -> None:
    still = np.zeros((3, 1, 3))
    still[:, 0, 2] = 0.8
    world = make_world(10.0, 2.0, still, np.array([[0.01], [0.02], [0.1]]))
    assert gap(world, time) == pytest.approx(0.35 - radius - 0.018, abs=1e-6)


def test_one_radius_for_all_times() -> None:
    assert falling([0.02]).radii_m.tolist() == [[0.02]] * 3


def test_speed_counts_growth_but_not_shrinking() -> None:
    assert falling([0.02]).speed_m_s == pytest.approx(0.075)
    assert falling([[0.02], [0.02], [0.04]]).speed_m_s == pytest.approx(0.085)
    assert falling([[0.06], [0.04], [0.02]]).speed_m_s == pytest.approx(0.075)
    assert empty_world().speed_m_s == 0.0


@given(seeds, st.floats(-3, 5), st.floats(0, 2))
def test_no_surface_approaches_faster_than_the_worlds_speed(seed: int, time: float, later: float) -> None:
    world = random_world(np.random.default_rng(seed), 4)
    before, after = (
        spheres_at(t, world.start_s, world.step_s, world.centers_m, world.radii_m) for t in (time, time + later)
    )
    approach = np.linalg.norm(after[0] - before[0], axis=1) + after[1] - before[1]
    assert (approach <= world.speed_m_s * later + 1e-12).all()


@given(st.lists(orbits, min_size=1, max_size=3), st.floats(-5, 5), st.floats(0, 7), st.sampled_from([0.05, 0.25, 1.0]))
def test_samples_are_the_true_positions(motions: list[Orbit], start: float, length: float, step: float) -> None:
    obstacles = [Obstacle(radius_m=0.02 + 0.01 * k, motion=motion) for k, motion in enumerate(motions)]
    world = sample_world(obstacles, start, start + length, step)
    times = start + step * np.arange(len(world.centers_m))
    assert len(times) >= 2
    assert times[-1] >= start + length - 1e-6
    assert len(times) == 2 or times[-2] < start + length
    for j, obstacle in enumerate(obstacles):
        np.testing.assert_array_equal(world.centers_m[:, j], obstacle.position(times))
    np.testing.assert_array_equal(world.radii_m, np.tile([o.radius_m for o in obstacles], (len(times), 1)))


@pytest.mark.parametrize(
    ("centers", "radii", "step"),
    [
        (np.zeros((1, 2, 3)), np.ones(2), 1.0),
        (np.zeros((2, 2, 2)), np.ones(2), 1.0),
        (np.zeros((2, 3)), np.ones(2), 1.0),
        (np.zeros((2, 2, 3)), np.ones(3), 1.0),
        (np.full((2, 2, 3), math.nan), np.ones(2), 1.0),
        (np.zeros((2, 2, 3)), np.array([1.0, math.inf]), 1.0),
        (np.zeros((2, 2, 3)), np.ones(2), 0.0),
        (np.zeros((2, 2, 3)), np.ones(2), math.nan),
    ],
)
def test_a_world_that_is_none_is_refused(centers: np.ndarray, radii: np.ndarray, step: float) -> None:
    with pytest.raises(ValueError, match=r"world|centers_m|shape"):
        make_world(0.0, step, centers, radii)
