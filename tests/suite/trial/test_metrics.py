"""Every number of a motion's quality against a slow twin, and in cases that can be solved by hand."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from strategies import configurations, random_configurations, seeds
from twins import metrics as twin

from scenarios import ContinuumArm
from suite.trial.metrics import TIP_PATH_ERROR, smoothness_bending_rad, smoothness_paper_rad, tip_path_length_m

ARM = ContinuumArm()
motions = st.integers(1, 4).flatmap(lambda n: st.lists(configurations(n), min_size=1, max_size=5).map(np.array))


def arm_of(motion: np.ndarray) -> ContinuumArm:
    return ContinuumArm(n_sections=motion.shape[1] // 2)


@settings(max_examples=150)
@given(motions)
def test_the_tips_path_is_as_long_as_a_dense_sum_says(motion: np.ndarray) -> None:
    arm = arm_of(motion)
    expected = twin.tip_path_length(motion, arm.section_length_m)
    # Kinematics take a bend below a microradian for straight, which moves the tip by less than a micrometre.
    assert tip_path_length_m(arm, motion) == pytest.approx(expected, rel=TIP_PATH_ERROR, abs=1e-6)


@settings(max_examples=60)
@given(seeds, st.floats(0.01, 1.0), st.booleans())
def test_so_is_that_of_random_motions_small_and_large_and_through_straight(
    seed: int, share: float, through_straight: bool
) -> None:
    start, end = random_configurations(np.random.default_rng(seed), 2)
    motion = np.array([start, -share * start if through_straight else start + share * (end - start)])
    expected = twin.tip_path_length(motion, ARM.section_length_m)
    assert tip_path_length_m(ARM, motion) == pytest.approx(expected, rel=TIP_PATH_ERROR)


def test_a_bend_in_one_plane_by_hand() -> None:
    """One section that bends from straight to a half circle: the tip's speed is known in closed form."""
    arm, phi = ContinuumArm(n_sections=1), np.linspace(1e-9, math.pi, 400_001)
    # The tip is L ((1 - cos phi) / phi, sin phi / phi).
    dx = (np.sin(phi) * phi - (1 - np.cos(phi))) / phi**2
    dz = (np.cos(phi) * phi - np.sin(phi)) / phi**2
    expected = arm.section_length_m * np.trapezoid(np.hypot(dx, dz), phi)
    assert tip_path_length_m(arm, np.array([[0.0, 0.0], [0.0, math.pi]])) == pytest.approx(expected, rel=1e-5)


@pytest.mark.parametrize("states", [1, 2, 50])
def test_an_arm_at_rest_goes_nowhere(states: int) -> None:
    motion = np.tile(np.linspace(-1.0, 1.0, 6), (states, 1))
    assert tip_path_length_m(ARM, motion) == 0.0
    assert smoothness_paper_rad(motion) == 0.0
    assert smoothness_bending_rad(motion) == 0.0


def test_a_state_between_two_changes_no_length() -> None:
    start, end = random_configurations(np.random.default_rng(4), 2)
    whole = np.array([start, end])
    parts = np.array([start, start + 0.3 * (end - start), end])
    assert tip_path_length_m(ARM, parts) == pytest.approx(tip_path_length_m(ARM, whole), rel=TIP_PATH_ERROR)
    assert smoothness_bending_rad(parts) == pytest.approx(smoothness_bending_rad(whole))


@settings(max_examples=200)
@given(motions)
def test_smoothness_is_what_the_letters_say(motion: np.ndarray) -> None:
    assert smoothness_paper_rad(motion) == pytest.approx(twin.smoothness_paper(motion), abs=1e-12)
    assert smoothness_bending_rad(motion) == pytest.approx(twin.smoothness_bending(motion), abs=1e-12)


def in_plane(theta: float, phi: float) -> list[float]:
    return [phi * math.cos(theta), phi * math.sin(theta)]


def test_theta_is_wrapped() -> None:
    """From 3 rad to -3 rad is 0.28 rad across the seam, not 6 rad back through zero."""
    across = np.array([in_plane(3.0, 1.0), in_plane(-3.0, 1.0)])
    assert smoothness_paper_rad(across) == pytest.approx(2 * math.pi - 6.0)
    both = np.array([in_plane(3.0, 1.0) + in_plane(0.0, 1.0), in_plane(-3.0, 1.0) + in_plane(0.3, 1.4)])
    assert smoothness_paper_rad(both) == pytest.approx(2 * math.pi - 6.0 + 0.5)


def test_a_straight_section_has_its_neighbours_plane() -> None:
    through = np.array([in_plane(0.0, 0.7), [0.0, 0.0], in_plane(2.0, 0.4)])
    assert smoothness_paper_rad(through) == pytest.approx(0.7 + 0.4)
    assert smoothness_bending_rad(through) == pytest.approx(0.7 + 0.4)
