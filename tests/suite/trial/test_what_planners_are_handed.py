import numpy as np
import pytest
from fakes import fake_spec

from planners import Plan
from scenarios import ContinuumArm, Obstacle, Scenario, Track
from suite.trial import episode
from suite.trial.task import TrialTask

ARM = ContinuumArm(n_sections=1)


def crossing_sphere() -> Obstacle:
    """Touches the unbent arm between 2 and 3 s, in passing."""
    return Obstacle(radius_m=0.02, motion=Track(times_s=(2.0, 3.0), positions_m=((0.3, 0.0, 0.1), (-0.3, 0.0, 0.1))))


def scenario() -> Scenario:
    far = Obstacle(radius_m=0.02, motion=Track(times_s=(0.0,), positions_m=((1.0, 1.0, 1.0),)))
    goal = tuple(ARM.tip([1.0, 0.0]).tolist())
    obstacles = (far, crossing_sphere())
    return Scenario(id="crossing", arm=ARM, start_rad=(0.0, 0.0), goal_m=goal, obstacles=obstacles, time_limit_s=5.0)


class Still:
    """A session that never finds a path."""

    commitment = "step"

    def __init__(self, spec: object, scenario: Scenario, **conditions: object) -> None:
        self.scenario = scenario

    def plan(self, q: object, now_s: float, observation: object) -> Plan:
        return Plan("no path", np.empty(0), np.empty((0, 2)), 0.0, 0, 0)


class Thinning(Still):
    """Changes the arm, the goal and the obstacles that it was handed."""

    def __init__(self, spec: object, scenario: Scenario, **conditions: object) -> None:
        super().__init__(spec, scenario)
        vars(scenario.arm)["radius_m"] = 1e-6
        vars(scenario)["goal_tolerance_m"] = 10.0
        for obstacle in scenario.obstacles:
            vars(obstacle)["radius_m"] = 1e-6


class Bending(Still):
    """Bends on and on, away from the goal."""

    def plan(self, q: np.ndarray, now_s: float, observation: object) -> Plan:
        return Plan("path", np.array([now_s, now_s + 1.0]), np.stack([q, q - [0.01, 0.0]]), 0.0, 0, 0)


def task() -> TrialTask:
    return TrialTask(scenario(), fake_spec("any"), predictor="cubic", limits=False, seed=0)


@pytest.mark.parametrize("session", [Still, Thinning, Bending])
def test_the_audit_believes_no_planner(session: type, monkeypatch) -> None:
    monkeypatch.setattr(episode, "Session", session)
    asked = task()
    row = episode.run_trial(asked).row
    assert (row["outcome"], row["success_swept"]) == ("stuck" if session is not Bending else "timeout", False)
    assert row["violation_swept_kind"] == "collision"
    assert 2.0 < row["violation_swept_time_s"] < 3.0
    assert (row["contact_obstacle"], row["contact_section"]) == (2, 1)
    assert row["contact_while"] == ("moving" if session is Bending else "holding")
    assert asked.scenario == scenario()  # nor does the next planner get what this one has made of it
