"""The paper's scenarios: every number inside its range, and spread over it."""

import numpy as np
import pytest
from scipy.stats import kstest

from scenarios import ContinuumArm, Scenario, generate

TRIALS = 80


@pytest.fixture(scope="module")
def drawn() -> list[Scenario]:
    return generate("orbit", 5, TRIALS, 0)


def test_ids_name_the_draw(drawn: list[Scenario]) -> None:
    assert drawn[7].id == "orbit-n5-s0-0007"
    assert len({s.id for s in drawn}) == TRIALS
    assert {(s.family, s.seed, s.parameters["n_obstacles"]) for s in drawn} == {("orbit", 0, 5)}
    assert drawn[0].parameters["max_speed_m_s"] == 0.015


def test_draws_do_not_change_from_one_version_to_the_next(drawn: list[Scenario]) -> None:
    for k, goal, plane, phase in [
        (0, (0.125, -0.255, 0.065), (-2.1806888727600287, 0.6429683060603845), 6.020726464766168),
        (79, (0.065, 0.005, -0.045), (1.7577215022420505, 2.59669575577977), 0.6008574192316749),
    ]:
        assert drawn[k].goal_m == pytest.approx(goal)
        assert drawn[k].start_rad[:2] == pytest.approx(plane)
        assert drawn[k].obstacles[4].motion.phase_rad == pytest.approx(phase)


def test_everything_is_inside_the_papers_ranges(drawn: list[Scenario]) -> None:
    for scenario in drawn:
        tip, goal = scenario.arm.tip(scenario.start), scenario.goal
        assert 0.15 <= np.linalg.norm(goal - tip) <= 0.60
        np.testing.assert_allclose(goal / 0.01 % 1, 0.5, atol=1e-9)
        assert len(scenario.obstacles) == 5
        for obstacle in scenario.obstacles:
            orbit = obstacle.motion
            assert obstacle.radius_m in (0.02, 0.03)
            assert 0.06 <= orbit.radius_m <= 0.15
            assert orbit.speed_bound_m_s <= 0.015 * (1 + 1e-12)
            share = (np.asarray(orbit.center_m) - tip) @ (goal - tip) / np.sum((goal - tip) ** 2)
            assert 0 <= share <= 1
            np.testing.assert_allclose(tip + share * (goal - tip), orbit.center_m, atol=1e-12)


def test_what_is_drawn_is_uniform(drawn: list[Scenario]) -> None:
    orbits = [obstacle.motion for scenario in drawn for obstacle in scenario.obstacles]
    normals = np.array([orbit.normal for orbit in orbits])
    starts = np.array([scenario.start_rad for scenario in drawn]).reshape(-1, 2)
    samples = {
        "speed": np.array([orbit.speed_bound_m_s for orbit in orbits]) / 0.015,
        "phase": np.array([orbit.phase_rad for orbit in orbits]) / (2 * np.pi),
        "height of the normal": (normals[:, 2] + 1) / 2,
        "bearing of the normal": np.arctan2(normals[:, 1], normals[:, 0]) / (2 * np.pi) + 0.5,
        "plane of a start's bend": np.arctan2(starts[:, 1], starts[:, 0]) / (2 * np.pi) + 0.5,
    }
    # Not the orbit's radius, nor the amount of bend: a hit start is likelier at some than at others.
    for name, sample in samples.items():
        assert kstest(sample, "uniform").pvalue > 0.01, name
    assert 0.4 < np.mean([orbit.rate_rad_s > 0 for orbit in orbits]) < 0.6
    assert 0.4 < np.mean([o.radius_m == 0.02 for scenario in drawn for o in scenario.obstacles]) < 0.6


def test_other_arms_and_settings() -> None:
    arm = ContinuumArm(n_sections=2, section_length_m=0.2)
    (scenario,) = generate("orbit[min_distance_m=0.3,max_speed_m_s=0]", 2, 1, 3, arm)
    assert scenario.arm == arm
    assert len(scenario.start_rad) == 4
    assert np.linalg.norm(scenario.goal - arm.tip(scenario.start)) >= 0.3
    assert all(obstacle.motion.speed_bound_m_s == 0 for obstacle in scenario.obstacles)
    assert generate("orbit", 0, 1, 3)[0].obstacles == ()
