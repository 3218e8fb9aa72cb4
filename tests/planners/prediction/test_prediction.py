"""Predictors: the paper's against SciPy itself, the truth against the truth, and what all of them promise."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import CubicSpline
from strategies import seeds

from planners import PREDICTORS, Observation, build_predictor
from planners.prediction.cubic import CubicPredictor
from planners.prediction.observation import without_gaps
from scenarios import Obstacle, Scenario, SpecError, Track, generate

SCENARIO = generate("orbit", 3, 1, 0)[0]


def observe(scenario: Scenario, now_s: float = 0.0) -> Observation:
    times = np.arange(-scenario.observation_s, now_s + 0.5)
    positions = np.empty((len(times), len(scenario.obstacles), 3))
    for j, obstacle in enumerate(scenario.obstacles):
        positions[:, j] = obstacle.position(times)
    return Observation(times, positions, np.array([o.radius_m for o in scenario.obstacles]))


def noisy(seed: int, count: int, n_obstacles: int) -> Observation:
    rng = np.random.default_rng(seed)
    positions = np.cumsum(rng.normal(scale=0.01, size=(count, n_obstacles, 3)), axis=0)
    return Observation(np.arange(count) + 7.0, positions, np.full(n_obstacles, 0.02))


@given(seeds, st.integers(5, 9), st.integers(0, 3))
def test_cubic_is_the_spline_through_the_last_five_observations(seed: int, count: int, n_obstacles: int) -> None:
    seen = noisy(seed, count, n_obstacles)
    times = seen.times_s[-1] + np.linspace(0, 12, 25)
    expected = np.empty((25, n_obstacles, 3))
    for j in range(n_obstacles):
        expected[:, j] = CubicSpline(seen.times_s[-5:], seen.positions_m[-5:, j], bc_type="not-a-knot")(times)
    np.testing.assert_allclose(CubicPredictor().positions(seen, times), expected, atol=1e-8)


def test_cubic_extrapolates_a_cubic_exactly() -> None:
    times = np.arange(5.0)
    law = np.polynomial.Polynomial([0.1, -0.02, 0.003, 0.0004])
    seen = Observation(times, np.repeat(law(times)[:, None, None], 3, axis=2), np.array([0.02]))
    ahead = np.arange(4.0, 10.0)
    np.testing.assert_allclose(CubicPredictor().positions(seen, ahead)[:, 0, 1], law(ahead), atol=1e-12)


def test_cubic_on_the_papers_orbits() -> None:
    # Millimetres for three seconds, which is the paper's T3; centimetres by the sixth.
    errors = []
    for scenario in generate("orbit", 6, 20, 5):
        ahead = np.arange(1.0, 7.0)
        for j, obstacle in enumerate(scenario.obstacles):
            error = CubicPredictor().positions(observe(scenario), ahead)[:, j] - obstacle.position(ahead)
            errors.append(np.linalg.norm(error, axis=1))
    worst, usual = np.max(errors, axis=0), np.percentile(errors, 95, axis=0)
    assert worst[2] < 0.003
    assert usual[4] < 0.005
    assert worst[5] > 0.01


def test_past_its_reach_an_obstacle_rests_where_it_then_is() -> None:
    seen = observe(SCENARIO)
    prediction = CubicPredictor().predict(seen, 60.0, 0.25)
    assert prediction.start_s == 0.0
    assert (len(prediction.centers_m) - 1) * 0.25 == CubicPredictor.reach_s
    world = prediction.world(0.0)
    np.testing.assert_array_equal(world.centers_m, prediction.centers_m)
    np.testing.assert_allclose(
        prediction.centers_m[-1], CubicPredictor().positions(seen, np.array([CubicPredictor.reach_s]))[0]
    )


@pytest.mark.parametrize(("horizon", "step", "samples"), [(3.0, 1.0, 4), (1.0, 1.0, 2), (0.4, 1.0, 2), (2.0, 0.25, 9)])
def test_a_prediction_covers_the_horizon(horizon: float, step: float, samples: int) -> None:
    for name in PREDICTORS:
        prediction = build_predictor(name, SCENARIO).predict(observe(SCENARIO), horizon, step)
        assert len(prediction.centers_m) == samples
        assert prediction.step_s == step


def test_gaps_are_filled_straight_and_the_end_at_the_last_velocity() -> None:
    lost = np.nan
    track = np.array([lost, 1.0, lost, lost, 7.0, 8.0, lost, lost])
    positions = np.stack([track, 2 * track, -track], axis=1)[:, None]
    filled = without_gaps(Observation(np.arange(8.0), positions, np.array([0.02]))).positions_m[:, 0, 0]
    assert filled.tolist() == [1, 1, 3, 5, 7, 8, 9, 10]
    alone = np.full((5, 1, 3), lost)
    alone[1] = 0.3
    assert (without_gaps(Observation(np.arange(5.0), alone, np.array([0.02]))).positions_m == 0.3).all()
    whole = noisy(0, 6, 2)
    assert without_gaps(whole) is whole


def test_a_lost_observation_of_one_obstacle_leaves_the_others_alone() -> None:
    seen = noisy(1, 6, 3)
    with_loss = seen._replace(positions_m=seen.positions_m.copy())
    with_loss.positions_m[3, 1] = np.nan
    ahead = seen.times_s[-1] + np.arange(4.0)
    for name in PREDICTORS:
        predictor = build_predictor(name, SCENARIO)
        before, after = predictor.positions(seen, ahead), predictor.positions(with_loss, ahead)
        np.testing.assert_allclose(after[:, [0, 2]], before[:, [0, 2]], atol=1e-12)


def test_truth_is_the_true_motion_and_certain() -> None:
    prediction = build_predictor("truth", SCENARIO).predict(observe(SCENARIO, 3.0), 20.0, 0.25)
    times = 3.0 + 0.25 * np.arange(81)
    for j, obstacle in enumerate(SCENARIO.obstacles):
        np.testing.assert_array_equal(prediction.centers_m[:, j], obstacle.position(times))
    assert (prediction.bounds_m == 0).all()
    np.testing.assert_array_equal(prediction.world(2.0).radii_m, np.broadcast_to(prediction.radii_m, (81, 3)))


@pytest.mark.parametrize("name", PREDICTORS)
@settings(max_examples=20)
@given(seed=seeds, count=st.integers(5, 20), n_obstacles=st.integers(0, 3), loss=st.sampled_from([0.0, 0.5]))
def test_what_every_predictor_promises(name: str, seed: int, count: int, n_obstacles: int, loss: float) -> None:
    if PREDICTORS[name].is_oracle:
        return
    seen = noisy(seed, count, n_obstacles)
    lost = np.random.default_rng(seed).uniform(size=(count, n_obstacles)) < loss
    lost[0] = False  # every obstacle is seen once
    seen.positions_m[lost] = np.nan
    copy = Observation(*(array.copy() for array in seen))
    predictor = build_predictor(name, SCENARIO)
    ahead = seen.times_s[-1] + np.arange(0.0, 6.0, 0.5)
    forecast = predictor.forecast(seen, ahead)
    assert forecast.centers_m.shape == (12, n_obstacles, 3)
    assert forecast.bounds_m.shape == (12, n_obstacles)
    assert np.isfinite(forecast.centers_m).all()
    assert (forecast.bounds_m >= 0).all()
    for given_array, before in zip(seen, copy, strict=True):
        np.testing.assert_array_equal(given_array, before)
    # It depends on the observation alone: another one between two questions changes nothing.
    predictor.forecast(noisy(seed + 1, 8, 2), np.array([15.0]))
    np.testing.assert_array_equal(predictor.forecast(seen, ahead).centers_m, forecast.centers_m)
    np.testing.assert_array_equal(build_predictor(name, SCENARIO).forecast(seen, ahead).centers_m, forecast.centers_m)


@pytest.mark.parametrize("name", [name for name, entry in PREDICTORS.items() if not entry.is_oracle])
def test_only_an_oracle_knows_the_scenario(name: str) -> None:
    resting = tuple(
        Obstacle(radius_m=o.radius_m, motion=Track(times_s=(0,), positions_m=((9, 9, 9),))) for o in SCENARIO.obstacles
    )
    liar = SCENARIO.model_copy(update={"obstacles": resting})
    seen, ahead = observe(SCENARIO), np.arange(5.0)
    np.testing.assert_array_equal(
        build_predictor(name, SCENARIO).positions(seen, ahead), build_predictor(name, liar).positions(seen, ahead)
    )


@pytest.mark.parametrize("name", PREDICTORS)
def test_obstacles_at_rest_stay(name: str) -> None:
    resting = Obstacle(radius_m=0.02, motion=Track(times_s=(0,), positions_m=((0.1, 0.2, 0.3),)))
    scenario = SCENARIO.model_copy(update={"obstacles": (resting,)})
    prediction = build_predictor(name, scenario).predict(observe(scenario, 2.0), 10.0, 0.5)
    np.testing.assert_allclose(prediction.centers_m, np.broadcast_to([0.1, 0.2, 0.3], (21, 1, 3)), atol=1e-6)


def test_margins_grow_the_radii_up_to_the_largest() -> None:
    prediction = CubicPredictor().predict(noisy(4, 8, 2), 6.0, 1.0)
    grown = prediction.world(2.0, 0.003)
    np.testing.assert_allclose(grown.radii_m, 0.02 + 2.0 * np.minimum(prediction.bounds_m, 0.003))
    np.testing.assert_array_equal(prediction.world(0.0).radii_m, np.full((7, 2), 0.02))
    smaller = prediction.world(-1e4).radii_m
    np.testing.assert_allclose(smaller, np.maximum(0.0, 0.02 - 1e4 * prediction.bounds_m))
    assert smaller.min() == 0.0
    fading = prediction.world(2.0 - prediction.ahead_s, 0.003).radii_m
    for k, margin in enumerate((2.0, 1.0, 0.0, -1.0, -2.0, -3.0, -4.0)):
        np.testing.assert_array_equal(fading[k], prediction.world(margin, 0.003).radii_m[k])


def test_an_unknown_predictor_is_one_line_that_lists_the_known() -> None:
    with pytest.raises(SpecError, match=r"^predictor: found 'crystal ball', allowed .*cubic.*truth"):
        build_predictor("crystal ball", SCENARIO)
