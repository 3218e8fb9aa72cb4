"""What OMPL's planners are lent in a space with time: direction, an objective, a projection."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from ompl import base as ob

from planners.prediction import Prediction
from planners.problem import Query, SpaceTimeProblem, read_state, write_state
from planners.sampling.by_name.direction import DirectedSampler, DirectedValidator, Part
from planners.sampling.by_name.duration import Duration
from planners.sampling.by_name.projection import TipProjection
from scenarios import ContinuumArm

ARM = ContinuumArm()
NOTHING = Prediction(0.0, 1.0, np.empty((2, 0, 3)), np.empty(0), np.empty((2, 0)))
PROBLEM = SpaceTimeProblem(Query(ARM, np.array([0.1, 0.1, 0.3]), 0.01, NOTHING, NOTHING.world(0.0, 1.0), True), 90.0)
GOAL = np.full(ARM.dof, 0.4)
seeds = st.integers(0, 2**32 - 1)


def state(q: np.ndarray, time_s: float) -> ob.State:
    made = PROBLEM.si.allocState()
    write_state(made, q, time_s)
    return made


def part(two_trees: bool, seed: int = 0) -> Part:
    low, high = np.full(ARM.dof, -0.5), np.full(ARM.dof, 0.9)
    return Part(ARM, two_trees, np.random.default_rng(seed), low, high, 0.0, 60.0, GOAL.tolist())


@settings(max_examples=100)
@given(seeds, st.booleans(), st.sampled_from([0.05, 0.5, 1000.0]))
def test_what_is_drawn_near_a_state_can_be_reached_from_it_or_reaches_it(seed: int, of_goal: bool, far: float) -> None:
    where = part(two_trees=True, seed=seed)
    rng = np.random.default_rng(seed)
    q = GOAL if of_goal else rng.uniform(-0.4, 0.4, ARM.dof)
    near, drawn = state(q, 30.0), state(q, 30.0)
    sampler = DirectedSampler(PROBLEM.si, PROBLEM.checker, where)
    for _ in range(20):
        if sampler.sampleNear(drawn, near, far):
            other, time_s = read_state(drawn, ARM.dof)
            assert (np.abs(other - q) <= far + 1e-12).all()
            assert (where.low <= other).all()
            assert (other <= where.high).all()
            assert where.from_s <= time_s <= where.until_s
            motion = (other, time_s, q, 30.0) if of_goal else (q, 30.0, other, time_s)
            assert PROBLEM.validator.check(*motion)
            break
    else:
        pytest.fail("nothing drawn")


def test_motions_of_the_goals_tree_are_turned_round_and_no_others() -> None:
    validator, where = DirectedValidator(PROBLEM.si, PROBLEM.validator), part(two_trees=True)
    validator.part = where
    root, before, earlier = state(GOAL, 50.0), state(GOAL + 0.1, 30.0), state(GOAL + 0.2, 10.0)
    start, later = state(np.zeros(ARM.dof), 0.0), state(np.full(ARM.dof, 0.1), 20.0)
    assert validator.checkMotion(start, later)
    assert not validator.checkMotion(later, start)
    assert not validator.checkMotion(before, root) or not where.is_of_goal(before)  # not of the goal's tree yet
    assert validator.checkMotion(root, before)
    assert where.is_of_goal(before)
    assert validator.checkMotion(before, earlier)  # and so down the tree
    assert where.is_of_goal(earlier)
    assert not validator.checkMotion(earlier, root)  # outward from the goal's tree, so forward in time is against it
    assert not where.is_of_goal(later)


def test_a_single_tree_knows_no_goals_tree() -> None:
    validator, where = DirectedValidator(PROBLEM.si, PROBLEM.validator), part(two_trees=False)
    validator.part = where
    assert not validator.checkMotion(state(GOAL, 50.0), state(GOAL + 0.1, 30.0))
    assert validator.checkMotion(state(GOAL, 30.0), state(GOAL + 0.1, 50.0))


@given(seeds)
def test_the_objective_has_a_direction_and_adds_up(seed: int) -> None:
    rng = np.random.default_rng(seed)
    a, b, c = (rng.uniform(-1, 1, ARM.dof) for _ in range(3))
    objective = Duration(PROBLEM)
    one, two, three = state(a, 0.0), state(b, 40.0), state(c, 80.0)
    cost = objective.motionCost(one, two).value()
    rate = ARM.max_bend_rate_rad_s * math.sqrt(ARM.n_sections)
    assert cost == pytest.approx(40.0 + np.linalg.norm(b - a) / rate)
    assert objective.motionCost(two, one).value() == math.inf
    assert objective.motionCost(one, state(b, 1e-3)).value() == math.inf
    around = objective.motionCost(one, two).value() + objective.motionCost(two, three).value()
    assert objective.motionCost(one, three).value() <= around + 1e-9  # so the straight motion bounds every way
    assert not objective.isSymmetric()


@given(seeds, st.sampled_from([0.05, 0.3]))
def test_the_projection_is_the_cell_of_the_tip(seed: int, cell_m: float) -> None:
    projection = TipProjection(PROBLEM, cell_m)
    q = np.random.default_rng(seed).uniform(-1, 1, ARM.dof)
    place, cell = np.zeros(3), np.zeros(3, np.int32)
    projection.project(state(q, 7.0), place)
    np.testing.assert_allclose(place, ARM.tip(q), atol=1e-12)
    projection.computeCoordinates(state(q, 7.0), cell)
    np.testing.assert_array_equal(cell, np.floor(ARM.tip(q) / cell_m))
    assert projection.getDimension() == 3
    assert [projection.getCellSizes(k) for k in range(3)] == [cell_m] * 3
