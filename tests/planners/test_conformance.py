"""What every planner of the registry owes the suite, and what the suite's session owes them."""

import pytest

from planners import PLANNERS, PlannerSpec, Session, ompl_planners, parse_planner
from planners.conformance import Check
from planners.conformance.scenes import observe, scenes, session_of
from suite.conformance import parametrize_with_checks

FAILED = {
    "pf": {"check_reaches_every_goal_among_no_obstacles": "a bend limit in the way holds a potential field for good"}
}
QUICK = {"clairvoyant": "clairvoyant[restarts=1,branches=300]"}
"""It tries hard before it gives up."""
GUESTS = [*ompl_planners()][::4]
"""They are driven by the same code; all of them run in CI's comparison, and ``suite check-planner`` checks any."""


@parametrize_with_checks([*PLANNERS, *GUESTS], expected_failed_checks=lambda planner: FAILED.get(planner.label, {}))
def test_conformance(planner: PlannerSpec, check: Check) -> None:
    gives_up = check.__name__ == "check_no_path_is_a_status"
    check(parse_planner(QUICK[planner.label]) if gives_up and planner.label in QUICK else planner)


def test_a_path_that_leads_to_the_goal_is_valid_until_the_prediction_says_otherwise() -> None:
    scenario = scenes()["moving obstacles"]
    session, seen = session_of(parse_planner("temporal-ct"), scenario), observe(scenario)
    plan = session.plan(scenario.start, 0.0, seen)
    assert plan.status == "Exact solution"
    assert session.still_valid(plan.times_s, plan.configurations_rad, seen)
    assert not session.still_valid(plan.times_s[:2], plan.configurations_rad[:2], seen)  # short of the goal
    assert not session.still_valid(plan.times_s, plan.configurations_rad[::-1], seen)
    in_the_way = seen._replace(positions_m=seen.positions_m.copy())
    in_the_way.positions_m[:, 0] = scenario.arm.tip(plan.configurations_rad[-1])
    assert not session.still_valid(plan.times_s, plan.configurations_rad, in_the_way)


def test_other_seeds_give_other_random_trees() -> None:
    scenario = scenes()["moving obstacles"]
    one, two = (
        session_of(parse_planner("rrt"), scenario, seed=k).plan(scenario.start, 0.0, observe(scenario)) for k in (1, 2)
    )
    assert one.times_s.tolist() != two.times_s.tolist()


def test_a_session_needs_a_known_predictor() -> None:
    with pytest.raises(ValueError, match="crystal ball"):
        Session(parse_planner("rrt"), scenes()["moving obstacles"], predictor="crystal ball", limits=False, seed=1)
