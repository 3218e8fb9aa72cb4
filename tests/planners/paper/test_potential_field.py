"""The potential field: each of its three terms alone, and the rates it keeps to."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from strategies import ARM, configurations, random_configurations, seeds
from twins.kinematics import backbone

from planners import Observation, Session, parse_planner
from planners.paper.potential_field import PotentialFieldSettings, _kernels
from scenarios import generate
from scenarios.kernels.kinematics import ARC_SIZE

NOWHERE = np.array([[9.0, 9.0, 9.0]])
RADII = np.array([0.03])


def follow(q: np.ndarray, goal: np.ndarray, center: np.ndarray, duration: float = 0.1, **settings: float) -> np.ndarray:
    s = PotentialFieldSettings(**settings)
    fastest_push = 10.0 * ARM.max_tip_speed_m_s
    gains = (s.attraction, s.repulsion, s.influence_m, fastest_push, s.limit_gain, s.limit_margin_rad)
    return _kernels.field_step(
        q, goal, np.atleast_2d(center).astype(float), RADII, ARM.section_length_m, ARM.radius_m, ARM.max_bend_rad,
        ARM.max_bend_rate_rad_s, ARM.max_tip_speed_m_s, duration, gains,
    )  # fmt: skip


@settings(max_examples=60)
@given(configurations(), seeds)
def test_the_nearest_body_point_is_that_of_a_sampled_backbone(q: np.ndarray, seed: int) -> None:
    center, point = np.random.default_rng(seed).normal(scale=0.2, size=3), np.empty(3)
    arc_length, distance = _kernels.nearest_on_body(q, ARM.section_length_m, np.empty((3, ARC_SIZE)), center, point)
    points = backbone(q, ARM.section_length_m, 400)
    gaps = np.linalg.norm(points - center, axis=1)
    assert gaps.min() - 0.15 / 400 / 2 - 1e-6 <= distance <= gaps.min() + 1e-6
    assert distance == pytest.approx(np.linalg.norm(point - center))
    np.testing.assert_allclose(point, points[round(arc_length / 0.15 * 400)], atol=0.15 / 400 + 1e-6)


def test_the_goal_attracts_the_tip() -> None:
    rng = np.random.default_rng(0)
    for q, other in zip(random_configurations(rng, 20), random_configurations(rng, 20), strict=True):
        q, goal = 0.7 * q, ARM.tip(0.7 * other)
        after = follow(q, goal, NOWHERE, limit_gain=0.0)
        assert np.linalg.norm(ARM.tip(after) - goal) < np.linalg.norm(ARM.tip(q) - goal)


def test_at_the_goal_it_stays() -> None:
    q = np.full(6, 0.4)
    np.testing.assert_allclose(follow(q, ARM.tip(q), NOWHERE, limit_gain=0.0), q, atol=1e-9)


@pytest.mark.parametrize("share", [0.3, 0.7, 1.0])
def test_an_obstacle_near_any_part_of_the_body_repels_it(share: float) -> None:
    q = np.full(6, 0.4)
    points = ARM.backbone_points(q, 20)
    body = points[round(share * 60)]
    along = points[min(60, round(share * 60) + 1)] - points[round(share * 60) - 1]
    aside = np.cross(along, [0.0, 1.0, 0.0])
    center = body + 0.06 * aside / np.linalg.norm(aside)
    after = follow(q, ARM.tip(q), center, limit_gain=0.0)
    gap = [np.linalg.norm(ARM.backbone_points(p, 20) - center, axis=1).min() for p in (q, after)]
    assert gap[1] > gap[0] + 1e-6
    far = body + (ARM.radius_m + RADII[0] + 0.051) * aside / np.linalg.norm(aside)
    np.testing.assert_allclose(follow(q, ARM.tip(q), far, limit_gain=0.0), q, atol=1e-9)  # past its influence


def test_actuators_are_kept_off_the_ends_of_their_range() -> None:
    for theta in np.linspace(0, 2 * math.pi, 6, endpoint=False):  # along an actuator, where its end is nearest
        bent = np.zeros(6)
        bent[2:4] = 3.1 * np.array([math.cos(theta), math.sin(theta)])
        after = follow(bent, ARM.tip(bent), NOWHERE)
        assert np.hypot(*after[2:4]) < 3.1
        middle = bent * 0.5
        np.testing.assert_allclose(follow(middle, ARM.tip(middle), NOWHERE), middle, atol=1e-9)


@settings(max_examples=80)
@given(configurations(), configurations(), seeds)
def test_it_never_outruns_or_overbends_the_arm(q: np.ndarray, other: np.ndarray, seed: int) -> None:
    center = np.random.default_rng(seed).normal(scale=0.15, size=3)
    after = follow(q, ARM.tip(other), center, attraction=100.0, repulsion=1.0, limit_gain=1.0)
    assert np.isfinite(after).all()
    assert ARM.within_bends(after).all()
    assert np.hypot(*(after - q).reshape(3, 2).T).max() <= ARM.max_bend_rate_rad_s * 0.1 * (1 + 1e-9)
    steps = ARM.tips(q + np.linspace(0, 1, 21)[:, None] * (after - q))
    assert np.linalg.norm(np.diff(steps, axis=0), axis=1).max() * 20 <= ARM.max_tip_speed_m_s * 0.1 * 1.01


def test_rates_bind_it_where_limits_do() -> None:
    scenario = generate("orbit", 1, 1, 3)[0]
    times = np.arange(-scenario.observation_s, 0.5)
    centers = np.stack([obstacle.position(times) for obstacle in scenario.obstacles], axis=1)
    seen = Observation(times, centers, np.array([obstacle.radius_m for obstacle in scenario.obstacles]))
    fastest = []
    for limits in (True, False):
        session = Session(parse_planner("pf"), scenario, predictor="cubic", limits=limits, seed=1)
        plan = session.plan(scenario.start, 0.0, seen)
        steps = np.linalg.norm(np.diff(ARM.tips(plan.configurations_rad), axis=0), axis=1)
        fastest.append((steps / np.diff(plan.times_s)).max())
    assert fastest[0] <= ARM.max_tip_speed_m_s
    # Without limits the tip goes for the goal at the gain times its distance.
    gap = np.linalg.norm(ARM.tip(scenario.start) - scenario.goal)
    assert fastest[1] > 3 * ARM.max_tip_speed_m_s
    assert fastest[1] == pytest.approx(0.5 * gap, rel=0.5)
