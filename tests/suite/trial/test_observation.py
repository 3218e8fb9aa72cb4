"""What planners are told: once per step, with the noise and the losses that were asked for, and all the same."""

from dataclasses import replace

import numpy as np
import pytest
from fakes import fake_spec

from scenarios import Line, Obstacle, Orbit, Scenario
from suite.trial.observation import Observer
from suite.trial.task import TrialTask

OBSTACLES = (
    Obstacle(radius_m=0.02, motion=Line(point_m=(0.3, 0.0, 0.1), velocity_m_s=(0.0, 0.01, 0.0))),
    Obstacle(
        radius_m=0.03,
        motion=Orbit(center_m=(-0.3, 0.1, 0.2), radius_m=0.1, normal=(0, 1, 1), rate_rad_s=0.1, phase_rad=0.4),
    ),
)
SCENARIO = Scenario(id="two", start_rad=(0,) * 6, goal_m=(0.2, 0.1, 0.3), obstacles=OBSTACLES)
LONG = SCENARIO.model_copy(update={"id": "long", "time_limit_s": 3600.0, "obstacles": OBSTACLES * 5})


def task_of(scenario: Scenario = SCENARIO, label: str = "a", seed: int = 0, **others: float) -> TrialTask:
    return TrialTask(scenario, fake_spec(label), predictor="cubic", limits=False, seed=seed, **others)


def all_seen(task: TrialTask) -> np.ndarray:
    return Observer(task).until(task.scenario.time_limit_s).positions_m


def truth(scenario: Scenario, times: np.ndarray) -> np.ndarray:
    return np.stack([obstacle.position(times) for obstacle in scenario.obstacles], axis=1)


@pytest.mark.parametrize(("now_s", "last"), [(0.0, 0.0), (0.5, 0.0), (1.0, 1.0), (7.9, 7.0), (120.0, 120.0)])
def test_the_obstacles_are_seen_once_per_step_and_never_ahead(now_s: float, last: float) -> None:
    seen = Observer(task_of()).until(now_s)
    np.testing.assert_array_equal(seen.times_s, np.arange(-5.0, last + 0.5))
    np.testing.assert_array_equal(seen.positions_m, truth(SCENARIO, seen.times_s))
    np.testing.assert_array_equal(seen.radii_m, [0.02, 0.03])


def test_observation_begins_as_long_before_zero_as_the_scenario_says() -> None:
    seen = Observer(task_of(SCENARIO.model_copy(update={"observation_s": 9.0}))).until(0.0)
    np.testing.assert_array_equal(seen.times_s, np.arange(-9.0, 0.5))


def test_what_was_seen_stays_as_it_was_seen() -> None:
    observer = Observer(task_of(noise_mm=3.0, dropout=0.3))
    whole = observer.until(30.0)
    for now_s in (0.0, 4.0, 29.0):
        part = observer.until(now_s)
        np.testing.assert_array_equal(part.positions_m, whole.positions_m[: len(part.times_s)])


@pytest.mark.parametrize("noise_mm", [0.5, 2.0])
def test_noise_is_as_large_as_asked_for_in_every_direction(noise_mm: float) -> None:
    task = task_of(LONG, noise_mm=noise_mm)
    errors = 1000.0 * (all_seen(task) - truth(LONG, np.arange(-5.0, 3600.5)))
    assert errors.shape == (3606, 10, 3)
    assert errors.std(axis=(0, 1)) == pytest.approx([noise_mm] * 3, rel=0.03)
    assert np.abs(errors.mean(axis=(0, 1))).max() < 0.03 * noise_mm
    steps = errors[1:, :, 0] * errors[:-1, :, 0]
    assert abs(steps.mean()) < 0.03 * noise_mm**2  # and says nothing about the next


def test_every_planner_of_an_experiment_is_told_the_same() -> None:
    told = [all_seen(task_of(label=label, noise_mm=2.0, dropout=0.2)) for label in ("pf", "rrt[range=3]")]
    np.testing.assert_array_equal(*told)


@pytest.mark.parametrize("other", [{"seed": 1}, {"scenario": SCENARIO.model_copy(update={"id": "three"})}])
def test_another_seed_or_scenario_draws_anew(other: dict[str, object]) -> None:
    task = task_of(noise_mm=2.0)
    assert not (all_seen(task) == all_seen(replace(task, **other))).any()


def test_losses_are_as_frequent_as_asked_for_and_whole() -> None:
    seen = all_seen(task_of(LONG, dropout=0.3))
    lost = np.isnan(seen)
    assert lost.mean() == pytest.approx(0.3, abs=0.01)
    np.testing.assert_array_equal(lost.any(axis=2), lost.all(axis=2))
    assert lost[:, 0, 0].mean() == pytest.approx(0.3, abs=0.03)  # each obstacle by itself
    assert (lost[:, 0, 0] != lost[:, 1, 0]).any()


def test_the_first_observation_is_never_lost() -> None:
    for seed in range(50):
        seen = Observer(task_of(seed=seed, dropout=0.99)).until(0.0)
        assert np.isfinite(seen.positions_m[0]).all()
        assert np.isnan(seen.positions_m[1:]).any()


def test_nothing_is_lost_or_blurred_unless_asked_for() -> None:
    assert np.isfinite(all_seen(task_of(noise_mm=5.0))).all()
    kept = all_seen(task_of(dropout=0.5))
    there = np.isfinite(kept)
    np.testing.assert_array_equal(kept[there], truth(SCENARIO, np.arange(-5.0, 120.5))[there])


def test_noise_grows_but_does_not_change_with_its_size_and_losses_leave_it_alone() -> None:
    one, two, lossy = (all_seen(task_of(noise_mm=n, dropout=d)) for n, d in ((1.0, 0.0), (2.0, 0.0), (1.0, 0.4)))
    exact = all_seen(task_of())
    np.testing.assert_allclose(two - exact, 2.0 * (one - exact), atol=1e-12)
    there = np.isfinite(lossy)
    np.testing.assert_array_equal(lossy[there], one[there])
