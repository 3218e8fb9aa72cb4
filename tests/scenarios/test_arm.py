"""Three ways to write a configuration, and the workspace they span."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import minimize
from strategies import ARM, configurations

from scenarios import ContinuumArm, ScenarioError


@given(st.data(), st.integers(1, 6))
def test_every_round_trip_of_the_three_notations(data: st.DataObject, n: int) -> None:
    arm = ContinuumArm(n_sections=n)
    q = data.draw(configurations(n))
    arcs, lengths = arm.arcs_from_bending(q), arm.lengths_from_bending(q)
    assert arcs.shape == (n, 2)
    assert lengths.shape == (n, 3)
    np.testing.assert_allclose(arm.bending_from_arcs(arcs), q, atol=1e-12)
    np.testing.assert_allclose(arm.bending_from_lengths(lengths), q, atol=1e-12)
    np.testing.assert_allclose(arm.bending_from_lengths(lengths[:, 1:]), q, atol=1e-12)


@given(configurations())
def test_lengths_are_the_papers(q: np.ndarray) -> None:
    lengths, r = ARM.lengths_from_bending(q), ARM.actuator_offset_m
    np.testing.assert_allclose(lengths.sum(axis=1), 0, atol=1e-15)
    for (theta, phi), row in zip(ARM.arcs_from_bending(q), lengths, strict=True):
        for i in (1, 2, 3):
            assert row[i - 1] == pytest.approx(-r * phi * math.cos(2 * math.pi / 3 * (i - 1) - theta), abs=1e-15)


@given(configurations())
def test_arcs_from_lengths_by_the_robosoft_formulas(q: np.ndarray) -> None:
    r = ARM.actuator_offset_m
    for (theta, phi), (l1, l2, l3) in zip(ARM.arcs_from_bending(q), ARM.lengths_from_bending(q), strict=True):
        squares = l1 * l1 - l1 * l2 + l2 * l2 - l2 * l3 + l3 * l3 - l3 * l1
        assert 2 * math.sqrt(max(squares, 0)) / (3 * r) == pytest.approx(phi, abs=1e-7)
        if phi > 1e-3:
            difference = theta - math.atan2(math.sqrt(3) * (l3 - l2), l2 + l3 - 2 * l1)
            assert math.remainder(difference, 2 * math.pi) == pytest.approx(0, abs=1e-9)


def test_one_actuator_pulled_bends_towards_it() -> None:
    arm = ContinuumArm(n_sections=1)
    l1 = -0.01  # the actuator on the x axis gets shorter
    u, v = arm.bending_from_lengths([l1, -l1 / 2, -l1 / 2])
    assert u == pytest.approx(0.01 / arm.actuator_offset_m)
    assert v == pytest.approx(0)
    assert arm.tip([u, v])[0] > 0


def test_a_backbone_does_not_stretch() -> None:
    with pytest.raises(ScenarioError, match="l1 \\+ l2 \\+ l3 = 0"):
        ARM.bending_from_lengths(np.full((3, 3), 0.001))


@pytest.mark.parametrize(
    ("axis", "sign", "optimum"),
    [(0, 1, 0.40235), (1, -1, 0.40235), (2, -1, 0.300), (2, 1, 0.450)],
    ids=["x", "-y", "-z", "z"],
)
def test_continuous_workspace_box(axis: int, sign: int, optimum: float) -> None:
    rng, bounds = np.random.default_rng(0), [(-4.0, 4.0), (0.0, math.pi)] * 3

    def lost(arcs: np.ndarray) -> tuple[float, np.ndarray]:
        arcs = arcs.reshape(3, 2)
        q = ARM.bending_from_arcs(arcs)
        by_bending = -sign * ARM.jacobian(q)[axis].reshape(3, 2)
        c, s, phi = np.cos(arcs[:, 0]), np.sin(arcs[:, 0]), arcs[:, 1]
        by_theta = phi * (by_bending[:, 1] * c - by_bending[:, 0] * s)
        by_phi = by_bending[:, 0] * c + by_bending[:, 1] * s
        return -sign * ARM.tip(q)[axis], np.column_stack([by_theta, by_phi]).reshape(-1)

    starts = rng.uniform(0.1, 3.0, size=(8, 6)) * np.where(np.arange(6) % 2, 1, rng.choice([-1, 1], size=(8, 6)))
    best = min(minimize(lost, start, jac=True, bounds=bounds).fun for start in starts)
    assert -best == pytest.approx(optimum, abs=1e-5)


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("n_sections", 0),
        ("n_sections", 13),
        ("section_length_m", 0.0),
        ("radius_m", -1.0),
        ("radius_m", math.nan),
        ("max_bend_rad", 3.2),
        ("max_tip_speed_m_s", math.inf),
        ("colour", "red"),
    ],
)
def test_an_impossible_arm_is_refused(field: str, value: object) -> None:
    with pytest.raises(ValueError, match=field):
        ContinuumArm.model_validate({field: value})
