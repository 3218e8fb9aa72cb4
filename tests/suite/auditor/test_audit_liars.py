"""Trajectories that claim what is not so, each caught for what it is."""

import numpy as np
import pytest

from scenarios import ContinuumArm, Obstacle, Scenario, Track
from suite.auditor import Kind, audit

ARM = ContinuumArm(n_sections=1)
GOAL = np.array([1.0, 0.0])  # the bend whose tip is the goal
FAST = ARM.model_copy(update={"max_tip_speed_m_s": 10.0, "max_bend_rate_rad_s": 10.0})


def scenario(arm=ARM, obstacles=(), **fields):
    return Scenario(
        id="liar", arm=arm, start_rad=(0.0, 0.0), goal_m=tuple(ARM.tip(GOAL)), obstacles=obstacles, **fields
    )


def walk(duration_s=20.0, count=21, end=GOAL):
    """An honest motion from straight to ``end``."""
    return np.linspace(0.0, duration_s, count), np.linspace(0.0, 1.0, count)[:, None] * end


def sphere(*timed_points):
    times, points = zip(*timed_points, strict=True)
    return Obstacle(radius_m=0.02, motion=Track(times_s=times, positions_m=points))


def kinds(judged):
    return tuple(verdict.violation_kind for verdict in (judged.per_step, judged.swept, judged.executable))


def times_of(judged):
    return tuple(verdict.violation_time_s for verdict in (judged.per_step, judged.swept, judged.executable))


def test_an_honest_motion_succeeds_by_every_verdict():
    judged = audit(scenario(), *walk())
    assert kinds(judged) == ("", "", "")
    assert judged.per_step.success
    assert judged.swept.success
    assert judged.executable.success
    assert judged.arrival_time_s == judged.end_time_s
    assert 17.0 <= judged.arrival_time_s <= 20.0  # the first state within the tolerance


def test_passing_through_an_obstacle_between_two_seconds():
    # It crosses the arm at 3.5 s and is out of the way at every whole second.
    crossing = sphere((3.05, (0.3, 0.0, 0.1)), (3.95, (-0.3, 0.0, 0.1)))
    judged = audit(scenario(obstacles=(crossing,)), *walk())
    assert kinds(judged) == ("", Kind.COLLISION, Kind.COLLISION)
    assert judged.per_step.success
    assert 3.3 < judged.swept.violation_time_s < 3.5


def test_hitting_an_obstacle_at_a_whole_second():
    crossing = sphere((3.0, (0.3, 0.0, 0.1)), (4.0, (0.0, 0.0, 0.1)), (5.0, (0.3, 0.0, 0.1)))
    judged = audit(scenario(obstacles=(crossing,)), *walk())
    assert kinds(judged) == (Kind.COLLISION,) * 3
    assert judged.per_step.violation_time_s == 4.0
    assert 3.7 < judged.swept.violation_time_s < 4.0


def test_jumping_in_shape_within_a_step_is_no_motion_an_arm_could_make():
    judged = audit(scenario(), [0.0, 1.0, 2.0], np.array([[0.0, 0.0], [0.0, 0.0], GOAL]))
    assert kinds(judged) == ("", "", Kind.BEND_RATE)
    assert judged.executable.violation_time_s == 1.0


def test_tip_too_fast():
    judged = audit(scenario(), *walk(duration_s=2.2))
    assert kinds(judged) == ("", "", Kind.TIP_SPEED)


def with_row(times, states, index, time_s=None, state=None):
    times, states = times.copy(), states.copy()
    times[index] = times[index] if time_s is None else time_s
    states[index] = states[index] if state is None else state
    return times, states


LIES = {
    "nan in a configuration": (with_row(*walk(), 5, state=(np.nan, 0.0)), Kind.NOT_FINITE, 4.0),
    "nan beside a number": (with_row(*walk(), 5, state=(0.1, np.nan)), Kind.NOT_FINITE, 4.0),
    "infinite bend": (with_row(*walk(), 5, state=(np.inf, 0.0)), Kind.NOT_FINITE, 4.0),
    "nan as time": (with_row(*walk(), 5, time_s=np.nan), Kind.NOT_FINITE, 4.0),
    "nan at the start": (with_row(*walk(), 0, state=(np.nan, np.nan)), Kind.NOT_FINITE, 0.0),
    "starts elsewhere": (with_row(*walk(), 0, state=(0.0, 0.01)), Kind.WRONG_START, 0.0),
    "starts late": ((walk()[0] + 1.0, walk()[1]), Kind.WRONG_START, 0.0),
    "nothing at all": ((np.empty(0), np.empty((0, 2))), Kind.WRONG_START, 0.0),
    "goes back in time": (with_row(*walk(), 5, time_s=3.5), Kind.BACKWARD_TIME, 4.0),
    "is in two places at once": (with_row(*walk(), 5, time_s=4.0), Kind.JUMP, 4.0),
    "bends past pi": (with_row(*walk(), 5, state=(2.5, 2.5)), Kind.BEND_LIMIT, 4.0),
    "ends short of the goal": (walk(end=0.5 * GOAL), Kind.SHORT_OF_GOAL, 20.0),
    "never sets out": ((np.zeros(1), np.zeros((1, 2))), Kind.SHORT_OF_GOAL, 0.0),
    "arrives too late": (walk(duration_s=200.0), Kind.TIME_LIMIT, 120.0),
    "leaps over the time limit": (walk(duration_s=200.0, count=2), Kind.TIME_LIMIT, 120.0),
}


@pytest.mark.parametrize(("trajectory", "kind", "time_s"), LIES.values(), ids=LIES.keys())
def test_lies_fail_every_verdict(trajectory, kind, time_s):
    judged = audit(scenario(FAST), *trajectory)
    assert kinds(judged) == (kind,) * 3
    assert times_of(judged) == (time_s,) * 3
    assert not (judged.per_step.success)
    assert not (judged.swept.success)
    assert not (judged.executable.success)
    assert np.isnan(judged.arrival_time_s)
    assert judged.end_time_s == time_s


def test_a_collision_before_a_lie_comes_first():
    blocking = sphere((0.0, (0.3, 0.0, 0.1)), (2.0, (0.0, 0.0, 0.1)))
    judged = audit(scenario(FAST, (blocking,)), *with_row(*walk(), 5, time_s=np.nan))
    assert judged.per_step[1:] == (2.0, Kind.COLLISION)


def test_what_happens_after_arrival_does_not_count():
    times, states = walk()
    times, states = np.append(times, [20.5, 7.0]), np.vstack([states, [[3.0, 0.0], [np.nan, 9.0]]])
    late = sphere((19.5, (0.5, 0.0, 0.1)), (20.2, (0.0, 0.0, 0.1)))
    assert audit(scenario(obstacles=(late,)), times, states).executable.success


def test_a_collision_after_the_time_limit_does_not_count():
    late = sphere((130.0, (0.5, 0.0, 0.1)), (140.0, (0.0, 0.0, 0.1)))
    judged = audit(scenario(FAST, (late,)), *walk(duration_s=200.0, count=2))
    assert kinds(judged) == (Kind.TIME_LIMIT,) * 3


def test_a_state_repeated_without_change_is_no_lie():
    times, states = walk()
    assert audit(scenario(), np.insert(times, 5, times[5]), np.insert(states, 5, states[5], axis=0)).executable.success


def test_arriving_at_once():
    judged = audit(scenario().model_copy(update={"goal_m": (0.0, 0.0, 0.15)}), [0.0], np.zeros((1, 2)))
    assert judged.executable.success
    assert judged.arrival_time_s == 0.0
