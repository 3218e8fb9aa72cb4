"""What every planner owes the suite, as checks: plain functions that take a planner and raise ``AssertionError``.

Nothing is checked unless somebody asks: ``suite check-planner``, or a test made by
``suite.conformance.parametrize_with_checks``. Both add what only a whole trial can tell.
"""

from collections.abc import Callable

from planners.conformance import conduct, declaration, paths
from planners.conformance.scenes import budget_settings
from planners.spec import PlannerSpec

CONFORMANCE_VERSION = 1
"""Raised with every check that is added or that asks for more; the changelog then says which."""

Check = Callable[[PlannerSpec], None]
"""Its name says which it is, its docstring what is owed; its ``AssertionError`` what was found."""

CHECKS: tuple[Check, ...] = (
    declaration.check_class_attributes,
    declaration.check_settings,
    paths.check_finds_paths,
    paths.check_path_is_of_finite_states,
    paths.check_path_starts_where_the_arm_is,
    paths.check_path_goes_forward_in_time,
    paths.check_path_ends_where_it_claims,
    paths.check_states_are_valid,
    paths.check_motions_are_valid_where_limits_bind,
    conduct.check_goes_on_along_its_path,
    conduct.check_equal_seeds_give_equal_plans,
    conduct.check_changes_nothing_it_was_given,
    conduct.check_stops_when_its_budget_is_spent,
    conduct.check_small_budget_is_little_work,
    conduct.check_no_path_is_a_status,
    conduct.check_plans_again_after_a_hopeless_solve,
    declaration.check_plans_the_same_in_another_process,
)
"""All of them."""


def checks_for(planner: PlannerSpec) -> list[Check]:
    """The checks that concern ``planner``.

    Left out are a small budget where no setting is known to be one, and planning again when obstacles are found not to
    be where they were thought to be, which never happens to a planner that sees the truth.
    """
    left_out: set[Check] = set()
    if not budget_settings(planner):
        left_out.add(conduct.check_small_budget_is_little_work)
    if planner.is_bound:
        left_out.add(conduct.check_plans_again_after_a_hopeless_solve)
    return [check for check in CHECKS if check not in left_out]
