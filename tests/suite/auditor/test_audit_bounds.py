"""The derivation's bounds, tried by random search."""

import numpy as np
import pytest
from audit_twin import backbone, random_bending
from hypothesis import given, settings
from hypothesis import strategies as st

from scenarios import ContinuumArm, Scenario
from suite.auditor import Kind, audit
from suite.auditor._kernels import CHORDS, speed_bounds
from suite.auditor.motion._kernels import LIMIT_SLACK

STEP = 1e-5


def ratios(arm, q, direction):
    """Speed of body points over their chord's bound, (n * CHORDS * 4,), when bending along ``direction``."""
    shares = np.linspace(0.0, 1.0, 4 * CHORDS + 1)
    moved = backbone(arm, np.stack([q - STEP * direction, q + STEP * direction]), shares)
    speeds = np.linalg.norm(moved[1] - moved[0], axis=1) / (2 * STEP)
    speeds = speeds.reshape(arm.n_sections, -1)[:, 1:].reshape(arm.n_sections, CHORDS, 4)
    bounds = np.empty(arm.n_sections * CHORDS)
    speed_bounds(q, q + direction, 1.0, arm.section_length_m, CHORDS, bounds)
    return speeds / bounds.reshape(arm.n_sections, CHORDS, 1)


def test_no_body_point_outruns_its_bound_however_hard_one_searches():
    rng = np.random.default_rng(7)
    largest = 0.0
    for n in (1, 2, 3, 5):
        arm = ContinuumArm(n_sections=n)
        for _ in range(20):
            q, direction = random_bending(rng, n), random_bending(rng, n, 1.0)
            best = ratios(arm, q, direction).max()
            for k in range(60):  # climb
                scale = 0.5 * 0.93**k
                other, turned = q + scale * rng.normal(size=2 * n), direction + scale * rng.normal(size=2 * n)
                ratio = ratios(arm, other, turned).max()
                if ratio > best:
                    q, direction, best = other, turned, ratio
            largest = max(largest, best)
    assert 0.99 < largest <= 1.0 + 1e-6


def test_the_bound_is_attained_by_the_straight_arm():
    arm = ContinuumArm()
    assert ratios(arm, np.zeros(6), np.array([1.0, 0, 1, 0, 1, 0]))[:, :, -1] == pytest.approx(1.0, abs=1e-6)


def tip_speeds(arm, times, states, instants):
    h = 1e-6
    q = [np.stack([np.interp(instants + d, times, column) for column in states.T], axis=1) for d in (-h, h)]
    tips = [backbone(arm, one, np.array([1.0]))[:, -1] for one in q]
    return np.linalg.norm(tips[1] - tips[0], axis=1) / (2 * h)


@settings(max_examples=100)
@given(seed=st.integers(0, 2**32 - 1), share_of_limit=st.floats(0.9, 1.1), duration_s=st.floats(0.05, 20.0))
def test_tip_speed_is_certified_and_excess_is_excess(seed, share_of_limit, duration_s):
    rng = np.random.default_rng(seed)
    arm = ContinuumArm()
    times = np.array([0.0, duration_s])
    start = random_bending(rng, 3, 2.0)
    states = np.stack([start, start + min(0.15 * duration_s, 1.0) * random_bending(rng, 3, 1.0)])
    inside = np.linspace(1e-6, duration_s - 1e-6, 500)
    fastest = tip_speeds(arm, times, states, inside).max()
    limit = fastest / share_of_limit
    arm = arm.model_copy(update={"max_tip_speed_m_s": limit})
    scenario = Scenario(id="tip", arm=arm, start_rad=tuple(start), goal_m=(5, 5, 5))
    verdict = audit(scenario, times, states).executable
    if share_of_limit > 1.0 + 2.0 * LIMIT_SLACK + 1e-5:
        assert verdict.violation_kind == Kind.TIP_SPEED
    if share_of_limit < 1.0 + LIMIT_SLACK - 1e-3:  # the 500 instants may miss the fastest
        assert verdict.violation_kind != Kind.TIP_SPEED
    if verdict.violation_kind == Kind.TIP_SPEED:
        at = np.clip(verdict.violation_time_s, inside[0], inside[-1])
        assert tip_speeds(arm, times, states, np.array([at]))[0] > limit


def test_tip_speed_of_a_motion_that_swings_and_stops_is_found_inside():
    arm = ContinuumArm(n_sections=1, max_tip_speed_m_s=0.02, max_bend_rate_rad_s=10.0)
    # Fast while straight, slow while rolled up: the ends of the motion are its slowest instants.
    states = np.array([[-3.1, 0.0], [3.1, 0.0]])
    speed = tip_speeds(arm, np.array([0.0, 20.0]), states, np.array([1e-3, 10.0]))
    assert speed[0] < 0.02 < speed[1]
    scenario = Scenario(id="swing", arm=arm, start_rad=(-3.1, 0.0), goal_m=(5, 5, 5))
    verdict = audit(scenario, [0.0, 20.0], states).executable
    assert verdict.violation_kind == Kind.TIP_SPEED
    at = tip_speeds(arm, np.array([0.0, 20.0]), states, np.array([verdict.violation_time_s]))[0]
    assert 0.02 < at < 0.0202  # found where it begins


@pytest.mark.parametrize("duration_s", [2e-9, 1e-6, 1.0, 3000.0])
def test_a_limit_that_is_met_exactly_is_met_at_any_pace(duration_s):
    arm = ContinuumArm(n_sections=1)
    rate = arm.max_bend_rate_rad_s
    arm = arm.model_copy(update={"max_tip_speed_m_s": rate * arm.section_length_m / 2})
    states = np.array([[0.0, 0.0], [min(rate * duration_s, 3.0), 0.0]])
    scenario = Scenario(id="exact", arm=arm, start_rad=(0, 0), goal_m=(5, 5, 5), time_limit_s=3600)
    assert audit(scenario, [0.0, duration_s], states).executable.violation_kind == Kind.SHORT_OF_GOAL


@pytest.mark.parametrize("limit", ["max_bend_rate_rad_s", "max_tip_speed_m_s"])
@pytest.mark.parametrize(("share", "passes"), [(1.0, True), (1.0009, True), (1.0021, False), (1.05, False)])
def test_the_slack_of_the_limits_is_the_one_that_docs_state(limit, share, passes):
    """One part in a thousand passes, two are found; a tip is fastest while its section is straight."""
    states = np.array([[0.0, 0.0], [0.3, 0.0]])
    reached = {"max_bend_rate_rad_s": 0.3, "max_tip_speed_m_s": 0.3 * 0.15 / 2}
    limits = {name: 1.5 * value for name, value in reached.items()} | {limit: reached[limit] / share}
    scenario = Scenario(id="s", arm=ContinuumArm(n_sections=1, **limits), start_rad=(0, 0), goal_m=(5, 5, 5))
    kind = audit(scenario, [0.0, 1.0], states).executable.violation_kind
    found = Kind.BEND_RATE if limit == "max_bend_rate_rad_s" else Kind.TIP_SPEED
    assert kind == (Kind.SHORT_OF_GOAL if passes else found)
