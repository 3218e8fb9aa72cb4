"""Holds NewPlanner to what every planner owes the suite; ``suite check-planner`` asks the same."""

from planners import PlannerSpec
from suite.conformance import Check, parametrize_with_checks
from suite.scaffold.new_planner import NewPlanner


@parametrize_with_checks([NewPlanner])  # expected_failed_checks={"check_...": "why"} for what it does not promise
def test_conformance(planner: PlannerSpec, check: Check) -> None:
    """Every check is a test of its own."""
    check(planner)
