from unittest.mock import patch

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planners import Observation, Session, parse_planner
from planners.continuous import planner
from planners.continuous._kernels import FAILURE_WEIGHT, near_node
from planners.continuous.planner import FAR_S, NEAR_S, ContinuousPlanner, Found, TreePlanner
from planners.continuous.workspace import Workspace, body_of
from planners.problem import TimedPath
from planners.search.certificate import _kernels as certificate
from planners.search.steering import _kernels as steering
from scenarios import ContinuumArm, Obstacle, Orbit, Scenario, generate, make_world
from scenarios.kernels.clearance import clearances
from scenarios.kernels.kinematics import section_arcs, tip_jacobian
from scenarios.world import SampledWorld
from suite import plan
from suite.auditor import audit

ARM = ContinuumArm()
SCENARIOS = generate("orbit", 3, 4, 1003)


def observe(scenario: Scenario, now_s: float = 0.0) -> Observation:
    times = np.arange(-scenario.observation_s, now_s + 1.0)
    centers = np.stack([o.position(times) for o in scenario.obstacles], axis=1)
    return Observation(times, centers, np.array([o.radius_m for o in scenario.obstacles]))


def session(scenario: Scenario, text: str = "temporal-ct", predictor: str = "truth", seed: int = 1) -> Session:
    return Session(parse_planner(text), scenario, predictor=predictor, limits=False, seed=seed)


def random_configuration(rng: np.random.Generator) -> np.ndarray:
    bend, plane = np.pi * np.sqrt(rng.uniform(size=3)), rng.uniform(-np.pi, np.pi, size=3)
    return np.stack([bend * np.cos(plane), bend * np.sin(plane)], axis=1).reshape(-1)


def still_sphere(center_m: tuple[float, float, float], radius_m: float) -> Obstacle:
    return Obstacle(
        radius_m=radius_m,
        motion=Orbit(center_m=center_m, radius_m=0.0, normal=(0.0, 0.0, 1.0), rate_rad_s=0.0, phase_rad=0.0),
    )


@pytest.mark.parametrize("text", ["temporal-ct", "clairvoyant[restarts=2,branches=300]"])
@pytest.mark.parametrize("scenario", SCENARIOS, ids=lambda scenario: scenario.id)
def test_paths_under_the_true_motion_are_executable(scenario: Scenario, text: str) -> None:
    planned = session(scenario, text)
    plan = planned.plan(scenario.start, 0.0, observe(scenario))
    judged = audit(scenario, plan.times_s, plan.configurations_rad)
    assert judged.executable.violation_kind == ""
    if plan.status == "Exact solution":
        assert judged.executable.success
        assert planned.still_valid(plan.times_s, plan.configurations_rad, observe(scenario))


def test_a_seed_gives_the_same_path_and_another_seed_another() -> None:
    scenario = SCENARIOS[0]
    paths = [session(scenario, seed=s).plan(scenario.start, 0.0, observe(scenario)) for s in (5, 5, 6)]
    assert np.array_equal(paths[0].configurations_rad, paths[1].configurations_rad)
    assert paths[0].configurations_rad.shape != paths[2].configurations_rad.shape or not np.array_equal(
        paths[0].configurations_rad, paths[2].configurations_rad
    )


def test_a_new_plan_builds_on_the_free_part_of_the_last() -> None:
    scenario = SCENARIOS[0]
    planned = session(scenario)
    first = planned.plan(scenario.start, 0.0, observe(scenario))
    at_two = np.array([np.interp(2.0, first.times_s, column) for column in first.configurations_rad.T])
    again = planned.plan(at_two, 2.0, observe(scenario, 2.0))
    assert again.status == first.status
    assert again.times_s[-1] <= first.times_s[-1] + 1e-9


def test_without_a_way_to_the_goal_the_path_is_free_for_as_long_as_can_be() -> None:
    # The goal lies inside a sphere; the arm is free to stay where it is.
    start = np.full(6, 0.2)
    scenario = Scenario(
        id="shut",
        arm=ARM,
        start_rad=tuple(start.tolist()),
        goal_m=(0.2, 0.0, 0.2),
        obstacles=(still_sphere((0.2, 0.0, 0.2), 0.05),),
    )
    planned = session(scenario, "temporal-ct[branches=200,horizon_s=20]")
    plan = planned.plan(start, 0.0, observe(scenario))
    assert plan.status == "Approximate solution"
    assert plan.times_s[-1] >= 19.0
    assert audit(scenario, plan.times_s, plan.configurations_rad).executable.violation_kind == "short of goal"
    assert not planned.still_valid(plan.times_s, plan.configurations_rad, observe(scenario))


def test_less_margin_is_for_a_way_to_the_goal_or_for_an_arm_in_need() -> None:
    def lasts(seconds: float, reaches: bool = False) -> Found:
        return Found(TimedPath(np.array([7.0, 7.0 + seconds]), np.zeros((2, 6))), reaches)

    calm, pressed, longer, way = lasts(30.0), lasts(2.0), lasts(100.0), lasts(20.0, reaches=True)
    assert calm.or_else(way) is way
    assert calm.or_else(longer) is calm
    assert pressed.or_else(longer) is longer
    assert pressed.or_else(lasts(4.0)) is pressed
    assert way.or_else(longer) is way


@pytest.mark.parametrize(("noise_m", "searches"), [(0.0, [1, 1, 1]), (0.002, [4, 2, 2])])
def test_margins_are_tried_only_where_they_can_help(
    noise_m: float, searches: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    # The goal lies deep inside a sphere: with no margin is there a way.
    start = np.full(6, 0.2)
    sphere = still_sphere((0.2, 0.0, 0.2), 0.1)
    scenario = Scenario(
        id="shut", arm=ARM, start_rad=tuple(start.tolist()), goal_m=(0.2, 0.0, 0.2), obstacles=(sphere,)
    )
    asked: list[float] = []

    def counted(planner: TreePlanner, world: SampledWorld, branches: int) -> Found:
        asked.append(planner._workspace.tree.times[0])
        return grow_tree(planner, world, branches)

    grow_tree = TreePlanner.grow_tree
    monkeypatch.setattr(TreePlanner, "grow_tree", counted)
    planned = session(scenario, "temporal-ct[branches=20,horizon_s=20]", predictor="portfolio")
    rng = np.random.default_rng(4)
    for now_s in (0.0, 1.0, 2.0):
        seen = observe(scenario, now_s)
        noise = noise_m * rng.normal(size=seen.positions_m.shape)
        planned.plan(start, now_s, seen._replace(positions_m=seen.positions_m + noise))
    assert [asked.count(now_s) for now_s in (0.0, 1.0, 2.0)] == searches


@pytest.mark.parametrize(
    ("lasting_s", "shares"),
    [
        ([9.0] * 4, [(1.0, 1.0), (1.0, 0.5), (1.0, 0.0), (1.0, -0.5)]),
        ([1.0, 9.0, 9.0, 9.0], [(1.0, 1.0), (0.5, 0.5), (0.5, 0.0), (0.5, -0.5)]),
        ([0.0] * 4, [(1.0, 1.0), (0.5, 0.5), (0.0, 0.0), (-0.5, -0.5)]),
    ],
)
def test_the_next_seconds_keep_the_widest_margin_that_leaves_somewhere_to_go(
    lasting_s: list[float], shares: list[tuple[float, float]], monkeypatch: pytest.MonkeyPatch
) -> None:
    scenario = SCENARIOS[0]
    asked: list[SampledWorld] = []

    def lasting(planner: TreePlanner, world: SampledWorld, branches: int) -> Found:
        seconds = lasting_s[len(asked)]
        asked.append(world)
        return Found(TimedPath(np.array([0.0, seconds]), np.tile(scenario.start, (2, 1))), reaches=False)

    monkeypatch.setattr(TreePlanner, "grow_tree", lasting)
    seen = observe(scenario)
    noise = 0.002 * np.random.default_rng(4).normal(size=seen.positions_m.shape)
    seen = seen._replace(positions_m=seen.positions_m + noise)
    planned = session(scenario, predictor="portfolio")
    planned.plan(scenario.start, 0.0, seen)
    prediction = planned._problem.query.prediction
    ahead_s, bounds_m = prediction.ahead_s, np.minimum(prediction.bounds_m, ContinuousPlanner.largest_bound_m)
    for world, (near, far) in zip(asked, shares, strict=True):
        margins = (world.radii_m - prediction.radii_m) / bounds_m
        np.testing.assert_allclose(margins[ahead_s <= NEAR_S], 2.0 * near, atol=1e-9)
        np.testing.assert_allclose(margins[ahead_s >= FAR_S], 2.0 * far, atol=1e-9)
        between = margins[(ahead_s > NEAR_S) & (ahead_s < FAR_S)]
        assert (between >= 2.0 * far - 1e-9).all()
        assert (between <= 2.0 * near + 1e-9).all()


@pytest.mark.parametrize(
    ("failures", "reaching", "events"),
    [
        (0, [], ["plant", "grow", "grow", "grow", "grow"]),
        (0, [0], ["plant", "grow"]),
        (1, [], ["plant", "grow", "grow"]),
        (1, [1, 2], ["plant", "grow", "grow", "plant", "grow"]),
    ],
)
def test_a_tree_is_grown_further_among_smaller_obstacles_and_planted_anew_among_larger_ones(
    failures: int, reaching: list[int], events: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    scenario = SCENARIOS[0]
    told, worlds = list[str](), list[SampledWorld]()

    def plant(planner: TreePlanner, trunk: TimedPath, world: SampledWorld) -> None:
        told.append("plant")
        worlds.clear()

    def grow(planner: TreePlanner, world: SampledWorld, branches: int) -> Found:
        assert all((world.radii_m <= before.radii_m).all() for before in worlds)
        worlds.append(world)
        reaches = told.count("grow") in reaching
        told.append("grow")
        return Found(TimedPath(np.array([0.0, 9.0]), np.tile(scenario.start, (2, 1))), reaches)

    monkeypatch.setattr(TreePlanner, "plant_tree", plant)
    monkeypatch.setattr(TreePlanner, "grow_tree", grow)
    seen = observe(scenario)
    noise = 0.002 * np.random.default_rng(4).normal(size=seen.positions_m.shape)
    planned = session(scenario, predictor="portfolio")
    planned._planner._failures = failures
    planned.plan(scenario.start, 0.0, seen._replace(positions_m=seen.positions_m + noise))
    assert told == events


@given(seed=st.integers(0, 2**32 - 1))
@settings(deadline=None, max_examples=20)
def test_paths_of_a_tree_grown_further_are_free_of_what_it_was_grown_among_last(seed: int) -> None:
    scenario = SCENARIOS[seed % len(SCENARIOS)]
    planned = session(scenario, "temporal-ct[branches=40]", seed=seed % 1000)
    planned.plan(scenario.start, 0.0, observe(scenario))
    planner, world = planned._planner, planned._problem.query.world
    assert isinstance(planner, TreePlanner)
    for part, share in enumerate((1.5, 1.2, 1.0)):
        smaller = make_world(world.start_s, world.step_s, world.centers_m, share * world.radii_m)
        if part == 0:
            planner.plant_tree(TimedPath(np.zeros(1), scenario.start[None]), smaller)
        (times, path), reaches = planner.grow_tree(smaller, 30)
        tree = planner._workspace.tree
        assert reaches or times[-1] == tree.times[: tree.counts[0]].max()
        assert (path[0] == scenario.start).all()
        dense = np.linspace(times[0], times[-1], 400)
        states = np.stack([np.interp(dense, times, column) for column in path.T], axis=1)
        gaps = clearances(states, dense, ARM.section_length_m, ARM.radius_m, smaller)
        assert gaps.min() > min(gaps[0] - 1e-3, 0.0)
    checked = planner.state_checks, planner.motion_checks
    planner.grow_tree(smaller, 0)
    assert (planner.state_checks, planner.motion_checks) == checked  # none is counted twice


def test_an_arm_that_seems_to_be_touched_gets_out() -> None:
    start = np.full(6, 0.2)
    outward = ARM.jacobian(start)[:, 0] / np.linalg.norm(ARM.jacobian(start)[:, 0])
    center = ARM.tip(start) + (ARM.radius_m + 0.02 - 0.001) * outward  # 1 mm inside
    scenario = Scenario(
        id="touched",
        arm=ARM,
        start_rad=tuple(start.tolist()),
        goal_m=tuple(ARM.tip(start - 0.4).tolist()),
        obstacles=(still_sphere(tuple(center.tolist()), 0.02),),
    )
    plan = session(scenario).plan(start, 0.0, observe(scenario))
    times = np.linspace(0.0, plan.times_s[-1], 200)
    path = np.stack([np.interp(times, plan.times_s, column) for column in plan.configurations_rad.T], axis=1)
    world = make_world(0.0, 1.0, np.tile(center, (2, 1, 1)), np.array([0.02]))
    gaps = clearances(path, times, ARM.section_length_m, ARM.radius_m, world)
    assert plan.status == "Exact solution"
    assert gaps.min() > -0.002
    assert gaps[-1] > 0.0


@given(seed=st.integers(0, 2**32 - 1), count=st.integers(1, 255), bounded=st.booleans())
def test_the_near_node_is_the_nearest_in_time_of_a_small_tree(seed: int, count: int, bounded: bool) -> None:
    rng = np.random.default_rng(seed)
    space, body = Workspace.of(ARM, 255), body_of(ARM, 0.0)
    tree, target = space.tree, space.target
    tree.counts[0] = count
    tree.states[:], tree.tips[:] = rng.normal(size=tree.states.shape), rng.normal(scale=0.2, size=tree.tips.shape)
    tree.times[:], tree.failures[:] = rng.uniform(0.0, 40.0, size=255), rng.integers(0, 4, size=255)
    target.posture[:], target.point[:] = rng.normal(size=6), rng.normal(scale=0.2, size=3)
    goal, stop, before, bound = rng.normal(scale=0.2, size=3), 0.009, 25.0, 30.0 if bounded else np.inf
    far = np.hypot(
        np.linalg.norm(tree.tips - target.point, axis=1) / body.tip_speed,
        np.linalg.norm(tree.states - target.posture, axis=1) / body.bend_rate,
    ) * (1.0 + FAILURE_WEIGHT * tree.failures)
    arrival = tree.times + (np.linalg.norm(tree.tips - goal, axis=1) - stop) / body.tip_speed
    far[(tree.times > before) | (arrival >= bound) | (np.arange(255) >= count)] = np.inf
    found = near_node(tree, target, before, goal, stop, bound, np.array([seed], np.uint64), body)
    assert found == (np.argmin(far) if far.min() < np.inf else -1)


@pytest.mark.parametrize("margin", [0.0, 0.004])
def test_a_certificate_is_never_wrong_and_seldom_withheld(margin: float) -> None:
    rng = np.random.default_rng(7)
    stack, body = Workspace.of(ARM, 10).stack, body_of(ARM, 0.0)
    given = free_in_all = 0
    shares = np.linspace(0.0, 1.0, 101)
    for _ in range(400):
        q0, q1 = random_configuration(rng), random_configuration(rng)
        q1 = q0 + rng.uniform(0.02, 0.3) * (q1 - q0)
        places = rng.uniform(-0.3, 0.3, size=(3, 3))
        moved = places + rng.uniform(-0.02, 0.02, size=(3, 3))
        world = make_world(0.0, 1.0, np.stack([places, moved]), np.full(3, 0.02))
        dense = clearances(q0 + shares[:, None] * (q1 - q0), shares, ARM.section_length_m, ARM.radius_m, world)
        section_arcs(q0, ARM.section_length_m, stack.arcs[0])
        section_arcs(q1, ARM.section_length_m, stack.arcs[1])
        certificate.arc_clearances(stack.arcs[0], 0.0, body.radius, world, stack.gaps[0])
        free, _ = certificate.is_clear(
            q0, 0.0, q1 - q0, 1.0, margin, body.section_length, body.radius, world, stack
        )  # fmt: skip
        if dense[0] <= margin + 1e-4:
            continue  # a motion starts where the last one ended, free
        assert not free or dense.min() > margin
        free_in_all += dense.min() > margin + 3e-4
        given += free and dense.min() > margin + 3e-4
    assert free_in_all > 100
    assert given >= 0.99 * free_in_all


def test_a_step_takes_the_tip_straight_and_keeps_to_the_rates() -> None:
    rng = np.random.default_rng(3)
    space, body = Workspace.of(ARM, 10), body_of(ARM, 0.01)
    step, target = space.step, space.target
    for _ in range(200):
        q = random_configuration(rng)
        target.posture[:] = random_configuration(rng)
        section_arcs(q, ARM.section_length_m, space.stack.arcs[0])
        tip = space.stack.arcs[0, 2, 12:15].copy()
        target.point[:] = tip + rng.normal(scale=0.1, size=3)
        tip_jacobian(space.stack.arcs[0], ARM.section_length_m, step.jacobian)
        steering.steer(q, tip, target, 0.0, 0.5, body, step)
        section_arcs(step.state, ARM.section_length_m, space.stack.arcs[1])
        tip_jacobian(space.stack.arcs[1], ARM.section_length_m, step.jacobian_after)
        duration = steering.least_duration(tip, space.stack.arcs[1, 2, 12:15], body, step)
        states = q + np.linspace(0.0, 1.0, 201)[:, None] * step.change
        speeds = np.linalg.norm(np.diff(ARM.tips(states), axis=0), axis=1) * 200 / duration
        rates = np.linalg.norm(step.change.reshape(3, 2), axis=1) / duration
        assert speeds.max() <= ARM.max_tip_speed_m_s
        assert rates.max() <= ARM.max_bend_rate_rad_s
        assert np.linalg.norm(step.state.reshape(3, 2), axis=1).max() <= ARM.max_bend_rad + 1e-12


def test_a_margin_that_a_run_asks_for_takes_the_place_of_its_own() -> None:
    scenario = generate("orbit", 2, 1, 1003)[0]
    asked = [
        Session(parse_planner(text), scenario, predictor="portfolio", limits=False, seed=1, margin=margin)
        for text, margin in (("temporal-ct[margin=0.5]", None), ("temporal-ct", 0.5), ("temporal-ct", None))
    ]
    assert [session._planner._margin for session in asked] == [0.5, 0.5, 2.0]
    assert [session._margin for session in asked] == [1.0, 0.5, 1.0]


def test_the_bound_holds_nothing_back_in_the_end() -> None:
    """A goal that can be reached in time at the arm's very rates only."""
    scenario = generate("orbit", 0, 2, seed=1000)[1]
    soonest_s = plan(scenario, "clairvoyant[refinements=2000]").times_s[-1]
    hurried = f"clairvoyant[restarts=3,horizon_s={0.99 * soonest_s:.6f}]"
    found = [plan(scenario, hurried, seed=seed) for seed in range(6)]
    exact = [one for one in found if one.status == "Exact solution"]
    assert exact
    for one in exact:
        assert audit(scenario, one.times_s, one.configurations_rad).executable.success
    with (
        patch.object(planner, "LAST_RATE_RESERVE", planner.RATE_RESERVE),
        patch.object(planner, "LAST_GOAL_SHARE", planner.GOAL_SHARE),
    ):
        assert {plan(scenario, hurried, seed=seed).status for seed in range(6)} == {"Approximate solution"}
