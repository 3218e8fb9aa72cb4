"""The story of a trial, with a scripted planner in the session's place: when it is asked, and how a trial ends."""

from collections.abc import Callable

import numpy as np
import pytest
from fakes import fake_spec

from planners import Plan
from scenarios import ContinuumArm, Obstacle, Scenario, Track
from suite.trial import episode
from suite.trial.episode import STUCK_S, run_trial
from suite.trial.observation import Observer
from suite.trial.task import TrialTask

ARM = ContinuumArm(n_sections=1)
GOAL_U = 0.9
Answer = Callable[[np.ndarray, float], list[tuple[float, float]]]
"""From the configuration and the time now to (seconds from now, u) of a path's states after the first."""


class Script:
    """Stands in for a session: answers by a function, and remembers what it was asked."""

    def __init__(self, commitment: str, answer: Answer, *, valid: Callable[[float], bool] = lambda now_s: True) -> None:
        self.commitment, self._answer, self._valid = commitment, answer, valid
        self.asked_s: list[float] = []
        self.validated_s: list[float] = []
        self.rests: list[tuple[list[float], list[float]]] = []
        self.observations = []

    def __call__(self, *args: object, **options: object) -> "Script":
        return self

    def plan(self, q: np.ndarray, now_s: float, observation) -> Plan:
        self.asked_s.append(now_s)
        self.observations.append(observation)
        states = self._answer(q, now_s)
        times = np.array([now_s, *(now_s + after for after, _ in states)])
        path = np.array([q, *([u, 0.0] for _, u in states)])
        solves = len(self.asked_s)
        return Plan(
            "Exact solution", *((times, path) if states else (times[:0], path[:0])), 0.25 * 2**solves, solves, 10
        )

    def still_valid(self, times_s: np.ndarray, configurations_rad: np.ndarray, observation) -> bool:
        self.validated_s.append(float(times_s[0]))
        self.rests.append((times_s.tolist(), configurations_rad[:, 0].tolist()))
        self.observations.append(observation)
        return self._valid(float(times_s[0]))


def sphere(*track: tuple[float, tuple[float, float, float]], radius_m: float = 0.01) -> Obstacle:
    return Obstacle(
        radius_m=radius_m, motion=Track(times_s=tuple(t for t, _ in track), positions_m=tuple(p for _, p in track))
    )


def scene(*obstacles: Obstacle, time_limit_s: float = 20.0) -> Scenario:
    goal = tuple(ARM.tip([GOAL_U, 0.0]).tolist())
    return Scenario(id="s", arm=ARM, start_rad=(0, 0), goal_m=goal, obstacles=obstacles, time_limit_s=time_limit_s)


@pytest.fixture
def run(monkeypatch):
    def run_script(script: Script, scenario: Scenario | None = None, **others: float):
        monkeypatch.setattr(episode, "Session", script)
        task = TrialTask(scenario or scene(), fake_spec("x"), predictor="cubic", limits=False, seed=3, **others)
        return run_trial(task)

    return run_script


def wander(q: np.ndarray, now_s: float) -> list[tuple[float, float]]:
    """Three seconds to somewhere that is not the goal."""
    return [(1.0, -0.1), (2.0, -0.2), (3.0, -0.1 * (1 + now_s % 2))]


def arrive_after(seconds: float) -> Answer:
    return lambda q, now_s: [(seconds, GOAL_U)]


def hold(q: np.ndarray, now_s: float) -> list[tuple[float, float]]:
    return []


def test_a_planner_of_whole_paths_is_asked_at_their_ends_only(run) -> None:
    script = Script("path", wander)
    run(script, scene(time_limit_s=10.0))
    assert script.asked_s == [0.0, 3.0, 6.0, 9.0]
    assert script.validated_s == []


def test_a_planner_of_steps_is_asked_each_second(run) -> None:
    script = Script("step", wander)
    run(script, scene(time_limit_s=5.0))
    assert script.asked_s == [0.0, 1.0, 2.0, 3.0, 4.0]
    assert script.validated_s == []


def test_a_planner_that_replans_is_asked_at_a_paths_end_or_once_the_rest_is_invalid(run) -> None:
    script = Script("while_valid", wander, valid=lambda now_s: now_s not in (2.0, 4.0))
    run(script, scene(time_limit_s=9.0))
    assert script.asked_s == [0.0, 2.0, 4.0, 7.0]
    assert script.validated_s == [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0]
    times, us = script.rests[0]
    assert times == [1.0, 2.0, 3.0]  # the present state, then what is ahead
    assert us == [-0.1, -0.2, -0.1]


@pytest.mark.parametrize("commitment", ["path", "step", "while_valid"])
def test_without_a_path_every_planner_is_asked_again_a_second_later(run, commitment: str) -> None:
    script = Script(commitment, hold)
    run(script, scene(time_limit_s=4.0))
    assert script.asked_s == [0.0, 1.0, 2.0, 3.0]
    assert script.validated_s == []


def test_a_path_that_ends_between_two_seconds_is_waited_out_until_the_next(run) -> None:
    script = Script("path", lambda q, now_s: [(1.5, -0.2)])
    run(script, scene(time_limit_s=4.0))
    assert script.asked_s == [0.0, 2.0]


def test_whoever_is_asked_is_told_what_was_seen_until_then(run) -> None:
    scenario = scene(sphere((0.0, (0.5, 0.0, 0.0)), (9.0, (0.9, 0.0, 0.0))), time_limit_s=5.0)
    script = Script("while_valid", wander)
    run(script, scenario, noise_mm=2.0, dropout=0.2)
    task = TrialTask(scenario, fake_spec("y"), predictor="cubic", limits=False, seed=3, noise_mm=2.0, dropout=0.2)
    assert len(script.observations) == 5
    for second, told in enumerate(script.observations):
        expected = Observer(task).until(float(second))
        for ours, theirs in zip(told, expected, strict=True):
            np.testing.assert_array_equal(ours, theirs)


def test_planning_time_and_checks_are_sums_over_all_solves(run) -> None:
    row = run(Script("step", hold), scene(time_limit_s=4.0)).row
    assert row["n_solves"] == 4
    assert row["planning_time_s"] == 0.5 + 1.0 + 2.0 + 4.0
    assert row["solve_max_s"] == 4.0
    assert row["solve_p50_s"] == 1.5
    assert row["solve_p95_s"] == pytest.approx(np.percentile([0.5, 1.0, 2.0, 4.0], 95))
    assert (row["state_checks"], row["motion_checks"]) == (1 + 2 + 3 + 4, 40)


def test_arrival_ends_a_trial_where_it_happens(run) -> None:
    result = run(Script("path", arrive_after(2.5)))
    assert (result.row["outcome"], result.row["arrival_time_s"]) == ("reached", 2.5)
    assert result.times_s.tolist() == [0.0, 1.0, 2.0, 2.5]
    assert (result.row["success_per_step"], result.row["success_swept"]) == (True, True)
    assert result.row["violation_executable_kind"] == "tip speed"
    assert run(Script("path", arrive_after(8.0))).row["success_executable"] is True


def test_close_to_the_tolerance_is_not_within_it(run) -> None:
    """Its states come within two tolerances of the goal, not within one."""
    tolerance_m = scene().goal_tolerance_m
    near = next(u for u in np.linspace(0, GOAL_U, 1000) if away_m(u) < 1.5 * tolerance_m)
    row = run(Script("path", lambda q, now_s: [(1.0, near)]), scene(time_limit_s=3.0)).row
    assert tolerance_m < away_m(near)
    assert row["outcome"] == "timeout"
    assert row["arrival_time_s"] is None


def away_m(u: float) -> float:
    return float(np.linalg.norm(ARM.tip([u, 0.0]) - scene().goal))


def test_an_arm_that_begins_at_its_goal_is_never_asked(run) -> None:
    script = Script("path", hold)
    row = run(script, scene().model_copy(update={"start_rad": (GOAL_U, 0.0)})).row
    assert (row["outcome"], row["arrival_time_s"], row["n_solves"]) == ("reached", 0.0, 0)
    assert (row["planning_time_s"], row["solve_max_s"]) == (0.0, None)
    assert script.asked_s == []


def at_goal(first_s: float, until_s: float) -> Obstacle:
    """Far away, but at the goal from ``first_s`` until ``until_s``."""
    there, away = tuple(scene().goal_m), (0.6, 0.6, 0.0)
    return sphere((first_s - 0.01, away), (first_s, there), (until_s, there), (until_s + 0.01, away))


def test_an_arrival_in_contact_is_no_success_whatever_the_planner_says(run) -> None:
    row = run(Script("path", arrive_after(2.0)), scene(at_goal(1.9, 3.0))).row
    assert row["arrival_time_s"] == 2.0
    assert row["outcome"] == "collided"
    assert row["success_per_step"] is False
    assert (row["violation_per_step_time_s"], row["violation_per_step_kind"]) == (2.0, "collision")


def test_an_arrival_in_contact_between_two_seconds_is_seen_by_swept_alone(run) -> None:
    row = run(Script("path", arrive_after(2.5)), scene(at_goal(2.4, 2.6))).row
    assert (row["outcome"], row["success_per_step"], row["success_swept"]) == ("reached", True, False)
    assert row["min_clearance_m"] < 0


def at_the_base(first_s: float, until_s: float) -> Obstacle:
    there, away = (0.0, 0.0, 0.01), (0.6, 0.6, 0.0)
    return sphere((first_s - 0.01, away), (first_s, there), (until_s, there), (until_s + 0.01, away))


def test_a_collision_at_a_whole_second_ends_a_trial(run) -> None:
    result = run(Script("path", arrive_after(6.0)), scene(at_the_base(2.9, 3.1)))
    assert result.row["outcome"] == "collided"
    assert result.times_s[-1] == 3.0
    assert result.row["violation_per_step_time_s"] == 3.0


def test_a_collision_between_two_seconds_ends_nothing_but_is_known(run) -> None:
    row = run(Script("path", arrive_after(6.0)), scene(at_the_base(2.4, 2.6))).row
    assert (row["outcome"], row["success_per_step"], row["success_swept"]) == ("reached", True, False)
    assert 2.3 < row["violation_swept_time_s"] <= 2.4


def test_time_runs_out_on_an_arm_that_moves_or_is_stuck(run) -> None:
    restless = Script("path", lambda q, now_s: [(1.0, -0.1 * (now_s % 2 + 1))])
    assert run(restless, scene(time_limit_s=15.0)).row["outcome"] == "timeout"
    assert run(Script("path", hold), scene(time_limit_s=15.0)).row["outcome"] == "stuck"
    for moves_until_s, outcome in [(15.0 - STUCK_S + 1, "timeout"), (15.0 - STUCK_S, "stuck")]:

        def stops(q: np.ndarray, now_s: float, until_s: float = moves_until_s) -> list[tuple[float, float]]:
            return [(1.0, q[0] - 0.05)] if now_s < until_s else []

        assert run(Script("path", stops), scene(time_limit_s=15.0)).row["outcome"] == outcome


def test_an_arrival_after_time_has_run_out_is_a_timeout_not_a_collision(run) -> None:
    row = run(Script("path", arrive_after(4.9)), scene(time_limit_s=4.5)).row
    assert (row["outcome"], row["violation_per_step_kind"]) == ("timeout", "time limit")


def test_a_path_from_elsewhere_is_the_planners_error(run, monkeypatch) -> None:
    script = Script("path", wander)
    told = script.plan
    monkeypatch.setattr(
        script, "plan", lambda q, now_s, seen: told(q, now_s, seen)._replace(times_s=np.arange(4.0) + now_s + 1)
    )
    row = run(script).row
    assert row["outcome"] == "planner_error"
    assert "increase strictly from now" in row["message"]
    assert row["success_per_step"] is False


def test_a_start_that_is_hit_while_observing_is_nobodys_failure(run) -> None:
    script = Script("path", wander)
    hit_before = sphere((-3.0, (0.0, 0.0, 0.1)), (-1.0, (0.6, 0.6, 0.0)))
    assert run(script, scene(hit_before)).row["outcome"] == "invalid_scenario"
    assert script.asked_s == []
