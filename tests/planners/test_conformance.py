"""What every planner of the registry owes the suite; a planner that is added is held to it from its first day."""

import functools
from collections.abc import Callable

import numpy as np
import pytest
from ompl import base as ob

from planners import PLANNERS, Observation, Plan, Session, build_predictor, ompl_planners, parse_planner
from planners.problem import Query, SpaceTimeProblem
from planners.problem.goals import GoalConfigurations
from scenarios import ContinuumArm, Obstacle, Scenario, Track, generate

CLASSES = {**PLANNERS, **ompl_planners()}
NAMES = list(CLASSES)
REACTIVE = {"h", "hs", "pf"}
"""These look at obstacles as they are now, so only among resting ones do they owe a valid path."""
STATUSES = {
    "Exact solution",
    "Approximate solution",
    "Timeout",
    "Infeasible",
    "Invalid start",
    "Invalid goal",
}


def at_rest(scenario: Scenario) -> Scenario:
    """The same with every obstacle where it is at t = 0."""
    now = [tuple(o.position(np.zeros(1))[0].tolist()) for o in scenario.obstacles]
    resting = [
        Obstacle(radius_m=o.radius_m, motion=Track(times_s=(0.0,), positions_m=(point,)))
        for o, point in zip(scenario.obstacles, now, strict=True)
    ]
    return scenario.model_copy(update={"id": scenario.id + "-rest", "obstacles": tuple(resting)})


MOVING = generate("orbit", 3, 3, 11)
CASES = {
    "nothing in the way": generate("orbit", 0, 1, 11)[0],
    "moving obstacles": MOVING[0],
    "moving obstacles near by": MOVING[2],
    "resting obstacles": at_rest(MOVING[2]),
    "two sections": generate("orbit", 2, 1, 12, ContinuumArm(n_sections=2, section_length_m=0.2))[0],
}
RESTING = {"nothing in the way", "resting obstacles"}


def observe(scenario: Scenario, now_s: float = 0.0) -> Observation:
    times = np.arange(-scenario.observation_s, now_s + 0.5)
    positions = np.empty((len(times), len(scenario.obstacles), 3))
    for j, obstacle in enumerate(scenario.obstacles):
        positions[:, j] = obstacle.position(times)
    return Observation(times, positions, np.array([o.radius_m for o in scenario.obstacles]))


def session_of(name: str, scenario: Scenario, limits: bool = False, seed: int = 1) -> Session:
    return Session(parse_planner(name), scenario, predictor="cubic", limits=limits, seed=seed)


def problem_of(name: str, scenario: Scenario, now_s: float, limits: bool) -> SpaceTimeProblem:
    """The problem as the planner is given it, built anew from the registry."""
    entry, settings = CLASSES[name], parse_planner(name).settings
    predictor = build_predictor(entry.predictor_for("cubic"), scenario)
    prediction = predictor.predict(observe(scenario, now_s), entry.look_ahead_s(settings), entry.prediction_step_s)
    world = prediction.world(entry.prediction_margin, entry.largest_bound_m)
    query = Query(scenario.arm, scenario.goal, scenario.goal_tolerance_m, prediction, world, limits)
    problem = SpaceTimeProblem(query, entry.look_ahead_s(settings))
    problem.update(query, now_s)
    return problem


@functools.cache
def first_plan(name: str, case: str, limits: bool) -> Plan:
    scenario = CASES[case]
    return session_of(name, scenario, limits).plan(scenario.start, 0.0, observe(scenario))


every_case = pytest.mark.parametrize("case", CASES)
every_planner = pytest.mark.parametrize("name", NAMES)
every_case_it_must_master = pytest.mark.parametrize(
    ("name", "case"), [(name, case) for name in NAMES for case in CASES if name not in REACTIVE or case in RESTING]
)
with_and_without_limits = pytest.mark.parametrize("limits", [False, True], ids=["free", "limits"])


@every_planner
def test_it_finds_paths_at_all(name: str) -> None:
    assert sum(len(first_plan(name, case, False).times_s) > 1 for case in CASES) >= 3


@every_planner
@every_case
@with_and_without_limits
def test_a_path_starts_at_the_start_and_goes_forward_in_time(name: str, case: str, limits: bool) -> None:
    plan, scenario = first_plan(name, case, limits), CASES[case]
    assert plan.configurations_rad.shape == (len(plan.times_s), scenario.arm.dof)
    if len(plan.times_s):
        assert len(plan.times_s) > 1
        assert plan.times_s[0] == 0.0
        np.testing.assert_array_equal(plan.configurations_rad[0], scenario.start)
        assert (np.diff(plan.times_s) > 0).all()
        assert np.isfinite(plan.configurations_rad).all()


@every_planner
@every_case
@with_and_without_limits
def test_a_path_ends_where_it_claims(name: str, case: str, limits: bool) -> None:
    plan, scenario = first_plan(name, case, limits), CASES[case]
    assert plan.status in STATUSES
    if len(plan.times_s):
        there = scenario.arm.tip(plan.configurations_rad[-1])
        reached = np.linalg.norm(there - scenario.goal) <= scenario.goal_tolerance_m
        assert plan.status == ("Exact solution" if reached else "Approximate solution")
    else:
        assert plan.status != "Exact solution"


@every_case_it_must_master
@with_and_without_limits
def test_its_timed_states_are_valid_in_the_predicted_world(name: str, case: str, limits: bool) -> None:
    plan, problem = first_plan(name, case, limits), problem_of(name, CASES[case], 0.0, limits)
    state = problem.si.allocState()
    for q, time in zip(plan.configurations_rad, plan.times_s, strict=True):
        state[0][0 : len(q)] = q.tolist()
        state[1].position = float(time)
        assert problem.si.isValid(state), time


@every_case_it_must_master
def test_its_motions_are_valid_where_limits_bind(name: str, case: str) -> None:
    plan, problem = first_plan(name, case, True), problem_of(name, CASES[case], 0.0, True)
    for k in range(len(plan.times_s) - 1):
        motion = [part[j] for j in (k, k + 1) for part in (plan.configurations_rad, plan.times_s)]
        assert problem.validator.check(*motion), plan.times_s[k]


@every_planner
def test_it_goes_on_from_the_end_of_its_path(name: str) -> None:
    scenario = CASES["moving obstacles"]
    session, q, now = session_of(name, scenario), scenario.start, 0.0
    for _ in range(4):
        plan = session.plan(q, now, observe(scenario, now))
        if len(plan.times_s):
            assert plan.times_s[0] == now
            np.testing.assert_array_equal(plan.configurations_rad[0], q)
            assert (np.diff(plan.times_s) > 0).all()
            ahead = np.searchsorted(plan.times_s, now + 1.0)
            if plan.times_s[ahead] == now + 1.0:  # else a state between two of the path's: hold still instead
                q = plan.configurations_rad[ahead]
        now += 1.0


@every_planner
def test_equal_seeds_give_equal_plans_in_one_process(name: str) -> None:
    scenario = CASES["moving obstacles near by"]

    def plans() -> list[Plan]:
        session = session_of(name, scenario, seed=7)
        return [session.plan(scenario.start, now, observe(scenario, now)) for now in (0.0, 1.0)]

    first = plans()
    session_of("rrt", scenario, seed=99).plan(scenario.start, 0.0, observe(scenario))  # uses up random numbers
    for a, b in zip(first, plans(), strict=True):
        assert a.status == b.status
        assert (a.state_checks, a.motion_checks) == (b.state_checks, b.motion_checks)
        np.testing.assert_array_equal(a.times_s, b.times_s)
        np.testing.assert_array_equal(a.configurations_rad, b.configurations_rad)


@every_planner
@with_and_without_limits
def test_it_changes_nothing_it_was_given(name: str, limits: bool) -> None:
    scenario = CASES["moving obstacles near by"]
    before = scenario.model_dump_json()
    seen, q = observe(scenario), scenario.start
    copies = [array.copy() for array in seen]
    spec = parse_planner(name)
    session = Session(spec, scenario, predictor="cubic", limits=limits, seed=1)
    plan = session.plan(q, 0.0, seen)
    kept = plan.configurations_rad.copy()
    session.plan(q, 0.0, seen)
    np.testing.assert_array_equal(plan.configurations_rad, kept)  # nor what it gave away
    np.testing.assert_array_equal(q, scenario.start)
    for array, copy in zip(seen, copies, strict=True):
        np.testing.assert_array_equal(array, copy)
    assert scenario.model_dump_json() == before
    assert spec == parse_planner(name)


@every_planner
@pytest.mark.parametrize("asked", [0, 1, 7])
def test_it_stops_when_its_budget_is_spent(name: str, asked: int) -> None:
    scenario = CASES["moving obstacles"]
    problem = problem_of(name, scenario, 0.0, False)
    planner = CLASSES[name](problem, parse_planner(name).settings)
    rng = np.random.default_rng(0)
    goals = GoalConfigurations(scenario.arm, scenario.goal, scenario.goal_tolerance_m, 8, rng)
    definition = problem.definition(scenario.start, 0.0, goals, rng)
    planner.setProblemDefinition(definition)
    planner.setup()
    questions = 0

    def spent() -> bool:
        nonlocal questions
        questions += 1
        return questions > asked

    planner.solve(ob.PlannerTerminationCondition(spent))
    assert questions <= asked + 3  # told once, it may ask again on its way out
    if asked == 0:
        assert not definition.hasExactSolution()


@pytest.mark.parametrize(
    ("name", "setting"),
    [(n, s) for n in NAMES for s in ("iterations", "branches") if s in CLASSES[n].settings_model.model_fields],
)
def test_a_small_budget_is_little_work(name: str, setting: str) -> None:
    def work(text: str) -> int:
        # Out of reach: a search goes on until its budget ends.
        scenario = CASES["moving obstacles"].model_copy(update={"goal_m": (0.0, 0.0, 0.46)})
        plan = session_of(text, scenario).plan(scenario.start, 0.0, observe(scenario))
        return plan.state_checks + plan.motion_checks

    assert work(f"{name}[{setting}=2]") <= 0.5 * work(name) + 100


def resting_ball(center: np.ndarray, radius: float) -> Obstacle:
    return Obstacle(radius_m=radius, motion=Track(times_s=(0.0,), positions_m=(tuple(center.tolist()),)))


def shut_in() -> Scenario:
    """The start is free, but wherever it turns it meets one of hundreds of balls a millimetre off."""
    scenario = CASES["nothing in the way"]
    arm, rng = scenario.arm, np.random.default_rng(0)
    backbone = arm.backbone_points(scenario.start, 200)
    centers = []
    for point in arm.backbone_points(scenario.start, 4):
        for direction in rng.normal(size=(60, 3)):
            center = point + (arm.radius_m + 0.031) * direction / np.linalg.norm(direction)
            if np.linalg.norm(backbone - center, axis=1).min() > arm.radius_m + 0.0305:
                centers.append(center)
    return scenario.model_copy(update={"obstacles": tuple(resting_ball(center, 0.03) for center in centers)})


def goal_taken() -> Scenario:
    scenario = CASES["nothing in the way"]
    return scenario.model_copy(update={"obstacles": (resting_ball(scenario.goal, 0.05),)})


def swallowed() -> Scenario:
    return CASES["nothing in the way"].model_copy(update={"obstacles": (resting_ball(np.zeros(3), 2.0),)})


def out_of_reach(goal: tuple[float, float, float]) -> Callable[[], Scenario]:
    return lambda: CASES["moving obstacles"].model_copy(update={"goal_m": goal})


HOPELESS = {
    "inside an obstacle": swallowed,
    "shut in": shut_in,
    "goal inside an obstacle": goal_taken,
    "goal just out of reach": out_of_reach((0.0, 0.0, 0.465)),
    "goal at the end of the world": out_of_reach((100.0, -100.0, 100.0)),
}


@every_planner
@pytest.mark.parametrize("case", HOPELESS)
@with_and_without_limits
def test_no_path_is_a_status_and_no_exception(name: str, case: str, limits: bool) -> None:
    scenario = HOPELESS[case]()
    patient = "restarts" in CLASSES[name].settings_model.model_fields
    session = session_of(f"{name}[restarts=1,branches=300]" if patient else name, scenario, limits)
    for now in (0.0, 1.0):
        plan = session.plan(scenario.start, now, observe(scenario, now))
        assert plan.status in STATUSES - {"Exact solution"}
        assert plan.configurations_rad.shape == (len(plan.times_s), 6)
        assert plan.solve_time_s >= 0


@pytest.mark.parametrize("name", [name for name in NAMES if not CLASSES[name].is_bound])
def test_after_a_hopeless_solve_it_plans_again(name: str) -> None:
    scenario = swallowed()
    session = session_of(name, scenario)
    session.plan(scenario.start, 0.0, observe(scenario))
    far = observe(scenario, 1.0)
    far.positions_m[:] = 50.0
    plan = session.plan(scenario.start, 1.0, far)
    clear = session_of(name, scenario).plan(scenario.start, 1.0, far)
    assert (len(plan.times_s) > 0) == (len(clear.times_s) > 0)


def test_a_path_that_leads_to_the_goal_is_valid_until_the_prediction_says_otherwise() -> None:
    scenario = CASES["moving obstacles"]
    session, seen = session_of("temporal-ct", scenario), observe(scenario)
    plan = session.plan(scenario.start, 0.0, seen)
    assert plan.status == "Exact solution"
    assert session.still_valid(plan.times_s, plan.configurations_rad, seen)
    assert not session.still_valid(plan.times_s[:2], plan.configurations_rad[:2], seen)  # short of the goal
    assert not session.still_valid(plan.times_s, plan.configurations_rad[::-1], seen)
    in_the_way = seen._replace(positions_m=seen.positions_m.copy())
    in_the_way.positions_m[:, 0] = scenario.arm.tip(plan.configurations_rad[-1])
    assert not session.still_valid(plan.times_s, plan.configurations_rad, in_the_way)


def test_other_seeds_give_other_random_trees() -> None:
    scenario = CASES["moving obstacles"]
    one, two = (session_of("rrt", scenario, seed=k).plan(scenario.start, 0.0, observe(scenario)) for k in (1, 2))
    assert one.times_s.tolist() != two.times_s.tolist()


def test_a_session_needs_a_known_predictor() -> None:
    with pytest.raises(ValueError, match="crystal ball"):
        Session(parse_planner("rrt"), CASES["moving obstacles"], predictor="crystal ball", limits=False, seed=1)
