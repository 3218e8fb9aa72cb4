"""The models of motion against closed forms and slow twins."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import interp1d
from scipy.spatial.transform import Rotation
from strategies import seeds
from twins.prediction import constant_turn, gaussian_process, kalman, turned

from planners import PREDICTORS, Observation
from planners.prediction import Predictor, gaussian
from planners.prediction.arc import ArcPredictor
from planners.prediction.arc import _kernels as arc
from planners.prediction.cubic import CubicPredictor
from planners.prediction.gaussian import GaussianProcessPredictor
from planners.prediction.gaussian import _kernels as processes
from planners.prediction.kalman import KalmanPredictor
from planners.prediction.kalman import _kernels as filters
from planners.prediction.model import NOISE_FLOOR_M, SPEED_RADII, TURN_RADII
from planners.prediction.velocity import VelocityPredictor
from scenarios import Orbit

AHEAD_S = np.array([0.0, 0.5, 1.0, 3.0, 8.0, 20.0])
RADII_M = np.array([0.02, 0.03])
NAMES = [name for name, entry in PREDICTORS.items() if not entry.is_oracle]


def build(name: str) -> Predictor:
    return PREDICTORS[name].build(None)  # only an oracle looks at the scenario


def moving(rng: np.random.Generator, times_s: np.ndarray, shape: str, n: int = 2) -> np.ndarray:
    """Centres (T, n, 3) of obstacles that move as obstacles do: centimetres per second."""
    centers = []
    for _ in range(n):
        axes = Rotation.random(random_state=rng).as_matrix()
        at, speed, radius = rng.uniform(-0.3, 0.3, 3), rng.uniform(0.001, 0.015), rng.uniform(0.06, 0.15)
        if shape == "line":
            centers.append(at + np.outer(times_s, speed * axes[0]))
        elif shape == "circle":
            angle = rng.uniform(0, 6) + speed / radius * times_s
            centers.append(at + radius * (np.outer(np.cos(angle), axes[0]) + np.outer(np.sin(angle), axes[1])))
        else:
            powers = np.array([1.0, speed, speed / 20, speed / 1000])[:, None] * rng.normal(size=(4, 3))
            centers.append(at + np.vander(times_s, 4, increasing=True) @ powers)
    return np.stack(centers, axis=1)


def seen(positions: np.ndarray, first_s: float = -5.0) -> Observation:
    return Observation(first_s + np.arange(len(positions), dtype=np.float64), positions, RADII_M)


@pytest.mark.parametrize(
    ("predictor", "shape", "ahead_s"),
    [
        (VelocityPredictor(), "line", AHEAD_S),
        (ArcPredictor(), "line", AHEAD_S),
        (KalmanPredictor(), "line", AHEAD_S),
        (ArcPredictor(), "circle", AHEAD_S),
        (CubicPredictor(), "cubic", AHEAD_S[:-1]),
        (build("portfolio"), "line", AHEAD_S),
        (build("portfolio"), "circle", AHEAD_S),
    ],
)
@given(seed=seeds, count=st.sampled_from([6, 7, 20, 60]))
def test_a_model_is_exact_on_the_motion_it_is_made_for(
    predictor: Predictor, shape: str, ahead_s: np.ndarray, seed: int, count: int
) -> None:
    rng = np.random.default_rng(seed)
    times = -5.0 + np.arange(count + 21, dtype=np.float64)
    observation = Observation(times[:count], moving(rng, times[:count], shape), RADII_M)
    truth = moving(np.random.default_rng(seed), times[count - 1] + ahead_s, shape)
    forecast = predictor.forecast(observation, times[count - 1] + ahead_s)
    np.testing.assert_allclose(forecast.centers_m, truth, atol=1e-6)
    assert forecast.bounds_m.max() < 1e-3


def test_a_circle_with_lost_observations_is_still_exact() -> None:
    orbit = Orbit(center_m=(0.1, 0.2, 0.3), radius_m=0.08, normal=(1, 2, 3), rate_rad_s=0.15, phase_rad=1.0)
    times = np.arange(-5.0, 10.0)
    positions = orbit.position(times)[:, None].copy()
    positions[[2, 3, 9, 14]] = np.nan
    forecast = ArcPredictor().forecast(Observation(times, positions, RADII_M[:1]), 9.0 + AHEAD_S)
    np.testing.assert_allclose(forecast.centers_m[:, 0], orbit.position(9.0 + AHEAD_S), atol=1e-6)


@given(seed=seeds)
def test_velocity_is_numpys_least_squares_line(seed: int) -> None:
    observation = seen(np.random.default_rng(seed).normal(size=(9, 2, 3)))
    line = np.polynomial.polynomial.polyfit(observation.times_s[-5:], observation.positions_m[-5:].reshape(5, 6), 1)
    expected = np.polynomial.polynomial.polyval(3.0 + AHEAD_S, line).T.reshape(-1, 2, 3)
    np.testing.assert_allclose(VelocityPredictor().positions(observation, 3.0 + AHEAD_S), expected, atol=1e-12)


@given(seed=seeds)
def test_cubic_is_scipys_interpolation(seed: int) -> None:
    observation = seen(np.random.default_rng(seed).normal(size=(9, 2, 3)))
    spline = interp1d(
        observation.times_s[-5:], observation.positions_m[-5:], kind="cubic", axis=0, fill_value="extrapolate"
    )
    np.testing.assert_allclose(
        CubicPredictor().positions(observation, 3.0 + AHEAD_S), spline(3.0 + AHEAD_S), rtol=1e-9, atol=1e-9
    )


@given(seed=seeds, count=st.sampled_from([6, 12, 40]), noise=st.sampled_from([2e-4, 2e-3]))
def test_arc_is_the_most_probable_turn_that_scipy_finds(seed: int, count: int, noise: float) -> None:
    rng = np.random.default_rng(seed)
    times = np.arange(count, dtype=np.float64)
    positions = moving(rng, times, "circle", n=1)[:, 0] + noise * rng.normal(size=(count, 3))
    scales = (SPEED_RADII * 0.02, 1.0 / (TURN_RADII * 0.02))
    state = np.empty((3, 3))
    variance, _, epoch = arc.fit(times, positions, NOISE_FLOOR_M, *scales, state)
    theta = constant_turn(times - epoch, positions, np.sqrt(variance), *scales, state.ravel())
    # Ends of the fitted stretch: what it is about, well away from what noise leaves open.
    axes = np.empty((3, 3))
    speed, curvature = arc.frame_of(state[1], state[2], axes)
    for t in (times[0] - epoch, 0.0, times[-1] - epoch):
        angle = curvature * speed * t
        u, w, *_ = arc.turn(t, speed, curvature, np.sin(angle), np.cos(angle))
        found = state[0] + u * axes[0] + w * axes[1]
        assert np.linalg.norm(found - turned(theta, np.array([t]))[0]) < 0.2 * np.sqrt(variance)


@given(seed=seeds, order=st.sampled_from([2, 3]), ratio=st.sampled_from([1e-8, 1e-3, 1.0, 1e3]))
def test_a_filter_is_its_twin_in_matrices(seed: int, order: int, ratio: float) -> None:
    rng = np.random.default_rng(seed)
    times = np.cumsum(rng.uniform(0.5, 2.0, size=15))
    positions = rng.normal(size=(15, 3))
    state, cov, evidence, noise = kalman(times, positions, order, ratio, filters.UNKNOWN, filters.SKIPPED)
    origins = np.array([8, 14])
    states, covs, gains = np.empty((2, 3, 3)), np.empty((2, 6)), np.empty((15, 4))
    logs, evidences, noises = np.empty(2), np.empty(2), np.empty(2)
    there = np.ones(15, dtype=bool)
    filters.weigh(times, there, 0, origins, order, ratio, gains, covs, logs)
    filters.run(times, positions, there, 0, origins, gains, logs, NOISE_FLOOR_M, 0.02, states, evidences, noises)
    np.testing.assert_allclose(states[1, :order], state, rtol=1e-5, atol=1e-5)
    np.testing.assert_allclose(covs[1, [0, 1, 3]], cov[[0, 0, 1], [0, 1, 1]], rtol=1e-4, atol=1e-4)
    assert evidences[1] == pytest.approx(evidence, rel=1e-4, abs=1e-3)
    assert noises[1] == pytest.approx(noise, rel=1e-4)


LOST = {
    "nothing": lambda rng, count: np.zeros((count, 2), dtype=bool),
    "half": lambda rng, count: rng.uniform(size=(count, 2)) < 0.5,
    "nearly all": lambda rng, count: rng.uniform(size=(count, 2)) < 0.9,
    "all but the first": lambda rng, count: np.ones((count, 2), dtype=bool),
    "the latest": lambda rng, count: np.tile(np.arange(count)[:, None] >= count - 2, 2),
    "one of one, the latest of the other": lambda rng, count: np.arange(count)[:, None] == [count // 2, count - 1],
    "nothing of one": lambda rng, count: (rng.uniform(size=(count, 2)) < 0.5) & [False, True],
}
"""Which observations (count, 2) of two obstacles are lost; the first never is."""


@pytest.mark.parametrize("lost", LOST)
@given(seed=seeds, count=st.sampled_from([1, 2, 7, 20, gaussian.HISTORY + 12]), noise=st.sampled_from([5e-4, 2e-3]))
def test_gaussian_processes_are_their_twin_in_matrices_now_and_earlier(
    lost: str, seed: int, count: int, noise: float
) -> None:
    rng = np.random.default_rng(seed)
    times = np.arange(count, dtype=np.float64)
    positions = moving(rng, times, "circle") + noise * rng.normal(size=(count, 2, 3))
    positions[1:][LOST[lost](rng, count)[1:]] = np.nan
    origins, targets = np.array([count // 2, count - 1]), np.array([[count - 1, -1]])
    found = GaussianProcessPredictor().extrapolate(Observation(times, positions, RADII_M), origins, targets, AHEAD_S)
    for j, radius in enumerate(RADII_M):
        prior = (gaussian.EXCURSION_RADII * radius, processes.PRIOR_OBSERVATIONS)
        model = (gaussian.LENGTHS_S, gaussian.RATIOS, prior, processes.NEGLIGIBLE)
        first = np.flatnonzero(~np.isnan(positions[:, j, 0]))[-gaussian.HISTORY :][0]
        places, variances, noise_variance = gaussian_process(
            times[first:], positions[first:, j], times[-1] + AHEAD_S, *model
        )
        assert (np.abs(found.centers_m[j] - places) < 1e-3 * np.sqrt(variances)[:, None] + 1e-9).all()
        np.testing.assert_allclose(found.variances[j], 2.0 * variances, rtol=1e-3, atol=1e-12)
        assert found.noise_variances[j] == pytest.approx(noise_variance, rel=1e-3, abs=1e-14)
        known = slice(first, max(first, origins[0]) + 1)
        places, variances, _ = gaussian_process(times[known], positions[known, j], times[-1:], *model)
        assert (np.abs(found.past_m[j, 0, 0] - places[0]) < 1e-3 * np.sqrt(variances[0]) + 1e-9).all()
        assert found.past_variances[j, 0, 0] == pytest.approx(2.0 * variances[0], rel=1e-3, abs=1e-12)


@given(seed=seeds, count=st.sampled_from([8, 40, 70]))
def test_what_was_lost_of_one_obstacle_does_not_change_what_gaussian_processes_say_of_another(
    seed: int, count: int
) -> None:
    rng = np.random.default_rng(seed)
    times = np.arange(count, dtype=np.float64)
    positions = moving(rng, times, "circle") + 1e-3 * rng.normal(size=(count, 2, 3))
    whole = GaussianProcessPredictor().forecast(Observation(times, positions, RADII_M), times[-1] + AHEAD_S)
    positions[1 + rng.integers(count - 1), 1] = np.nan
    gaps = GaussianProcessPredictor().forecast(Observation(times, positions, RADII_M), times[-1] + AHEAD_S)
    np.testing.assert_array_equal(gaps.centers_m[:, 0], whole.centers_m[:, 0])
    np.testing.assert_array_equal(gaps.bounds_m[:, 0], whole.bounds_m[:, 0])


def test_gaussian_processes_see_through_a_smooth_path_that_is_neither_line_nor_circle() -> None:
    times = np.arange(-5.0, 35.0)
    path = np.stack([0.1 * np.sin(0.05 * times), 0.08 * np.cos(0.03 * times), 0.05 * np.sin(0.07 * times + 1)], axis=1)
    for count, ahead, error in ((6, 8.0, 1e-3), (25, 15.0, 1e-3)):
        forecast = GaussianProcessPredictor().forecast(
            Observation(times[:count], path[:count, None], RADII_M[:1]), times[count - 1 : count] + ahead
        )
        assert np.linalg.norm(forecast.centers_m[0, 0] - path[count - 1 + int(ahead)]) < error


@pytest.mark.parametrize("name", NAMES)
@given(seed=seeds, noise=st.sampled_from([5e-4, 2e-3]))
def test_a_prediction_turns_and_shifts_with_what_is_observed(name: str, seed: int, noise: float) -> None:
    rng = np.random.default_rng(seed)
    positions = moving(rng, np.arange(14.0), "circle") + noise * rng.normal(size=(14, 2, 3))
    turn, shift = Rotation.random(random_state=rng).as_matrix(), rng.uniform(-1, 1, 3)
    here = build(name).forecast(seen(positions), 8.0 + AHEAD_S)
    there = build(name).forecast(seen(positions @ turn.T + shift), 8.0 + AHEAD_S)
    scale = np.abs(here.centers_m - positions[-1]).max() + noise
    np.testing.assert_allclose(there.centers_m, here.centers_m @ turn.T + shift, atol=0.02 * scale)
    np.testing.assert_allclose(there.bounds_m, here.bounds_m, rtol=0.05, atol=1e-6)


@pytest.mark.parametrize("name", NAMES)
def test_a_prediction_depends_on_the_observation_alone(name: str) -> None:
    rng = np.random.default_rng(5)
    positions = moving(rng, np.arange(30.0), "circle") + 1e-3 * rng.normal(size=(30, 2, 3))
    used = build(name)
    for count in range(6, 30):
        used.predict(seen(positions[:count]), 20.0, 0.25)
    before = seen(positions.copy())
    first, again = (p.predict(before, 20.0, 0.25) for p in (build(name), used))
    np.testing.assert_array_equal(first.centers_m, again.centers_m)
    np.testing.assert_array_equal(first.bounds_m, again.bounds_m)
    np.testing.assert_array_equal(before.positions_m, positions)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("lost", ["none", "the last three", "all but the first"])
@pytest.mark.parametrize("count", [1, 2, 3, 4, 5, 6, 12])
def test_a_prediction_is_finite_whatever_was_seen(name: str, lost: str, count: int) -> None:
    positions = moving(np.random.default_rng(6), np.arange(float(count)), "circle")
    positions[1:, 0] = positions[:1, 0]  # one obstacle rests
    if lost == "the last three":
        positions[max(1, count - 3) :, 1] = np.nan
    elif lost == "all but the first":
        positions[1:] = np.nan
    prediction = build(name).predict(seen(positions), 30.0, 0.5)
    assert np.isfinite(prediction.centers_m).all()
    assert np.isfinite(prediction.bounds_m).all()
    assert (prediction.bounds_m >= 0).all()
    prediction.world(2.0)
