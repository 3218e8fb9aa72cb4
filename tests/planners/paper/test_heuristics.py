"""The two heuristics: they know the present alone, and each reading of a blocked cube is stricter than the last."""

import numpy as np
import pytest
from twins.cubes import cube_of, is_free

from planners import PLANNERS, Observation, Plan, Session, parse_planner
from planners.paper.heuristics import PurgingPlanner, StaticPathPlanner
from planners.prediction import Prediction
from planners.problem import Query, SpaceTimeProblem
from scenarios import Scenario, generate, is_motion_valid, make_world

SCENARIOS = generate("orbit[max_speed_m_s=0.05]", 6, 12, 21)


def observed(scenario: Scenario, way: float = 1.0) -> Observation:
    """What is seen up to t = 0; ``way`` -1 has every obstacle come from where it really goes."""
    times = np.arange(-scenario.observation_s, 0.5)
    centers = np.stack([obstacle.position(way * times) for obstacle in scenario.obstacles], axis=1)
    return Observation(times, centers, np.array([obstacle.radius_m for obstacle in scenario.obstacles]))


def first_plan(name: str, scenario: Scenario, way: float, limits: bool) -> Plan:
    session = Session(parse_planner(name), scenario, predictor="cubic", limits=limits, seed=1)
    return session.plan(scenario.start, 0.0, observed(scenario, way))


def planner_of(name: str, scenario: Scenario) -> StaticPathPlanner:
    """The planner on a prediction that holds every obstacle where it is, but for the last moment."""
    now = np.stack([obstacle.position(np.zeros(1))[0] for obstacle in scenario.obstacles])
    radii = np.array([obstacle.radius_m for obstacle in scenario.obstacles])
    prediction = Prediction(0.0, 1.0, np.stack([now, now + 0.02]), radii, np.zeros((2, len(now))))
    query = Query(scenario.arm, scenario.goal, scenario.goal_tolerance_m, prediction, prediction.world(0.0), False)
    problem = SpaceTimeProblem(query, 1.0)
    problem.update(query, 0.0)
    spec = parse_planner(name)
    planner = PLANNERS[spec.name](problem, spec.settings)
    assert isinstance(planner, StaticPathPlanner)
    return planner


@pytest.mark.parametrize("limits", [False, True])
@pytest.mark.parametrize("name", ["h", "hs", "h[blocked=motion]"])
def test_where_obstacles_are_going_makes_no_difference(name: str, limits: bool) -> None:
    for scenario in SCENARIOS:
        one, other = (first_plan(name, scenario, way, limits) for way in (1.0, -1.0))
        assert one.status == other.status
        np.testing.assert_array_equal(one.configurations_rad, other.configurations_rad)


def test_to_a_planner_that_predicts_it_does() -> None:
    plans = [[first_plan("t3", s, way, False).configurations_rad.tolist() for way in (1.0, -1.0)] for s in SCENARIOS]
    assert any(one != other for one, other in plans)


@pytest.mark.parametrize("name", ["h", "hs"])
def test_with_limits_its_motions_are_free_of_obstacles_at_rest(name: str) -> None:
    moved = 0
    for scenario in SCENARIOS:
        plan = first_plan(name, scenario, 1.0, True)
        now = observed(scenario).positions_m[-1]
        world = make_world(0.0, 1.0, np.stack([now, now]), np.array([o.radius_m for o in scenario.obstacles]))
        for before, after in zip(plan.configurations_rad, plan.configurations_rad[1:], strict=False):
            assert is_motion_valid(scenario.arm, before, 0.0, after, 1.0, world)
            assert np.hypot(*(after - before).reshape(-1, 2).T).max() <= scenario.arm.max_bend_rate_rad_s * (1 + 1e-9)
            moved += (before != after).any()
    assert moved > 0 or name == "hs"  # it waits for motions that the lattice hardly has


def neighbours(planner: StaticPathPlanner, here: int) -> list[int]:
    side = 2 * planner._space.half
    moves = [(i * side + j) * side + k for i in (-1, 0, 1) for j in (-1, 0, 1) for k in (-1, 0, 1)]
    occupied = np.diff(planner._space.offsets) > 0
    return [here + move for move in moves if move and occupied[here + move]]


def test_each_reading_of_a_blocked_cube_is_stricter_than_the_last() -> None:
    differs = {"cube": 0, "body": 0}
    for scenario in generate("orbit[max_orbit_m=0.1,max_distance_m=0.25]", 12, 8, 22):
        readings = {name: planner_of(f"h[blocked={name}]", scenario) for name in ("cube", "body", "motion")}
        arm, here = scenario.arm, readings["cube"]._space.cube_of(scenario.arm.tip(scenario.start))
        now = np.stack([obstacle.position(np.zeros(1))[0] for obstacle in scenario.obstacles])
        radii = np.array([obstacle.radius_m for obstacle in scenario.obstacles])
        world = make_world(0.0, 1.0, np.stack([now, now]), radii)
        for cube in neighbours(readings["cube"], here):
            steps = {name: p._transition(scenario.start, 0.0, here, cube) for name, p in readings.items()}
            assert steps["body"] is None or steps["cube"] is not None
            assert steps["motion"] is None or steps["body"] is not None
            differs["cube"] += steps["cube"] is not None and steps["body"] is None
            differs["body"] += steps["body"] is not None and steps["motion"] is None
            if steps["body"] is not None:
                assert is_free(steps["body"][1], arm.section_length_m, now, radii + arm.radius_m)
            if steps["motion"] is not None:
                assert is_motion_valid(arm, scenario.start, 0.0, steps["motion"][1], 1.0, world)
    assert min(differs.values()) > 0, differs


def test_purged_cubes_return_when_they_are_to_be_forgotten_and_only_then() -> None:
    for name, stays in (("h", True), ("h[forget=true]", False)):
        scenario = SCENARIOS[0]
        planner = planner_of(name, scenario)
        assert isinstance(planner, PurgingPlanner)
        far = int(np.flatnonzero(np.diff(planner._space.offsets))[0])  # not on the way
        assert not planner.when_blocked(far)
        path = planner.search(scenario.start, 0.0, lambda: False)
        assert path is not None
        assert planner._purged[far] == stays


def test_a_step_leads_to_a_neighbouring_cube_on_a_shortest_way() -> None:
    for scenario in SCENARIOS:
        plan = first_plan("h[forget=true]", scenario, 1.0, False)
        if len(plan.times_s):
            before, after = (np.array(cube_of(tip)) for tip in scenario.arm.tips(plan.configurations_rad))
            assert np.abs(after - before).max() <= 1
