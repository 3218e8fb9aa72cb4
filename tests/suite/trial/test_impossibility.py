"""Rows of bounds that failed say why nobody can succeed."""

import numpy as np

from scenarios import Obstacle, Scenario, Track, generate
from scenarios.proofs import prove
from suite import run_trial
from suite.trial.impossibility import impossibility

NOTHING = {"impossible_reason": None, "impossible_from_s": None}


def run_over_the_base(at_s: float = 6.0) -> Scenario:
    """An obstacle that comes to the base; within 6 s no tip can have come a decimetre and a half."""
    scenario = generate("orbit", 0, 1, seed=1000)[0]
    track = Track(times_s=(-5.0, 0.0, at_s, 200.0), positions_m=((0.3, 0, -0.2), (0.3, 0, -0.2), (0, 0, 0), (0, 0, 0)))
    far = np.linalg.norm(np.subtract(scenario.goal_m, scenario.arm.tip(scenario.start)))
    assert far > 0.15
    return scenario.model_copy(update={"obstacles": (Obstacle(radius_m=0.02, motion=track),)})


def test_a_bound_that_fails_says_why_nobody_can() -> None:
    scenario = run_over_the_base()
    row = run_trial(scenario, "clairvoyant[restarts=1,branches=50]").row
    assert not row["success_executable"]
    assert row["impossible_reason"] == "base"
    assert 4.0 < row["impossible_from_s"] < 6.0


def test_other_planners_say_nothing_of_it() -> None:
    row = run_trial(run_over_the_base(), "pf").row
    assert not row["success_executable"]
    assert row["impossible_reason"] is row["impossible_from_s"] is None


def test_a_deadline_is_no_impossibility() -> None:
    scenario = run_over_the_base(at_s=100.0)
    assert prove(scenario).executable.outcome == "deadline"
    assert impossibility(scenario) == NOTHING
    assert impossibility(generate("orbit", 0, 1, seed=1000)[0]) == NOTHING
