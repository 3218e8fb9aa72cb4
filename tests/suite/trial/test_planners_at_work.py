"""The planners in whole trials: when each is asked, what it is given, and what the two heuristics do."""

import itertools
from typing import NamedTuple

import numpy as np
import pytest

from planners import Plan, Session, parse_planner
from planners.problem import SpaceTimeProblem
from scenarios import ContinuumArm, Obstacle, Scenario, Track, generate
from suite.auditor import clearance
from suite.trial import episode
from suite.trial.episode import run_trial
from suite.trial.observation import Observer
from suite.trial.task import TrialResult, TrialTask

WHOLE_PATHS = ("t2", "t3", "temporal[horizon=5]", "h", "hs")
STEPS = ("pf",)
REPLANNED = ("rrt", "rrtconnect", "strrt", "prm", "temporal-ct")
CUBE_M = 0.01
LARGEST_M = 0.005  # the standard deviation that margins are reckoned from is taken for no more


def task_of(name: str, scenario: Scenario, predictor: str = "cubic", **others: float) -> TrialTask:
    return TrialTask(scenario, parse_planner(name), predictor=predictor, limits=False, seed=0, **others)


class Asked(NamedTuple):
    plans: dict[float, Plan]
    """What was answered, by when it was asked [s]."""
    valid: dict[float, bool]
    """Whether the rest of a path still held, by when that was asked [s]."""
    result: TrialResult


@pytest.fixture
def watch(monkeypatch):
    def watched(task: TrialTask) -> Asked:
        plans, valid = dict[float, Plan](), dict[float, bool]()

        class Watched(Session):
            def plan(self, q, now_s, observation):
                plans[now_s] = super().plan(q, now_s, observation)
                return plans[now_s]

            def still_valid(self, times_s, configurations_rad, observation):
                valid[float(times_s[0])] = super().still_valid(times_s, configurations_rad, observation)
                return valid[float(times_s[0])]

        monkeypatch.setattr(episode, "Session", Watched)
        return Asked(plans, valid, run_trial(task))

    return watched


MOVING = generate("orbit", 3, 1, 2)[0].model_copy(update={"time_limit_s": 25.0})


@pytest.mark.parametrize("name", WHOLE_PATHS)
def test_the_papers_planners_are_asked_at_the_ends_of_their_paths(watch, name: str) -> None:
    asked = watch(task_of(name, MOVING))
    assert len(asked.plans) > 2
    assert not asked.valid
    times = sorted(asked.plans)
    for now_s, following_s in itertools.pairwise(times):
        path = asked.plans[now_s].times_s
        assert following_s == (path[-1] if len(path) else now_s + 1.0)


@pytest.mark.parametrize("name", STEPS)
def test_the_potential_field_is_asked_each_second(watch, name: str) -> None:
    asked = watch(task_of(name, MOVING))
    assert sorted(asked.plans) == list(range(asked.result.row["n_solves"]))
    assert len(asked.plans) == np.ceil(asked.result.times_s[-1])
    assert not asked.valid


@pytest.mark.parametrize("name", REPLANNED)
def test_whoever_replans_is_asked_when_the_rest_of_its_path_no_longer_holds_and_only_then(watch, name: str) -> None:
    asked = watch(task_of(name, MOVING, "velocity", noise_mm=2.0))
    seconds = range(int(np.ceil(asked.result.times_s[-1])))
    assert all(asked.valid.values()) is False
    assert sum(asked.valid.values()) > 0
    for now_s in seconds:
        assert (now_s in asked.plans) == (not asked.valid.get(now_s, False)), now_s
        has_path_ahead = any(now_s < plan.times_s[-1] for plan in asked.plans.values() if len(plan.times_s))
        assert now_s in asked.plans or has_path_ahead


@pytest.mark.parametrize(("names", "margin"), [(REPLANNED, 1.0), (("t3", "h", "pf"), 0.0)])
def test_obstacles_are_grown_by_the_margin_that_the_planner_asks_for(monkeypatch, names, margin: float) -> None:
    given = []
    update = SpaceTimeProblem.update
    monkeypatch.setattr(
        SpaceTimeProblem, "update", lambda problem, query, now_s: given.append(query) or update(problem, query, now_s)
    )
    for name in names:
        given.clear()
        task = task_of(name, MOVING, "kalman", noise_mm=3.0)
        session = Session(task.spec, MOVING, predictor="kalman", limits=False, seed=1)
        session.plan(MOVING.start, 0.0, Observer(task).until(0.0))
        (query,) = given
        bounds = query.prediction.bounds_m
        assert bounds.max() > 1e-3
        grown = np.minimum(bounds, LARGEST_M) * margin
        np.testing.assert_allclose(query.world.radii_m, query.prediction.radii_m + grown, err_msg=name)


def test_temporals_states_are_free_of_the_obstacles_where_they_are_at_that_second() -> None:
    """Fast obstacles, known in advance: a second early or late they are 10 cm away."""
    fast, states, near = generate("orbit[max_speed_m_s=0.1]", 6, 25, 1), 0, 0
    for scenario in fast:
        task = task_of("t3", scenario, "truth")
        session = Session(task.spec, scenario, predictor="truth", limits=False, seed=1)
        plan = session.plan(scenario.start, 0.0, Observer(task).until(0.0))
        for time_s, q in zip(plan.times_s[1:], plan.configurations_rad[1:], strict=True):
            assert clearance(scenario, q, time_s) > 0.0, (scenario.id, time_s)
            states += 1
            near += any(clearance(scenario, q, time_s + late) <= 0.0 for late in (-1.0, 1.0))
    assert states > 50
    assert near > 3  # a second sooner or later some of these very states would collide


def resting(point_m: np.ndarray, radius_m: float) -> Obstacle:
    return Obstacle(radius_m=radius_m, motion=Track(times_s=(0.0,), positions_m=(tuple(point_m.tolist()),)))


def half_way(scenario: Scenario) -> np.ndarray:
    """Configuration half way along the static cube path."""
    return free_run(scenario)[len(free_run(scenario)) // 2]


def free_run(scenario: Scenario) -> np.ndarray:
    return run_trial(task_of("hs", scenario)).configurations_rad


@pytest.mark.parametrize("number", range(3))
def test_on_a_blocked_path_h_finds_another_and_hs_waits(number: int) -> None:
    empty = generate("orbit", 0, 3, 5)[number].model_copy(update={"time_limit_s": 60.0})
    tip = empty.arm.tip(half_way(empty))
    blocked = empty.model_copy(update={"obstacles": (resting(tip, 0.02),)})
    purging, waiting = (run_trial(task_of(name, blocked)) for name in ("h", "hs"))
    assert purging.row["outcome"] == "reached"
    assert (np.ptp(np.diff(purging.configurations_rad, axis=0), axis=1) > 0).all()  # and never stands still
    assert waiting.row["outcome"] == "stuck"
    moved = np.flatnonzero(np.diff(waiting.configurations_rad, axis=0).any(axis=1))
    np.testing.assert_array_equal(moved, np.arange(len(moved)))  # until it waits for good
    assert 0 < len(moved) < len(free_run(empty)) // 2


def test_hs_goes_on_when_the_obstacle_has_left() -> None:
    empty = generate("orbit", 0, 3, 5)[1].model_copy(update={"time_limit_s": 90.0})
    tip = tuple(empty.arm.tip(half_way(empty)).tolist())
    leaves = Track(times_s=(0.0, 40.0, 45.0), positions_m=(tip, tip, (0.6, 0.6, 0.6)))
    row = run_trial(
        task_of("hs", empty.model_copy(update={"obstacles": (Obstacle(radius_m=0.02, motion=leaves),)}))
    ).row
    assert row["outcome"] == "reached"
    assert row["arrival_time_s"] > 41.0


@pytest.mark.parametrize("name", ["h", "hs"])
def test_a_cube_that_holds_an_obstacle_is_blocked_though_a_thin_arm_could_share_it(name: str) -> None:
    """The paper's rule is about the cube. The default arm is too thick to tell: where its rule binds, its body does."""
    thin = ContinuumArm(radius_m=0.002)
    for empty in generate("orbit", 0, 3, 5, thin):
        q = half_way(empty)
        cube = np.floor(thin.tip(q) / CUBE_M)
        corners = [(cube + 0.075 + 0.85 * np.array(corner)) * CUBE_M for corner in np.ndindex(2, 2, 2)]
        corner = max(corners, key=lambda point: np.linalg.norm(point - thin.tip(q)))
        shared = empty.model_copy(update={"obstacles": (resting(corner, 0.001),)})
        assert clearance(shared, q, 0.0) > 0.001
        tips = thin.tips(run_trial(task_of(name, shared)).configurations_rad)
        assert not (np.floor(tips / CUBE_M) == cube).all(axis=1).any()
