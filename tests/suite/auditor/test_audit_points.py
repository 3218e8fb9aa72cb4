import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scenarios import Box, Obstacle, Scenario, Still, Track, generate, save_scenarios
from scenarios.families.base import random_configuration
from suite.auditor import audit
from suite.auditor.points import audit_points
from suite.cli.main import main

SCENARIOS = generate("orbit", 3, 12, 1000)


def motion_in(scenario: Scenario, seed: int, length: int = 12) -> tuple[np.ndarray, np.ndarray]:
    """A way from the start to somewhere, in frames of half a second."""
    goal = random_configuration(np.random.default_rng(seed), scenario.arm)
    shares = np.linspace(0.0, 1.0, length)[:, None]
    return 0.5 * np.arange(float(length)), (1.0 - shares) * scenario.start + shares * goal


def points_of(scenario: Scenario, states: np.ndarray) -> np.ndarray:
    return np.array([scenario.arm.backbone_points(q, 20) for q in states])


def slow_clearance(scenario: Scenario, times: np.ndarray, points: np.ndarray, radius: float, until: float) -> float:
    """By many samples of time, and of the backbone between its points."""
    smallest = np.inf
    for t in np.linspace(times[0], until, 200):
        now = np.array([[np.interp(t, times, points[:, n, axis]) for axis in range(3)] for n in range(points.shape[1])])
        dense = np.concatenate([now[:-1] + share * np.diff(now, axis=0) for share in np.linspace(0, 1, 6)])
        for obstacle in scenario.obstacles:
            apart = np.linalg.norm(dense - obstacle.position(np.array([t])), axis=1).min()
            smallest = min(smallest, apart - radius - obstacle.radius_m)
    return smallest


@settings(max_examples=4, deadline=None)
@given(st.integers(0, 11), st.integers(0, 1000))
def test_a_free_motion_is_free_at_every_sample_and_the_clearance_is_near(index: int, seed: int) -> None:
    scenario = SCENARIOS[index]
    times, states = motion_in(scenario, seed)
    points = points_of(scenario, states)
    found = audit_points(scenario, times, points, 0.018)
    until = found.end_time_s if np.isnan(found.swept.violation_time_s) else found.swept.violation_time_s
    slow = slow_clearance(scenario, times, points, 0.018, until)
    if found.contact_obstacle is None:
        assert slow > 0.7 * found.min_clearance_m > 0.0
    assert slow == pytest.approx(found.min_clearance_m, rel=0.35, abs=1.5e-3)


@pytest.mark.parametrize("index", range(6))
def test_it_says_what_the_audit_of_bending_vectors_says(index: int) -> None:
    """But for the bow of arcs over the chords between points, and where both graze."""
    scenario = SCENARIOS[index]
    times, states = motion_in(scenario, index)
    by_bends, by_points = (
        audit(scenario, times, states),
        audit_points(scenario, times, points_of(scenario, states), 0.018),
    )
    assert by_points.arrival_time_s == pytest.approx(by_bends.arrival_time_s, nan_ok=True)
    if abs(by_bends.min_clearance_m) > 3e-3:
        assert (by_points.contact_obstacle is None) == (by_bends.contact is None)
        assert by_points.per_step.violation_kind == by_bends.per_step.violation_kind
    if by_bends.contact is not None and by_points.contact_obstacle is not None:
        assert by_points.swept.violation_time_s == pytest.approx(by_bends.swept.violation_time_s, abs=0.2)
        assert by_points.contact_obstacle == by_bends.contact.obstacle


def scenario_with(obstacle: Obstacle) -> Scenario:
    return Scenario(id="one", start_rad=(0.0,) * 6, goal_m=(0.4, 0.0, 0.0), obstacles=(obstacle,))


STRAIGHT = np.linspace([0, 0, 0], [0, 0, 0.45], 10)


def test_what_flies_through_between_frames_is_seen() -> None:
    fast = Track(times_s=(1.4, 1.6), positions_m=((-1.0, 0.0, 0.2), (1.0, 0.0, 0.2)))
    found = audit_points(
        scenario_with(Obstacle(radius_m=0.01, motion=fast)), np.array([0.0, 3.0]), np.stack([STRAIGHT] * 2), 0.018
    )
    assert found.swept.violation_kind == "collision"
    assert 1.49 < found.swept.violation_time_s < 1.5
    assert found.per_step.violation_kind == "short of goal"
    assert (found.contact_obstacle, found.contact_segment) == (1, 4)


def test_shapes_are_the_spheres_that_hold_them() -> None:
    box = Obstacle(shape=Box(size_m=(0.02, 0.02, 0.02)), motion=Still(point_m=(0.1, 0.0, 0.2)))
    found = audit_points(scenario_with(box), np.array([0.0, 3.0]), np.stack([STRAIGHT] * 2), 0.018)
    assert found.min_clearance_m == pytest.approx(0.1 - 0.018 - 0.01 * 3**0.5)


@pytest.mark.parametrize(
    ("times", "points", "kind"),
    [
        ([0.0, 1.0], np.stack([STRAIGHT, STRAIGHT * np.nan]), "not finite"),
        ([0.0, 0.0], np.stack([STRAIGHT] * 2), "backward time"),
        ([1.0, 2.0], np.stack([STRAIGHT] * 2), "wrong start"),
        ([0.0, 2.0], np.stack([STRAIGHT + 0.1] * 2), "wrong start"),
        ([0.0, 200.0], np.stack([STRAIGHT] * 2), "time limit"),
        ([0.0, 2.0], np.stack([STRAIGHT] * 2), "short of goal"),
    ],
)
def test_lies_are_violations(times: list[float], points: np.ndarray, kind: str) -> None:
    scenario = scenario_with(Obstacle(radius_m=0.01, motion=Still(point_m=(1.0, 1.0, 1.0))))
    found = audit_points(scenario, np.array(times), points, 0.018)
    assert found.swept.violation_kind == found.per_step.violation_kind == kind


def test_the_command_line(tmp_path, monkeypatch, capfd) -> None:
    monkeypatch.chdir(tmp_path)
    scenario = scenario_with(Obstacle(radius_m=0.02, motion=Still(point_m=(0.0, 0.0, 0.5))))
    save_scenarios("one.json", [scenario])
    save_scenarios("many.jsonl", SCENARIOS)
    np.savez("motion.npz", time_s=[0, 1], points_m=np.stack([STRAIGHT] * 2), radius_m=0.018)
    assert main(["audit", "one.json", "--points", "motion.npz"]) == 0
    assert "per step short of goal at 1.000 s" in capfd.readouterr().out
    assert main(["audit", "one.json", "--points", "motion.npz", "--format", "json", "--strict"]) == 1
    said = json.loads(capfd.readouterr().out)
    assert said["min_clearance_m"] == pytest.approx(0.012)
    assert said["contact_obstacle"] is None
    for arguments in ("many.jsonl", "one.json --scenario two", "one.json many.jsonl"):
        assert main(["audit", *arguments.split(), "--points", "motion.npz"]) == 2


BAD = {
    "text": lambda file: Path(file).write_text("time_s"),
    "one missing": lambda file: np.savez(file, time_s=[0.0], radius_m=0.1),
    "objects": lambda file: np.savez(file, time_s=np.array([None]), points_m=np.zeros((1, 2, 3)), radius_m=0.1),
    "words": lambda file: np.savez(file, time_s=np.array(["a"]), points_m=np.zeros((1, 2, 3)), radius_m=0.1),
    "shapes": lambda file: np.savez(file, time_s=np.zeros(2), points_m=np.zeros((1, 2, 3)), radius_m=0.1),
    "one point": lambda file: np.savez(file, time_s=np.zeros(1), points_m=np.zeros((1, 1, 3)), radius_m=0.1),
    "no radius": lambda file: np.savez(file, time_s=np.zeros(1), points_m=np.zeros((1, 2, 3)), radius_m=0.0),
    "nothing": lambda file: np.savez(file, time_s=np.zeros(0), points_m=np.zeros((0, 2, 3)), radius_m=0.1),
}


@pytest.mark.parametrize("write", BAD.values(), ids=BAD)
def test_a_bad_file_is_one_line(write, tmp_path, monkeypatch, capfd) -> None:
    monkeypatch.chdir(tmp_path)
    save_scenarios("one.json", SCENARIOS[:1])
    write("bad.npz")
    assert main(["audit", "one.json", "--points", "bad.npz"]) == 2
    out, err = capfd.readouterr()
    assert (out, err.count("\n")) == ("", 1)
