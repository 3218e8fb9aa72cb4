"""The arm's forward kinematics and Jacobian against twins that share no formula with the kernels."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from strategies import configurations, random_configurations
from twins.kinematics import backbone, backbone_point

from scenarios import ContinuumArm, ScenarioError


def straight_error(n: int) -> float:
    """What it may cost to compute straight sections as if bent by 1e-6 rad towards x."""
    return 1e-6 * n * n * 0.15 + 1e-9


@given(st.data(), st.integers(1, 6))
def test_backbone_is_the_chain_of_rotation_vectors(data: st.DataObject, n: int) -> None:
    arm = ContinuumArm(n_sections=n)
    q = data.draw(configurations(n))
    arc_lengths = np.linspace(0, arm.length_m, 4 * n + 1)
    expected = [backbone_point(q, arm.section_length_m, s) for s in arc_lengths]
    np.testing.assert_allclose(arm.backbone_points(q, 4), expected, atol=straight_error(n))
    np.testing.assert_allclose(arm.tip(q), expected[-1], atol=straight_error(n))


@given(configurations())
def test_backbone_is_the_chain_of_the_papers_frames(q: np.ndarray) -> None:
    if np.hypot(q[0::2], q[1::2]).min() < 1e-3:
        q = q + 0.01 * np.sign(0.5 - np.abs(q) / np.pi)  # the paper's frames are singular when straight
    arm = ContinuumArm()
    q = np.clip(q, -2.2, 2.2)
    expected = [backbone_point(q, 0.15, s, by_angles=True) for s in np.linspace(0, 0.45, 10)]
    np.testing.assert_allclose(arm.backbone_points(q, 3), expected, atol=1e-9)


def test_twins_agree_with_each_other() -> None:
    for q in random_configurations(np.random.default_rng(0), 20):
        expected = [backbone_point(q, 0.15, s) for s in np.linspace(0, 0.45, 10)]
        np.testing.assert_allclose(backbone(q, 0.15, 3), expected, atol=1e-12)
        by_angles = [backbone_point(q, 0.15, s, by_angles=True) for s in np.linspace(0, 0.45, 10)]
        np.testing.assert_allclose(by_angles, expected, atol=1e-12)


@pytest.mark.parametrize(
    ("q", "tip"),
    [
        ([0, 0, 0, 0, 0, 0], [0, 0, 0.45]),
        ([np.pi, 0, 0, 0, 0, 0], [0.3 / np.pi, 0, -0.3]),
        ([0, np.pi / 2, 0, 0, 0, 0], [0, 0.3 / np.pi + 0.3, 0.3 / np.pi]),
        ([np.pi / 2, 0, -np.pi / 2, 0, 0, 0], [0.6 / np.pi, 0, 0.6 / np.pi + 0.15]),
        ([2 * np.pi / 3, 0, 2 * np.pi / 3, 0, 2 * np.pi / 3, 0], [0, 0, 0]),
    ],
    ids=["straight", "half circle down", "quarter circle in y", "an s", "a full circle"],
)
def test_tip_of_shapes_one_can_draw(q: list[float], tip: list[float]) -> None:
    np.testing.assert_allclose(ContinuumArm().tip(q), tip, atol=straight_error(3))


@given(st.data(), st.integers(1, 5), st.floats(0, 1))
def test_jacobian_is_the_finite_difference(data: st.DataObject, n: int, share: float) -> None:
    arm = ContinuumArm(n_sections=n)
    q, s, h = data.draw(configurations(n)), share * arm.length_m, 1e-5
    numeric = np.empty((3, arm.dof))
    for k in range(arm.dof):
        forward, back = (backbone_point(q + sign * h * np.eye(arm.dof)[k], 0.15, s) for sign in (1, -1))
        numeric[:, k] = (forward - back) / (2 * h)
    np.testing.assert_allclose(arm.jacobian(q, s), numeric, atol=straight_error(n) + 1e-8)


def test_jacobian_of_a_straight_arm_by_hand() -> None:
    # A bend du swings what lies beyond the section about its middle: L/2 + (sections beyond) L.
    levers = 0.15 * np.array([2.5, 1.5, 0.5])
    expected = np.zeros((3, 6))
    expected[0, 0::2], expected[1, 1::2] = levers, levers
    np.testing.assert_allclose(ContinuumArm().jacobian(np.zeros(6)), expected, atol=straight_error(3))


def test_jacobian_ends_where_the_point_is() -> None:
    arm = ContinuumArm()
    q = random_configurations(np.random.default_rng(1), 1)[0]
    assert (arm.jacobian(q, 0.15)[:, 2:] == 0).all()
    assert (arm.jacobian(q, 0.0) == 0).all()
    np.testing.assert_array_equal(arm.jacobian(q), arm.jacobian(q, arm.length_m))


@settings(max_examples=50)
@given(configurations(), configurations(), st.floats(0, 0.45))
def test_no_body_point_outruns_the_bound_of_the_certificate(q: np.ndarray, dq: np.ndarray, s: float) -> None:
    lengths = [np.clip(s - 0.15 * i, 0, 0.15) for i in range(3)]
    # Section i turns what lies beyond it: half its own part, and all that follows.
    bound = sum((lengths[i] / 2 + max(0.0, s - 0.15 * (i + 1))) * np.hypot(dq[2 * i], dq[2 * i + 1]) for i in range(3))
    assert np.linalg.norm(ContinuumArm().jacobian(q, s) @ dq) <= bound * (1 + 1e-9) + 1e-9


@pytest.mark.parametrize("s", [-0.01, 0.46, np.nan])
def test_jacobian_off_the_arm_is_refused(s: float) -> None:
    with pytest.raises(ScenarioError, match="arc_length_m"):
        ContinuumArm().jacobian(np.zeros(6), s)


@pytest.mark.parametrize(
    ("q", "message"),
    [
        (np.zeros(4), "shape"),
        (np.zeros((1, 1, 6)), "shape"),
        ([np.nan, 0, 0, 0, 0, 0], "not finite"),
        ([np.inf, 0, 0, 0, 0, 0], "not finite"),
        ([0, 0, 0, 0, 3.0, 3.0], "bend of 4.2426"),
    ],
)
def test_a_configuration_no_arm_can_take_is_refused(q: object, message: str) -> None:
    with pytest.raises(ScenarioError, match=message):
        ContinuumArm().tip(q)
