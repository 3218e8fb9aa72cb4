"""ST-RRT* against its description: Grothe, Hartmann, Orthey and Toussaint, ICRA 2022."""

import math

import numpy as np
import pytest

from planners import Observation, Plan, Session, parse_planner
from planners.strrt import STRRTPlanner, _kernels, numbers_of
from planners.strrt.region import _kernels as region
from planners.strrt.trees import _kernels as trees
from scenarios import ContinuumArm, Scenario, generate
from suite.auditor import audit

ARM = ContinuumArm()
UNSOLVED, *SOLVED = generate("orbit", 6, 3, 1004)
SCENARIOS = [*generate("orbit", 3, 3, 1004), *SOLVED]
FREE = generate("orbit", 0, 3, 1004)
EVERY = "refinements=10000"


def observe(scenario: Scenario) -> Observation:
    times = np.arange(-scenario.observation_s, 0.5)
    centers = np.empty((len(times), len(scenario.obstacles), 3))
    for j, obstacle in enumerate(scenario.obstacles):
        centers[:, j] = obstacle.position(times)
    return Observation(times, centers, np.array([o.radius_m for o in scenario.obstacles]))


def session(scenario: Scenario, settings: str = "", seed: int = 1) -> Session:
    text = f"strrt[{settings}]" if settings else "strrt"
    return Session(parse_planner(text), scenario, predictor="truth", limits=True, seed=seed)


def plan(scenario: Scenario, settings: str = "", seed: int = 1) -> Plan:
    return session(scenario, settings, seed).plan(scenario.start, 0.0, observe(scenario))


def searched(scenario: Scenario, settings: str) -> tuple[Plan, STRRTPlanner, Session]:
    """A plan, and the planner with its trees as the search left them."""
    used = session(scenario, settings)
    return used.plan(scenario.start, 0.0, observe(scenario)), used._planner, used


def nodes_of(tree: trees.Tree) -> range:
    return range(int(tree.size[0]))


every_scenario = pytest.mark.parametrize("scenario", SCENARIOS, ids=lambda scenario: scenario.id)
with_and_without_rewiring = pytest.mark.parametrize("rewiring", ["true", "false"])


@every_scenario
@with_and_without_rewiring
def test_a_path_leads_from_the_start_to_the_goal_by_valid_motions(scenario: Scenario, rewiring: str) -> None:
    used = session(scenario, f"iterations=2000,rewiring={rewiring}")
    found = used.plan(scenario.start, 0.0, observe(scenario))
    assert found.status == "Exact solution"
    assert found.times_s[0] == 0.0
    np.testing.assert_array_equal(found.configurations_rad[0], scenario.start)
    assert (np.diff(found.times_s) > 0).all()
    check = used._problem.validator.check
    for k in range(len(found.times_s) - 1):
        assert check(
            found.configurations_rad[k], found.times_s[k], found.configurations_rad[k + 1], found.times_s[k + 1]
        )
    assert audit(scenario, found.times_s, found.configurations_rad).executable.success


@pytest.mark.parametrize("scenario", [*SCENARIOS, UNSOLVED], ids=lambda scenario: scenario.id)
def test_every_edge_of_both_trees_goes_forward_in_time_and_is_valid(scenario: Scenario) -> None:
    _, planner, used = searched(scenario, "iterations=300,refinements=20")
    start_tree, goal_tree, _ = planner.workspace
    check, edges = used._problem.validator.check, 0
    for k in nodes_of(start_tree):
        if (parent := start_tree.parents[k]) >= 0:
            assert check(start_tree.states[parent], start_tree.times[parent], start_tree.states[k], start_tree.times[k])
            edges += 1
    for k in nodes_of(goal_tree):
        if (parent := goal_tree.parents[k]) >= 0:
            assert check(goal_tree.states[k], goal_tree.times[k], goal_tree.states[parent], goal_tree.times[parent])
            edges += 1
    assert edges > 0


@every_scenario
def test_more_iterations_never_arrive_later(scenario: Scenario) -> None:
    arrivals = []
    for iterations in (10, 20, 40, 80, 160, 320):
        found = plan(scenario, f"iterations={iterations},{EVERY}")
        arrivals.append(found.times_s[-1] if found.status == "Exact solution" else math.inf)
    assert (np.array(arrivals[1:]) <= arrivals[:-1]).all()
    assert arrivals[-1] < arrivals[0]


@every_scenario
def test_nothing_later_than_the_best_arrival_is_kept(scenario: Scenario) -> None:
    found, planner, _ = searched(scenario, f"iterations=200,{EVERY}")
    assert found.status == "Exact solution"
    t_max = found.times_s[-1]
    for tree in planner.workspace[:2]:
        assert tree.times[: tree.size[0]].max() <= t_max
    goal_tree = planner.workspace.goal_tree
    assert goal_tree.arrivals[: goal_tree.size[0]].max() <= t_max


def test_pruning_drops_what_cannot_arrive_in_time_and_nothing_else() -> None:
    scenario = UNSOLVED  # with a path the search would have pruned by itself
    _, planner, used = searched(scenario, "")
    start_tree, goal_tree, work = planner.workspace
    states, arm = used._goals.configurations, numbers_of(scenario.arm)
    goals = region.Goals(states, scenario.arm.tips(states), np.full(len(states), np.nan))
    times = start_tree.times[: start_tree.size[0]].copy()
    left = np.array(
        [
            min(
                trees.least_time(start_tree.states[k], start_tree.tips[k], q, tip, arm)
                for q, tip in zip(goals.states, goals.tips, strict=True)
            )
            for k in nodes_of(start_tree)
        ]
    )
    t_max = float(np.median(times + left))
    arrivals = goal_tree.arrivals[: goal_tree.size[0]].copy()
    _kernels.prune(t_max, goals, arm, start_tree, goal_tree, work)
    in_time = times + left <= t_max + 1e-9
    np.testing.assert_array_equal(start_tree.times[: start_tree.size[0]], times[in_time])
    np.testing.assert_array_equal(goal_tree.arrivals[: goal_tree.size[0]], arrivals[arrivals <= t_max])
    assert goal_tree.size[0] < len(arrivals)
    assert 0 < start_tree.size[0] < len(times)
    for tree in (start_tree, goal_tree):
        for k in nodes_of(tree):
            assert tree.parents[k] < tree.size[0]
    assert (start_tree.parents[1 : start_tree.size[0]] >= 0).all()  # one root: who is kept has a parent that is kept


@every_scenario
def test_an_arrival_is_that_of_the_root_after_any_rewiring(scenario: Scenario) -> None:
    _, planner, _ = searched(scenario, f"iterations=200,{EVERY}")
    start_tree, goal_tree, _ = planner.workspace
    joined = 0
    for k in nodes_of(goal_tree):
        root = k
        while goal_tree.parents[root] >= 0:
            assert goal_tree.times[goal_tree.parents[root]] > goal_tree.times[root]
            root = goal_tree.parents[root]
        assert goal_tree.arrivals[k] == goal_tree.times[root]
        if (other := goal_tree.joined[k]) >= 0:
            np.testing.assert_array_equal(goal_tree.states[k], start_tree.states[other])
            assert goal_tree.times[k] == start_tree.times[other]
            joined += 1
    assert joined > 0


def test_rewiring_arrives_earlier_on_the_whole() -> None:
    scenarios = generate("orbit", 4, 12, 1005)
    ends = [
        [plan(scenario, f"iterations=150,{EVERY},rewiring={on}").times_s[-1:] for scenario in scenarios]
        for on in ("true", "false")
    ]
    both = [float(a[0] / b[0]) for a, b in zip(*ends, strict=True) if len(a) and len(b)]
    assert len(both) >= 8
    assert np.mean(np.log(both)) < 0.0


@pytest.mark.parametrize("scenario", FREE, ids=lambda scenario: scenario.id)
def test_in_free_space_the_arrival_comes_near_the_least_duration(scenario: Scenario) -> None:
    used = session(scenario, f"iterations=3000,{EVERY}")
    found = used.plan(scenario.start, 0.0, observe(scenario))
    arm = numbers_of(scenario.arm)
    straight = min(
        trees.least_duration(scenario.start, q, arm.section_length, arm.bend_rate, arm.tip_speed)
        for q in used._goals.configurations
    )
    chord = np.linalg.norm(scenario.arm.tip(scenario.start) - scenario.goal) - scenario.goal_tolerance_m
    assert found.times_s[-1] <= 1.02 * straight
    assert found.times_s[-1] >= chord / arm.tip_speed


def test_the_same_seed_gives_the_same_path_and_another_seed_another() -> None:
    one, same, other = (plan(SCENARIOS[3], seed=k) for k in (5, 5, 6))
    np.testing.assert_array_equal(one.times_s, same.times_s)
    np.testing.assert_array_equal(one.configurations_rad, same.configurations_rad)
    assert one.times_s.tolist() != other.times_s.tolist()


def test_distance_is_infinite_backward_in_time_and_where_the_rates_do_not_suffice() -> None:
    assert trees.distance(3.0, -4.0, 0.5) == math.inf
    assert trees.distance(3.0, 0.0, 0.5) == math.inf
    assert trees.distance(3.0, 2.9, 0.5) == math.inf
    assert trees.distance(3.0, 5.0, 0.25) == 0.25 * 3.0 + 0.75 * 5.0  # (1)


def test_the_least_time_bounds_every_straight_motion_and_is_a_metric() -> None:
    rng, arm = np.random.default_rng(3), numbers_of(ARM)
    drawn = [rng.uniform(-1.8, 1.8, 6) for _ in range(30)]
    tips = [ARM.tip(q) for q in drawn]

    def least(i: int, j: int) -> float:
        return float(trees.least_time(drawn[i], tips[i], drawn[j], tips[j], arm))

    for i in range(28):
        straight = trees.least_duration(drawn[i], drawn[i + 1], arm.section_length, arm.bend_rate, arm.tip_speed)
        assert least(i, i + 1) <= straight * (1 + 1e-12)
        assert least(i, i + 1) == least(i + 1, i)
        assert least(i, i + 2) <= least(i, i + 1) + least(i + 1, i + 2) + 1e-12


def test_the_goal_region_expands_when_a_batch_is_full_and_there_is_no_path() -> None:
    _, planner, _ = searched(FREE[0], "iterations=1")
    p = region.Parameters(0.5, 2.0, 10.0, 0.75, 0.5, 10.0, True, 90.0)
    before = region.initialize_bound(p)
    assert (before.time_range, before.new_time_range, before.batch_probability) == (2.0, 2.0, 1.0)
    full = before
    for _ in range(10):
        assert region.update_goal_region(full, p, planner.workspace.goal_tree) == full
        full = region.count_sample(full)
    after = region.update_goal_region(full, p, planner.workspace.goal_tree)  # Algorithm 3
    assert (after.time_range, after.new_time_range) == (2.0, 4.0)
    assert after.batch_size == pytest.approx((2.0 - 1.0) * 10.0 / 0.75)
    assert after.batch_probability == pytest.approx((1.0 - 0.75) / 2.0)
    assert (after.samples_in_batch, after.total_samples) == (0.0, 10.0)
    solved = full._replace(t_max=30.0)
    assert region.update_goal_region(solved, p, planner.workspace.goal_tree) == solved


@pytest.mark.parametrize("share", [0.0, 1.0], ids=["new region", "old region"])
def test_samples_lie_between_the_earliest_arrival_and_the_latest_departure(share: float) -> None:
    _, planner, used = searched(FREE[0], "iterations=1")
    arm, (start_tree, goal_tree, work) = numbers_of(ARM), planner.workspace
    goals, rng = used._goals.configurations[:2], np.array([7], np.uint64)
    goal_tree.size[0] = 0
    for goal, time, fresh in ((goals[0], 60.0, False), (goals[1], 85.0, True)):
        goal_tree.fresh[trees.add_node(goal_tree, goal, time, -1, arm, work)] = fresh
    bound = region.Bound(2.0, 4.0, 10.0, 0.0, 0.0, share, math.inf)
    for _ in range(50):
        earliest, time, latest = region.sample_conditionally(bound, rng, arm, start_tree, goal_tree, work)
        assert earliest <= time <= latest
        reached = start_tree.times[0] + trees.least_time(
            start_tree.states[0], start_tree.tips[0], work.state, work.tip, arm
        )
        to_goals = [
            goal_tree.times[k] - trees.least_time(work.state, work.tip, goal_tree.states[k], goal_tree.tips[k], arm)
            for k in (0, 1)
        ]
        assert time >= reached
        assert (reached, to_goals[0]) == (earliest, latest) if share else to_goals[1] == latest
        assert share or time >= to_goals[0]


def test_without_a_path_it_stays_free_for_as_long_as_it_can() -> None:
    scenario = UNSOLVED
    found, planner, _ = searched(scenario, "")
    start_tree = planner.workspace.start_tree
    assert found.status == "Approximate solution"
    assert found.times_s[-1] == start_tree.times[: start_tree.size[0]].max()
    assert audit(scenario, found.times_s, found.configurations_rad).executable.violation_kind == "short of goal"
