"""What the arm does with a path: every state it passes is kept, and it is where the path says at every second."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenarios import ContinuumArm, Scenario
from suite.trial.execution import SAME_START_RAD, Execution, PathError, check_path

ARM = ContinuumArm(n_sections=1)
FAR_M = (5.0, 5.0, 5.0)


def scene(goal_m=FAR_M, start_rad=(0.0, 0.0), tolerance_m=0.01) -> Scenario:
    return Scenario(id="scene", arm=ARM, start_rad=start_rad, goal_m=tuple(goal_m), goal_tolerance_m=tolerance_m)


def path_of(*states: tuple[float, float]) -> tuple[np.ndarray, np.ndarray]:
    """Times and configurations of (time, u)."""
    return np.array([t for t, _ in states]), np.array([[u, 0.0] for _, u in states])


def executed(path, seconds: int, scenario: Scenario | None = None) -> Execution:
    execution = Execution(scenario or scene())
    execution.take(*path)
    for _ in range(seconds):
        execution.step()
    return execution


def us(execution: Execution) -> list[float]:
    return execution.configurations_rad[:, 0].tolist()


def test_without_a_path_it_holds_still_second_by_second() -> None:
    execution = executed((np.empty(0), np.empty((0, 2))), 3)
    assert execution.times_s.tolist() == [0.0, 1.0, 2.0, 3.0]
    assert us(execution) == [0.0] * 4
    assert execution.rest is None
    assert execution.now_s == 3.0


def test_a_step_keeps_the_states_it_passes_and_ends_between_two_at_the_whole_second() -> None:
    execution = executed(path_of((0.0, 0.0), (0.4, 0.2), (1.6, 0.8), (2.0, 0.6)), 1)
    assert execution.times_s.tolist() == [0.0, 0.4, 1.0]
    assert us(execution) == pytest.approx([0.0, 0.2, 0.5])  # half way from 0.2 to 0.8
    assert execution.q.tolist() == pytest.approx([0.5, 0.0])
    times, rest = execution.rest
    assert times.tolist() == [1.0, 1.6, 2.0]
    assert rest[:, 0].tolist() == pytest.approx([0.5, 0.8, 0.6])
    execution.step()
    assert execution.times_s.tolist() == [0.0, 0.4, 1.0, 1.6, 2.0]
    assert us(execution)[-2:] == [0.8, 0.6]
    assert execution.rest is None


def test_a_state_at_the_whole_second_is_there_once() -> None:
    execution = executed(path_of((0.0, 0.0), (1.0, 0.2), (2.0, 0.4)), 2)
    assert execution.times_s.tolist() == [0.0, 1.0, 2.0]


def test_past_the_end_of_its_path_it_holds_still_where_that_ended() -> None:
    execution = executed(path_of((0.0, 0.0), (0.5, 0.3)), 3)
    assert execution.times_s.tolist() == [0.0, 0.5, 1.0, 2.0, 3.0]
    assert us(execution) == [0.0, 0.3, 0.3, 0.3, 0.3]


def test_a_new_path_takes_the_place_of_the_old_one_and_none_means_holding_still() -> None:
    execution = executed(path_of((0.0, 0.0), (4.0, 0.8)), 2)
    execution.take(np.array([2.0, 3.0]), np.array([[0.4, 0.0], [0.4, 0.5]]))
    execution.step()
    assert execution.q.tolist() == [0.4, 0.5]
    assert execution.rest is None
    execution.take(*path_of((3.0, 0.4), (9.0, 1.0)))
    execution.take(np.empty(0), np.empty((0, 2)))
    execution.step()
    assert execution.q.tolist() == [0.4, 0.5]


@given(
    st.lists(st.tuples(st.floats(0.01, 1.7), st.floats(-1.5, 1.5), st.floats(-1.5, 1.5)), min_size=1, max_size=8),
    st.integers(1, 12),
)
def test_at_every_whole_second_it_is_where_linear_interpolation_says(steps, seconds: int) -> None:
    times = np.concatenate([[0.0], np.cumsum([duration for duration, _, _ in steps])])
    states = np.array([[0.0, 0.0], *([u, v] for _, u, v in steps)])
    execution = executed((times, states), seconds)
    whole = np.arange(seconds + 1.0)
    expected = sorted(set(times[times <= seconds]) | set(whole))
    assert execution.times_s.tolist() == expected
    for column in range(2):
        where = np.interp(expected, times, states[:, column])  # np.interp rests past the last state, as the arm does
        np.testing.assert_allclose(execution.configurations_rad[:, column], where, atol=1e-9)
    np.testing.assert_array_equal(execution.configurations_rad[0], [0.0, 0.0])


GOAL_U = 0.9


def test_it_stops_at_the_first_timed_state_within_the_tolerance() -> None:
    goal = ARM.tip([GOAL_U, 0.0])
    execution = executed(path_of((0.0, 0.0), (0.5, GOAL_U), (1.0, 1.5), (2.0, GOAL_U)), 1, scene(goal))
    assert execution.has_arrived
    assert execution.times_s.tolist() == [0.0, 0.5]
    assert execution.now_s == 0.5


def test_passing_the_goal_between_two_timed_states_is_no_arrival() -> None:
    execution = executed(path_of((0.0, 0.0), (0.9, 2 * GOAL_U), (2.0, 2 * GOAL_U)), 2, scene(ARM.tip([GOAL_U, 0.0])))
    assert not execution.has_arrived


def test_the_state_at_a_whole_second_counts_as_timed() -> None:
    goal = ARM.tip([GOAL_U, 0.0])
    execution = executed(path_of((0.0, 0.0), (2.0, 2 * GOAL_U)), 1, scene(goal))
    assert execution.has_arrived
    assert execution.now_s == 1.0


@pytest.mark.parametrize(("share", "arrives"), [(0.0, True), (0.99, True), (1.01, False), (1.9, False), (2.1, False)])
def test_the_tolerance_is_the_scenarios(share: float, arrives: bool) -> None:
    tolerance_m = 0.02
    goal = ARM.tip([GOAL_U, 0.0]) + np.array([0.0, share * tolerance_m, 0.0])
    execution = executed(path_of((0.0, 0.0), (1.0, GOAL_U)), 1, scene(goal, tolerance_m=tolerance_m))
    assert execution.has_arrived is arrives


def test_an_arm_that_starts_at_the_goal_has_arrived() -> None:
    assert Execution(scene(ARM.tip([0.0, 0.0]))).has_arrived
    assert not Execution(scene()).has_arrived


@pytest.mark.parametrize(("seconds", "still"), [(3, False), (12, False), (13, True), (20, True)])
def test_it_has_held_still_when_nothing_moved_for_so_long(seconds: int, still: bool) -> None:
    """It moves until t = 3 s."""
    execution = executed(path_of((0.0, 0.0), (3.0, 0.6)), seconds)
    assert execution.held_still_for(10.0) is still


def test_a_path_may_be_any_way_forward_from_where_the_arm_is() -> None:
    times, states = path_of((4.0, 0.5), (4.2, 3.0), (9.0, -3.0))
    check_path(times, states, 4.0, np.array([0.5, 0.9 * SAME_START_RAD]), 2)


NOW = path_of((4.0, 0.5), (5.0, 0.7))
BAD_PATHS = {
    "another arm": (NOW[0], np.zeros((2, 4)), "shape"),
    "more times than states": (np.array([4.0, 5.0, 6.0]), NOW[1], "shape"),
    "a time that is no number": (np.array([4.0, math.nan]), NOW[1], "not finite"),
    "a state without end": (NOW[0], np.array([[0.5, 0.0], [math.inf, 0.0]]), "not finite"),
    "begun earlier": (NOW[0] - 1.0, NOW[1], "increase strictly from now"),
    "begun later": (NOW[0] + 1e-9, NOW[1], "increase strictly from now"),
    "time that stands still": (np.array([4.0, 4.0]), NOW[1], "increase strictly from now"),
    "time that runs backward": (np.array([4.0, 6.0, 5.0]), np.full((3, 2), [0.5, 0.0]), "increase strictly from now"),
    "begun elsewhere": (NOW[0], NOW[1] + [[0.0, 3 * SAME_START_RAD], [0.0, 0.0]], "present configuration"),
}


@pytest.mark.parametrize("case", BAD_PATHS)
def test_what_is_no_path_from_here_is_refused(case: str) -> None:
    times, states, message = BAD_PATHS[case]
    with pytest.raises(PathError, match=message):
        check_path(times, states, 4.0, np.array([0.5, 0.0]), 2)
