import numpy as np
import pytest
from ompl import base as ob

from planners import Observation, Session, parse_planner
from planners.problem import write_state
from planners.problem._kernels import motion_valid
from scenarios import Box, ContinuumArm, Line, Obstacle, Scenario
from scenarios.world import positions

ARM = ContinuumArm()
PLATE = Obstacle(  # large and flat: the spheres that hold it reach far beyond it
    shape=Box(size_m=(0.3, 0.3, 0.004)), motion=Line(point_m=(0, 0, 0.475), velocity_m_s=(0, 0, 0))
)
NEEDLE = Obstacle(shape=Box(size_m=(0.01, 0.01, 0.2)), motion=Line(point_m=(0.3, 0, 0.3), velocity_m_s=(-0.004, 0, 0)))
TIMES = np.arange(-5.0, 1.0)


def scenario(*obstacles, start=(0,) * 6):
    return Scenario(id="shapes", start_rad=start, goal_m=(0.105, 0.005, 0.405), obstacles=obstacles)


def observed(problem):
    radii = np.array([obstacle.radius_m for obstacle in problem.obstacles])
    return Observation(TIMES, positions(problem.obstacles, TIMES), radii)


def session(problem, spec="rrt"):
    return Session(parse_planner(spec), problem, predictor="truth", limits=True, seed=1)


def test_checker_and_validator_decide_by_shapes_where_the_spheres_are_hit():
    problem = scenario(PLATE)
    here = session(problem)
    still = np.zeros((2, 6))
    bent = np.vstack([still[0], np.full(6, 0.005)])
    assert here.still_valid(np.array([0.0, 1.0]), still, observed(problem)) is False  # it does not lead to the goal
    query, validator, checker = here._problem.query, here._problem.validator, here._problem.checker
    assert query.shapes is not None
    state = here._problem.si.allocState()
    write_state(state, np.zeros(6), 0.0)
    assert checker.isValid(state)
    assert 0.0 < checker.clearance(state) <= 0.475 - 0.002 - 0.45 - ARM.radius_m + 1e-9
    assert not motion_valid(still[0], 0.0, still[1], 1.0, *validator._limits(), query.world)  # by the spheres alone
    assert validator.check(still[0], 0.0, still[1], 1.0)
    assert validator.check(bent[0], 0.0, bent[1], 1.0)
    assert not validator.check(bent[1], 1.0, bent[0], 0.0)
    assert not validator.check(still[0], 0.0, np.full(6, 0.5), 1.0)  # too fast, whatever the shapes say


def test_spheres_alone_need_no_shapes():
    problem = scenario(Obstacle(radius_m=0.02, motion=NEEDLE.motion))
    here = session(problem)
    here.plan(problem.start, 0.0, observed(problem))
    assert here._problem.query.shapes is None


@pytest.mark.parametrize("spec", ["temporal", "h", "hs", "rrt", "pf"])
def test_planners_live_with_shapes(spec):
    problem = scenario(PLATE, NEEDLE, start=(0.3, 0, 0.3, 0, 0.3, 0))
    plan = session(problem, spec).plan(problem.start, 0.0, observed(problem))
    assert plan.status in {"Exact solution", "Approximate solution", "Timeout", "Infeasible"}
    if spec == "rrt":
        assert plan.status == ob.PlannerStatus(ob.PlannerStatus.EXACT_SOLUTION).asString()
