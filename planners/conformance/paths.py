"""Checks of a path by itself: is it one, is it where it says it is, and is it free."""

from collections.abc import Iterator

import numpy as np

from planners.conformance.scenes import RESTING, FirstPlan, first_plans, problem_of, scenes
from planners.problem import write_state
from planners.spec import PlannerSpec, load

STATUSES = {
    "Exact solution",
    "Approximate solution",
    "Timeout",
    "Infeasible",
    "Invalid start",
    "Invalid goal",
}
"""What a solve may end with."""


def check_finds_paths(planner: PlannerSpec) -> None:
    """In three scenes of five at least, it finds a path, be it one that ends short of the goal."""
    found = [first.scene for first in first_plans(planner) if not first.limits and len(first.plan.times_s) > 1]
    if len(found) < 3:
        raise AssertionError(f"found a path in {len(found)} of {len(scenes())} scenes, allowed 3 and more")


def check_path_is_of_finite_states(planner: PlannerSpec) -> None:
    """A path has two states or more, a configuration to each time, and all numbers are finite."""
    for first in first_plans(planner):
        times, path, dof = first.plan.times_s, first.plan.configurations_rad, scenes()[first.scene].arm.dof
        if path.shape != (len(times), dof) or len(times) == 1:
            raise AssertionError(f"{first.where}: found shape {path.shape}, allowed (k, {dof}) with k from 2 on")
        if not (np.isfinite(times).all() and np.isfinite(path).all()):
            raise AssertionError(f"{first.where}: found a number that is not finite, allowed finite states")


def check_path_starts_where_the_arm_is(planner: PlannerSpec) -> None:
    """A path's first state is the arm's present configuration, now."""
    for first in _with_path(planner):
        times, path, start = first.plan.times_s, first.plan.configurations_rad, scenes()[first.scene].start
        if times[0] != 0.0:
            raise AssertionError(f"{first.where}: found a path from {times[0]:g} s on, allowed from now on, 0 s")
        if not np.array_equal(path[0], start):
            off = np.abs(path[0] - start).max()
            raise AssertionError(f"{first.where}: found a start {off:.3g} rad off, allowed the arm's configuration")


def check_path_goes_forward_in_time(planner: PlannerSpec) -> None:
    """Every state of a path is later than the one before."""
    for first in _with_path(planner):
        steps = np.diff(first.plan.times_s)
        if not (steps > 0).all():
            raise AssertionError(f"{first.where}: found a step of {steps.min():g} s, allowed steps forward in time")


def check_path_ends_where_it_claims(planner: PlannerSpec) -> None:
    """A path whose tip ends within the goal tolerance is called exact, any other approximate, and none neither."""
    for first in first_plans(planner):
        status, path, scenario = first.plan.status, first.plan.configurations_rad, scenes()[first.scene]
        if status not in STATUSES:
            raise AssertionError(f"{first.where}: found status {status!r}, allowed {', '.join(sorted(STATUSES))}")
        if len(path):
            away = np.linalg.norm(scenario.arm.tip(path[-1]) - scenario.goal)
            claim = "Exact solution" if away <= scenario.goal_tolerance_m else "Approximate solution"
            if status != claim:
                raise AssertionError(f"{first.where}: found {status!r} {away:.3g} m from the goal, allowed {claim!r}")
        elif status == "Exact solution":
            raise AssertionError(f"{first.where}: found {status!r} without a path, allowed any other status")


def check_states_are_valid(planner: PlannerSpec) -> None:
    """Every timed state of a path is free of the predicted obstacles (of a reactive planner: where they rest)."""
    for first in _owed_to_be_free(planner):
        problem = problem_of(planner, scenes()[first.scene], first.limits)
        state = problem.si.allocState()
        for q, time in zip(first.plan.configurations_rad, first.plan.times_s, strict=True):
            write_state(state, q, time)
            if not problem.si.isValid(state):
                gap = problem.checker.clearance(state)
                raise AssertionError(f"{first.where}: found clearance {gap:.3g} m at {time:g} s, allowed more than 0")


def check_motions_are_valid_where_limits_bind(planner: PlannerSpec) -> None:
    """With motion limits, the shared validator allows every motion between a path's states."""
    for first in _owed_to_be_free(planner):
        if first.limits:
            times, path = first.plan.times_s, first.plan.configurations_rad
            check = problem_of(planner, scenes()[first.scene], True).validator.check
            for k in range(len(times) - 1):
                if not check(path[k], times[k], path[k + 1], times[k + 1]):
                    motion = f"a motion from {times[k]:g} to {times[k + 1]:g} s"
                    raise AssertionError(f"{first.where}: found {motion} that collides or is too fast, allowed none")


def _with_path(planner: PlannerSpec) -> Iterator[FirstPlan]:
    return (first for first in first_plans(planner) if len(first.plan.times_s))


def _owed_to_be_free(planner: PlannerSpec) -> Iterator[FirstPlan]:
    """The plans that have to be free; a reactive planner looks at obstacles as they are now."""
    is_reactive = load(planner)[0].is_reactive
    return (first for first in first_plans(planner) if not is_reactive or first.scene in RESTING)
