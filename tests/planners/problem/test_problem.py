"""The OMPL problem: its checker and validator say what ``scenarios.collision`` says, and bind motions to the rates."""

import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from ompl import base as ob
from strategies import ARM, configurations, random_configurations, seeds

from planners.prediction import Prediction
from planners.problem import Query, SpaceTimeProblem, TimedPath, _kernels, read_state, write_path, write_state
from planners.problem.goals import GoalConfigurations
from planners.search.rates._kernels import fastest_tip
from scenarios import ContinuumArm, clearance, is_motion_valid, is_state_valid

HORIZON_S = 30.0


def prediction_of(rng: np.random.Generator, n_obstacles: int) -> Prediction:
    start = rng.uniform(-0.15, 0.15, size=(1, n_obstacles, 3)) + np.array([0.0, 0.0, 0.15])
    centers = start + np.cumsum(rng.uniform(-0.01, 0.01, size=(20, n_obstacles, 3)), axis=0)
    return Prediction(0.0, 1.0, centers, np.full(n_obstacles, 0.03), np.zeros((20, n_obstacles)))


def problem_of(prediction: Prediction, arm: ContinuumArm = ARM) -> SpaceTimeProblem:
    query = Query(arm, np.array([0.1, 0.0, 0.3]), 0.01, prediction, prediction.world(0.0), True)
    return SpaceTimeProblem(query, HORIZON_S)


def state_of(problem: SpaceTimeProblem, q: np.ndarray, time: float) -> ob.State:
    state = problem.si.allocState()
    write_state(state, q, time)
    return state


@pytest.fixture(scope="module")
def empty() -> SpaceTimeProblem:
    return problem_of(prediction_of(np.random.default_rng(0), 0))


@pytest.fixture(scope="module")
def crowded() -> SpaceTimeProblem:
    return problem_of(prediction_of(np.random.default_rng(1), 8))


@given(configurations(), st.floats(0, HORIZON_S))
def test_what_is_written_to_a_state_is_read(empty: SpaceTimeProblem, q: np.ndarray, time: float) -> None:
    back, when = read_state(state_of(empty, q, time), 6)
    np.testing.assert_array_equal(back, q)
    assert when == time


@given(st.lists(configurations(), min_size=1, max_size=5))
def test_a_path_is_written_state_by_state(empty: SpaceTimeProblem, path: list[np.ndarray]) -> None:
    timed = TimedPath(np.arange(len(path)) / 3, np.array(path))
    states = write_path(empty.si, timed).getStates()
    assert len(states) == len(path)
    for state, q, time in zip(states, path, timed.times_s, strict=True):
        back, when = read_state(state, 6)
        np.testing.assert_array_equal(back, q)
        assert when == time


@given(configurations(), st.floats(0, HORIZON_S))
def test_the_checker_is_the_shared_one(crowded: SpaceTimeProblem, q: np.ndarray, time: float) -> None:
    state, world = state_of(crowded, q, time), crowded.query.world
    assert crowded.si.isValid(state) is is_state_valid(ARM, q, time, world)
    assert crowded.checker.clearance(state) == clearance(ARM, q, time, world)


def test_both_answers_occur(crowded: SpaceTimeProblem) -> None:
    states = random_configurations(np.random.default_rng(2), 300)
    valid = sum(crowded.si.isValid(state_of(crowded, q, 3.0)) for q in states)
    assert 30 < valid < 270


def test_a_bend_past_the_limit_is_no_state_and_no_end_of_a_motion() -> None:
    for limit in (math.pi, 1.0):
        problem = problem_of(prediction_of(np.random.default_rng(0), 0), ContinuumArm(max_bend_rad=limit))
        inside, outside = np.zeros(6), np.zeros(6)
        inside[:2], outside[:2] = (limit, 0.0), (limit * 0.8, limit * 0.8)
        assert problem.si.isValid(state_of(problem, inside, 1.0))
        assert not problem.si.isValid(state_of(problem, outside, 1.0))
        assert problem.checker.clearance(state_of(problem, outside, 1.0)) == -math.inf
        start = state_of(problem, inside * 0.9, 0.0)
        assert problem.si.checkMotion(start, state_of(problem, inside, 29.0))
        assert not problem.si.checkMotion(start, state_of(problem, outside, 29.0))


@settings(max_examples=150)
@given(seeds, st.sampled_from([0.01, 0.1, 1.0]))
def test_the_validator_is_the_shared_one_for_motions_slow_enough(
    crowded: SpaceTimeProblem, seed: int, share: float
) -> None:
    rng = np.random.default_rng(seed)
    q0, q1 = random_configurations(rng, 2)
    q1 = q0 + share * (q1 - q0)
    needed = float(_kernels.least_durations(q0, q1[None], 0.15, 0.5, ARM.max_tip_speed_m_s)[0])
    t0 = rng.uniform(0, 10)
    t1 = t0 + needed * 1.001 + 1e-6
    proven = crowded.si.checkMotion(state_of(crowded, q0, t0), state_of(crowded, q1, t1))
    assert proven is is_motion_valid(ARM, q0, t0, q1, t1, crowded.query.world)


MOVES: dict[str, Callable[[], tuple[np.ndarray, np.ndarray, float]]] = {
    # The last section turns about the backbone: bending at 0.5 rad/s limits, its tip hardly moves.
    "as fast as bending allows": lambda: (
        np.array([0, 0, 0, 0, 0.01, 0]),
        np.array([0, 0, 0, 0, 0.01 * math.cos(1), 0.01 * math.sin(1)]),
        0.01 * 2 * math.sin(0.5) / 0.5,
    ),
    # The whole arm swings at the base: the tip's speed limits.
    "as fast as the tip allows": lambda: (np.zeros(6), np.array([0.02, 0, 0, 0, 0, 0]), 0.0075 / ARM.max_tip_speed_m_s),
}


@pytest.mark.parametrize("move", MOVES)
def test_rates_are_limits(empty: SpaceTimeProblem, move: str) -> None:
    q0, q1, needed = MOVES[move]()
    if "bending" in move:  # a tip that does not limit
        arm = ContinuumArm(max_tip_speed_m_s=10.0)
        empty = problem_of(prediction_of(np.random.default_rng(0), 0), arm)
    start = state_of(empty, q0, 1.0)
    assert empty.si.checkMotion(start, state_of(empty, q1, 1.0 + 1.001 * needed))
    assert not empty.si.checkMotion(start, state_of(empty, q1, 1.0 + 0.999 * needed))


@pytest.mark.parametrize("t1", [0.999, 1.0, -math.inf])
def test_time_goes_forward(empty: SpaceTimeProblem, t1: float) -> None:
    q = np.full(6, 0.1)
    assert not empty.si.checkMotion(state_of(empty, q, 1.0), state_of(empty, q, t1))
    assert not empty.validator.check(q, 1.0, q, t1)
    assert empty.si.checkMotion(state_of(empty, q, 1.0), state_of(empty, q, 1.001))


@settings(max_examples=60)
@given(seeds, st.integers(1, 4), st.sampled_from([0.02, 0.3, 1.0]))
def test_the_fastest_tip_is_hardly_underrated(seed: int, n: int, share: float) -> None:
    arm = ContinuumArm(n_sections=n)
    q0, q1 = random_configurations(np.random.default_rng(seed), 2, n)
    q1 = q0 + share * (q1 - q0)
    speeds = [np.linalg.norm(arm.jacobian(q0 + s * (q1 - q0)) @ (q1 - q0)) for s in np.linspace(0, 1, 400)]
    fastest = fastest_tip(q0, q1, arm.section_length_m, math.inf)
    assert fastest <= max(speeds) * (1 + 1e-4)
    assert fastest >= 0.97 * max(speeds)


def test_checks_are_counted(crowded: SpaceTimeProblem) -> None:
    q = np.zeros(6)
    state = state_of(crowded, q, 1.0)
    states, motions = crowded.checker.checks, crowded.validator.checks
    crowded.si.isValid(state)
    crowded.si.checkMotion(state, state)
    assert crowded.checker.checks == states + 1
    assert crowded.validator.checks == motions + 1


def test_an_update_is_seen_by_checker_and_validator() -> None:
    problem = problem_of(prediction_of(np.random.default_rng(0), 0))
    wall = Prediction(5.0, 1.0, np.zeros((2, 1, 3)), np.array([1.0]), np.zeros((2, 1)))
    q = np.zeros(6)
    state, later = state_of(problem, q, 5.0), state_of(problem, q, 6.0)
    assert problem.si.isValid(state)
    problem.update(problem.query._replace(prediction=wall, world=wall.world(0.0)), 5.0)
    assert not problem.si.isValid(state)
    assert not problem.si.checkMotion(state, later)
    time_space = problem.space.getSubspace(1)
    assert (time_space.getMinTimeBound(), time_space.getMaxTimeBound()) == (5.0, 5.0 + HORIZON_S)


def test_goals_are_at_the_goal_and_not_before_the_arm_can_be_there() -> None:
    problem = problem_of(prediction_of(np.random.default_rng(0), 0))
    q, now = np.full(6, 0.3), 4.0
    problem.update(problem.query, now)
    goals = GoalConfigurations(ARM, problem.query.goal_m, 0.01, 20, np.random.default_rng(0))
    goal = problem.definition(q, now, goals, np.random.default_rng(1)).getGoal()
    assert goal.couldSample()
    assert len(goals.configurations) > 5
    assert ARM.within_bends(goals.configurations).all()
    state, start = problem.si.allocState(), state_of(problem, q, now)
    for _ in range(100):
        goal.sampleGoal(state)
        there, arrival = read_state(state, 6)
        assert np.linalg.norm(ARM.tip(there) - problem.query.goal_m) <= 0.01
        assert goal.isSatisfied(state)
        assert arrival <= now + HORIZON_S
        assert problem.si.checkMotion(start, state)  # nothing in the way: only the rates can forbid it


def test_a_goal_out_of_reach_has_no_configurations() -> None:
    problem = problem_of(prediction_of(np.random.default_rng(0), 0))
    query = problem.query._replace(goal_m=np.array([0.0, 0.0, 2.0]))
    problem.update(query, 0.0)
    goals = GoalConfigurations(ARM, query.goal_m, 0.01, 20, np.random.default_rng(0))
    assert goals.configurations.shape == (0, 6)
    goal = problem.definition(np.zeros(6), 0.0, goals, np.random.default_rng(1)).getGoal()
    assert not goal.couldSample()
    assert goal.maxSampleCount() == 0
