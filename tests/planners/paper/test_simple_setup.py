"""The house's planners are OMPL planners: OMPL's own ``SimpleSetup`` drives them, without the suite's session."""

import numpy as np
import pytest
from ompl import geometric as og

from planners import build_predictor, parse_planner
from planners.conformance.scenes import observe, scenes
from planners.problem import Query, SpaceTimeProblem, read_state, write_state
from planners.problem.goals import GoalConfigurations
from planners.spec import load


@pytest.mark.parametrize("name", ["temporal", "temporal-best", "h", "pf", "rrt", "temporal-ct"])
def test_simple_setup_solves_with_it(name: str) -> None:
    scenario, (planner_class, settings) = scenes()["moving obstacles"], load(parse_planner(name))
    horizon_s = planner_class.look_ahead_s(settings)
    predictor = build_predictor(planner_class.predictor, scenario)
    prediction = predictor.predict(observe(scenario), horizon_s, planner_class.prediction_step_s)
    query = Query(
        scenario.arm, scenario.goal, scenario.goal_tolerance_m, prediction, prediction.world(0.0), limits=False
    )
    problem = SpaceTimeProblem(query, horizon_s)
    rng = np.random.default_rng(1)
    goals = GoalConfigurations(scenario.arm, scenario.goal, scenario.goal_tolerance_m, 8, rng)
    setup = og.SimpleSetup(problem.si)
    start = problem.si.allocState()
    write_state(start, scenario.start, 0.0)
    setup.setStartState(start)
    setup.setGoal(problem.definition(scenario.start, 0.0, goals, rng).getGoal())
    setup.setPlanner(planner_class(problem, settings))
    assert setup.solve(5.0)
    path = setup.getSolutionPath()
    states = [read_state(state, scenario.arm.dof) for state in path.getStates()]
    np.testing.assert_array_equal(states[0][0], scenario.start)
    times = [time for _, time in states]
    assert (np.diff(times) > 0).all()
    assert setup.haveSolutionPath()
