"""Checks of what a planner does: solve after solve, seed after seed, and where there is nothing to be found."""

import math

import numpy as np
from pydantic import BaseModel

from planners.conformance.paths import STATUSES
from planners.conformance.scenes import (
    budget_settings,
    hopeless_scenes,
    observe,
    problem_of,
    scenes,
    session_of,
    solve,
)
from planners.session import Plan
from planners.spec import PlannerSpec, load, parse_planner
from scenarios.arm import FloatArray

QUESTIONS_AFTER = 3
"""Told that its budget is spent, a search may ask again on its way out."""


def check_goes_on_along_its_path(planner: PlannerSpec) -> None:
    """Asked again on the way, it plans from where the arm has come to, at that time."""
    scenario = scenes()["moving obstacles"]
    session, q, now = session_of(planner, scenario), scenario.start, 0.0
    for _ in range(4):
        plan = session.plan(q, now, observe(scenario, now))
        times = plan.times_s
        if len(times):
            if times[0] != now or not np.array_equal(plan.configurations_rad[0], q):
                raise AssertionError(
                    f"found a path from elsewhere at {times[0]:g} s, allowed from the arm's, {now:g} s"
                )
            if not (np.diff(times) > 0).all():
                raise AssertionError(f"asked at {now:g} s: found times that do not increase, allowed increasing ones")
            q = np.array([np.interp(now + 1.0, times, bends) for bends in plan.configurations_rad.T])
        now += 1.0


def check_equal_seeds_give_equal_plans(planner: PlannerSpec) -> None:
    """In one process too, whatever random numbers others have used meanwhile."""
    scenario = scenes()["moving obstacles near by"]

    def plans() -> list[Plan]:
        session = session_of(planner, scenario, seed=7)
        return [session.plan(scenario.start, now, observe(scenario, now)) for now in (0.0, 1.0)]

    first = plans()
    session_of(parse_planner("rrt"), scenario, seed=99).plan(scenario.start, 0.0, observe(scenario))
    for number, (one, other) in enumerate(zip(first, plans(), strict=True), 1):
        difference = difference_of(one, other)
        if difference:
            raise AssertionError(f"solve {number}: found {difference} of equal seeds, allowed equal plans")


def check_changes_nothing_it_was_given(planner: PlannerSpec) -> None:
    """Scenario, observation, configuration, query and settings stay as they are, and so do paths given away."""
    scenario = scenes()["moving obstacles near by"]
    before, settings = scenario.model_dump_json(), planner.settings.model_dump_json()
    for limits in (False, True):
        seen, q = observe(scenario), scenario.start
        kept = [array.copy() for array in seen]
        session = session_of(planner, scenario, limits)
        path = session.plan(q, 0.0, seen).configurations_rad
        given_away = path.copy()
        session.plan(q, 0.0, seen)
        _require_equal("a path given away", [path], [given_away])
        _require_equal("the arm's configuration", [q], [scenario.start])
        _require_equal("the observation", seen, kept)
        problem = problem_of(planner, scenario, limits)
        asked = [array.copy() for array in _arrays(problem.query)]
        solve(planner, problem, scenario, lambda: False)
        _require_equal("the query", _arrays(problem.query), asked)
    if scenario.model_dump_json() != before:
        raise AssertionError("found the scenario changed, allowed as it was given")
    if planner.settings.model_dump_json() != settings:
        raise AssertionError("found the settings changed, allowed as they were given")


def check_stops_when_its_budget_is_spent(planner: PlannerSpec) -> None:
    """Once ``stop()`` is true the search ends; when it is true from the first, there is no path."""
    scenario = scenes()["moving obstacles"]
    for allowed in (0, 1, 7):
        questions = 0

        def spent(allowed: int = allowed) -> bool:
            nonlocal questions
            questions += 1
            return questions > allowed

        reached = solve(planner, problem_of(planner, scenario, False), scenario, spent)
        if questions > allowed + QUESTIONS_AFTER:
            raise AssertionError(
                f"found {questions} questions, allowed {QUESTIONS_AFTER} after {allowed}, when all is spent"
            )
        if allowed == 0 and reached:
            raise AssertionError("found a path to the goal without a budget, allowed none")


def check_small_budget_is_little_work(planner: PlannerSpec) -> None:
    """With a budget of two, a search that finds nothing makes less than half of its checks."""
    # Out of reach: a search goes on until its budget ends.
    scenario = scenes()["moving obstacles"].model_copy(update={"goal_m": (0.0, 0.0, 0.46)})

    def work(settings: BaseModel) -> int:
        plan = session_of(planner._replace(settings=settings), scenario).plan(scenario.start, 0.0, observe(scenario))
        return plan.state_checks + plan.motion_checks

    kind, settings = load(planner)
    for name in budget_settings(planner):
        budget = max(2, _least(kind.settings_model, name))
        small = kind.settings_model.model_validate(settings.model_dump() | {name: budget})
        little, much = work(small), work(settings)
        if little > 0.5 * much + 100:
            raise AssertionError(f"{name}={budget}: found {little} checks, allowed half of {much} and 100 more")


def check_no_path_is_a_status(planner: PlannerSpec) -> None:
    """Where there is no way to the goal, a solve ends, raises nothing and does not claim to have reached it."""
    for name, scenario in hopeless_scenes().items():
        for limits in (False, True):
            session = session_of(planner, scenario, limits)
            for now in (0.0, 1.0):
                plan = session.plan(scenario.start, now, observe(scenario, now))
                if plan.status not in STATUSES - {"Exact solution"}:
                    raise AssertionError(f"{name}: found status {plan.status!r}, allowed any that is no solution")
                if plan.configurations_rad.shape != (len(plan.times_s), scenario.arm.dof):
                    raise AssertionError(f"{name}: found shape {plan.configurations_rad.shape}, allowed a path's")


def check_plans_again_after_a_hopeless_solve(planner: PlannerSpec) -> None:
    """When the obstacles turn out to be far away, what it could not find before is forgotten."""
    scenario = hopeless_scenes()["inside an obstacle"]
    session = session_of(planner, scenario)
    session.plan(scenario.start, 0.0, observe(scenario))
    far = observe(scenario, 1.0)
    far.positions_m[:] = 50.0
    again = len(session.plan(scenario.start, 1.0, far).times_s) > 0
    anew = len(session_of(planner, scenario).plan(scenario.start, 1.0, far).times_s) > 0
    if again != anew:
        words = {True: "a path", False: "no path"}
        raise AssertionError(f"found {words[again]} after a hopeless solve, allowed {words[anew]} as without one")


def difference_of(one: Plan, other: Plan) -> str:
    """How two plans differ, but for the time they took; empty if they do not."""
    if one.status != other.status:
        return f"{one.status!r} and {other.status!r}"
    if not np.array_equal(one.times_s, other.times_s):
        return f"other times ({len(one.times_s)} and {len(other.times_s)} states)"
    if not np.array_equal(one.configurations_rad, other.configurations_rad):
        return f"configurations {np.abs(one.configurations_rad - other.configurations_rad).max():.3g} rad apart"
    counts = [(plan.state_checks, plan.motion_checks) for plan in (one, other)]
    return f"{counts[0]} and {counts[1]} checks of states and motions" if counts[0] != counts[1] else ""


def _least(model: type[BaseModel], name: str) -> int:
    """The smallest whole number that a setting's lower limits allow; 0 without any."""
    limits = model.model_fields[name].metadata
    at_least = [math.ceil(limit.ge) for limit in limits if hasattr(limit, "ge")]
    above = [math.floor(limit.gt) + 1 for limit in limits if hasattr(limit, "gt")]
    return int(max([0, *at_least, *above]))


def _arrays(query: object) -> list[FloatArray]:
    """Every array of a query, those of its prediction and world too."""
    if isinstance(query, np.ndarray):
        return [query]
    return [array for part in query for array in _arrays(part)] if isinstance(query, tuple) else []


def _require_equal(what: str, after: "tuple[FloatArray, ...] | list[FloatArray]", before: list[FloatArray]) -> None:
    for now, then in zip(after, before, strict=True):
        if not np.array_equal(now, then):
            raise AssertionError(f"found {what} changed, allowed as it was given")
