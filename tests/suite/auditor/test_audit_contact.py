"""What touched first, by the audit, by FCL, and by dense points."""

import numpy as np
import pytest
from audit_twin import Motion, random_motion, touching
from hypothesis import given, settings
from hypothesis import strategies as st

from scenarios import ContinuumArm, Obstacle, Scenario, Track
from suite.auditor import audit
from suite.auditor._kernels import CONTACT_M
from suite.auditor.fcl_engine import sampled_contacts

CLOSE_M = 1.2 * CONTACT_M + 8e-6  # as far as a contact may be from touching: docs/audit.md


@settings(max_examples=500)
@given(seed=st.integers(0, 2**32 - 1))
def test_what_is_said_to_touch_does_and_nothing_else_did_before(seed):
    motion = random_motion(np.random.default_rng(seed))
    contact = audit(*motion).contact
    if contact is None:
        return
    apart = touching(motion, contact.time_s)
    assert apart[contact.section - 1, contact.obstacle - 1] < CLOSE_M
    assert apart.min() >= -1e-6 or contact.time_s == 0.0  # as found by advancing: nothing is in deep yet
    earlier = touching(motion, max(0.0, contact.time_s - 1e-3))
    assert contact.time_s < 1e-3 or earlier.min() > 0.0


def test_fcl_says_the_same_wherever_only_one_pair_is_near():
    rng, said = np.random.default_rng(3), 0
    for _ in range(300):
        motion = random_motion(rng)
        certified, sampled = audit(*motion).contact, audit(*motion, sampled_contacts).contact
        if sampled is None or sampled.time_s - certified.time_s > 0.011:
            continue
        near = np.sort(np.concatenate([touching(motion, t).ravel() for t in (certified.time_s, sampled.time_s)]))
        if len(near) > 2 and near[2] < 0.01:
            continue
        said += 1
        assert certified[1:3] == sampled[1:3]  # obstacle and section
    assert said > 20


ARM = ContinuumArm(n_sections=2)


def passing(height_m: float, at_s: float) -> Obstacle:
    """Crosses the unbent arm's axis at a height."""
    times, away = (at_s - 0.5, at_s + 0.5), ((0.3, 0.0, height_m), (-0.3, 0.0, height_m))
    return Obstacle(radius_m=0.02, motion=Track(times_s=times, positions_m=away))


def rest(duration_s: float = 10.0) -> tuple[np.ndarray, np.ndarray]:
    return np.arange(duration_s + 1), np.zeros((int(duration_s) + 1, 4))


def motion_among(*obstacles: Obstacle, states: np.ndarray | None = None) -> Motion:
    times, still = rest()
    scenario = Scenario(id="row", arm=ARM, start_rad=(0,) * 4, goal_m=(5, 5, 5), obstacles=obstacles)
    return Motion(scenario, times, still if states is None else states)


@pytest.mark.parametrize("engine", [None, sampled_contacts])
@pytest.mark.parametrize(("height_m", "section"), [(0.05, 1), (0.25, 2)])
def test_obstacles_and_sections_are_counted_from_one(height_m: float, section: int, engine) -> None:
    motion = motion_among(passing(0.1, 7.5), passing(height_m, 3.5), passing(0.2, 8.5))
    contact = audit(*motion, *([engine] if engine else [])).contact
    assert (contact.obstacle, contact.section, contact.is_moving) == (2, section, False)
    assert 3.0 < contact.time_s < 3.5


def test_a_contact_at_a_timed_state_belongs_to_the_way_there() -> None:
    wall = Obstacle(radius_m=0.02, motion=Track(times_s=(3.9, 4.0), positions_m=((0.3, 0, 0.1), (0.0380999, 0, 0.1))))
    _, still = rest()
    sets_out, stops = still.copy(), still.copy()
    sets_out[5:, 2] = 0.3  # holds until 4 s
    stops[1:, 2] = 0.05 * np.minimum(np.arange(1, 11), 4)  # holds from 4 s on
    for states, is_moving in ((sets_out, False), (stops, True)):
        contact = audit(*motion_among(wall, states=states)).contact
        assert contact.time_s == 4.0
        assert contact.is_moving == is_moving


def test_an_arm_that_is_touched_at_once_has_not_moved() -> None:
    states = rest()[1]
    states[1:, 0] = 0.1
    there = Obstacle(radius_m=0.02, motion=Track(times_s=(0.0,), positions_m=((0.03, 0, 0.1),)))
    assert audit(*motion_among(there, states=states)).contact == (0.0, 1, 1, False)


def test_no_contact_without_a_touch() -> None:
    assert audit(*motion_among()).contact is None
    assert audit(*motion_among(passing(1.0, 3.5))).contact is None
    assert audit(motion_among().scenario, np.empty(0), np.empty((0, 4))).contact is None
