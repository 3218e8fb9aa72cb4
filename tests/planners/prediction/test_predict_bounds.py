"""Error bounds: that they grow, that they are honest, and that hindsight picks well."""

import functools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from strategies import seeds

from planners import PREDICTORS, Observation
from planners.prediction import Predictor
from planners.prediction._kernels import SPURT, blend, growth, invert, keep_within_reach, solve
from scenarios import Scenario, generate

HORIZONS_S = np.array([1.0, 2.0, 3.0, 5.0, 8.0, 12.0, 20.0])
FAMILIES = ("orbit", "crossing", "wander")
NAMES = [name for name, entry in PREDICTORS.items() if not entry.is_oracle]


@functools.cache
def scenarios(family: str) -> list[Scenario]:
    return generate(family, 3, 40, 1000)


def build(name: str) -> Predictor:
    return PREDICTORS[name].build(scenarios("orbit")[0])


def observed(
    scenario: Scenario, count: int, noise_m: float, rng: np.random.Generator, dropout: float = 0.0
) -> Observation:
    times = -scenario.observation_s + np.arange(count, dtype=np.float64)
    positions = np.stack([o.position(times) for o in scenario.obstacles], axis=1)
    positions += noise_m * rng.normal(size=positions.shape)
    if dropout:
        positions[1:][rng.uniform(size=positions[1:].shape[:2]) < dropout] = np.nan
    return Observation(times, positions, np.array([o.radius_m for o in scenario.obstacles]))


@functools.cache
def measured(name: str, family: str, count: int, noise_m: float, dropout: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Errors and bounds, horizons by obstacles."""
    rng = np.random.default_rng(1)
    errors, bounds = [], []
    for scenario in scenarios(family):
        seen = observed(scenario, count, noise_m, rng, dropout)
        times = seen.times_s[-1] + HORIZONS_S
        forecast = build(name).forecast(seen, times)
        truth = np.stack([o.position(times) for o in scenario.obstacles], axis=1)
        errors.append(np.linalg.norm(forecast.centers_m - truth, axis=2))
        bounds.append(forecast.bounds_m)
    return np.concatenate(errors, axis=1), np.concatenate(bounds, axis=1)


@pytest.mark.parametrize("name", NAMES)
@given(seed=seeds, count=st.sampled_from([5, 6, 12, 40]), noise=st.sampled_from([0.0, 5e-4, 2e-3]))
def test_a_bound_grows_with_the_horizon(name: str, seed: int, count: int, noise: float) -> None:
    scenario = scenarios(FAMILIES[seed % 3])[seed % 40]
    seen = observed(scenario, count, noise, np.random.default_rng(seed))
    bounds = build(name).forecast(seen, seen.times_s[-1] + np.arange(0.0, 12.5, 0.5)).bounds_m
    assert (np.diff(bounds, axis=0) >= -0.05 * bounds[:-1] - 1e-7).all()  # weights of a portfolio may shift
    assert (bounds[-1] >= bounds[0]).all()


@pytest.mark.parametrize("family", FAMILIES)
@pytest.mark.parametrize("noise", [0.0, 5e-4, 2e-3])
@pytest.mark.parametrize("count", [6, 30])
def test_two_bounds_of_the_portfolio_hold_most_errors(family: str, noise: float, count: int) -> None:
    errors, bounds = measured("portfolio", family, count, noise)
    within = (errors <= 2.0 * bounds + 1e-8).mean(axis=1)
    assert within.min() >= 0.82
    assert within.mean() >= 0.87


@pytest.mark.parametrize("name", ["gp", "portfolio"])
@pytest.mark.parametrize("family", FAMILIES)
@pytest.mark.parametrize("count", [6, 30])
def test_two_bounds_hold_most_errors_with_half_of_the_observations_lost(name: str, family: str, count: int) -> None:
    errors, bounds = measured(name, family, count, 2e-3, 0.5)
    within = (errors <= 2.0 * bounds + 1e-8).mean(axis=1)
    assert within.min() >= 0.82
    assert within.mean() >= 0.87


def test_a_bound_says_something() -> None:
    # 30 observations with half a millimetre of noise: an honest bound that is of use is within a few times the error.
    errors, bounds = measured("portfolio", "orbit", 30, 5e-4)
    assert (np.median(bounds, axis=1) < 5.0 * np.median(errors, axis=1)).all()


@pytest.mark.parametrize("family", FAMILIES)
@pytest.mark.parametrize("noise", [0.0, 5e-4, 2e-3])
@pytest.mark.parametrize("count", [6, 30])
def test_the_portfolio_is_not_much_worse_than_the_best_of_its_models(family: str, noise: float, count: int) -> None:
    mean = {name: measured(name, family, count, noise)[0].mean(axis=1) for name in NAMES}
    best = min((mean[name] for name in NAMES if name != "portfolio"), key=lambda errors: np.log(errors + 1e-6).mean())
    # With six noisy observations a line and a slow turn cannot be told apart, but for the horizons that matter most.
    late = 7.0 if count == 6 else 2.75
    assert (mean["portfolio"] <= np.where(HORIZONS_S <= 5, 2.25, late) * best + 1e-4).all()


def test_after_a_turn_nobody_is_certain() -> None:
    # A straight line that suddenly turns: the present fit is wrong, and hindsight says so.
    times = np.arange(-5.0, 12.0)
    positions = np.zeros((len(times), 1, 3))
    positions[:, 0, 0] = 0.01 * np.minimum(times, 6.0)
    positions[:, 0, 1] = 0.01 * np.maximum(times - 6.0, 0.0)
    for name in NAMES:
        bounds = build(name).forecast(Observation(times, positions, np.array([0.02])), 11.0 + HORIZONS_S).bounds_m
        assert bounds[-1, 0] > 0.02


@given(seed=seeds, n=st.sampled_from([1, 3, 5]))
def test_small_systems_are_numpys(seed: int, n: int) -> None:
    rng = np.random.default_rng(seed)
    root, right = rng.normal(size=(n, n)), rng.normal(size=n)
    matrix = root @ root.T + 0.1 * np.eye(n)
    work = np.tril(np.column_stack([matrix, right]), 0)
    work[:, n] = right
    x = np.empty(n)
    product = solve(work, n, 0.5, np.empty((n, n)), x)
    expected = np.linalg.solve(matrix + 0.5 * np.diag(np.diag(matrix)), right)
    np.testing.assert_allclose(x, expected, rtol=1e-6, atol=1e-8)
    assert product == pytest.approx(expected @ right, rel=1e-6, abs=1e-9)
    invert(work, n)
    np.testing.assert_allclose(work[:, :n], np.linalg.inv(matrix), rtol=1e-5, atol=1e-7)


@pytest.mark.parametrize("order", [1, 2, 3, 4])
def test_growth_is_the_error_of_a_polynomial_extrapolated(order: int) -> None:
    times = np.arange(1.0 - order, 1.0)
    ahead = np.array([1.0, 2.0, 5.0])
    law = np.polynomial.Polynomial([0.0] * order + [1.0])  # its order-th derivative is order!
    fit = np.polynomial.polynomial.polyfit(times, law(times), order - 1)
    error = law(ahead) - np.polynomial.polynomial.polyval(ahead, fit)
    factorial = float(np.prod(np.arange(1, order + 1)))
    np.testing.assert_allclose([factorial * growth(t, 1.0, order) for t in ahead], error, rtol=1e-6)


def test_a_blend_is_a_weighted_mean_that_a_perfect_model_wins() -> None:
    rng = np.random.default_rng(3)
    centers = tuple(rng.normal(size=(2, 4, 3)) for _ in range(3))
    bounds = tuple(np.full((2, 4), b) for b in (0.01, 0.02, 0.04))
    scores = tuple(np.array(s) for s in ([1e-4, 0.0], [2e-4, 1e-4], [1e-4, 1e-4]))
    mean, spread = blend(centers, bounds, scores)
    weights = np.array([1 / 0.01, 1 / (8 * 0.02), 1 / 0.04])
    weights /= weights.sum()
    expected = np.tensordot(weights, np.array(centers)[:, 0], axes=1)
    np.testing.assert_allclose(mean[0], expected, atol=1e-6)
    apart = np.square(np.array(centers)[:, 0] - expected).sum(axis=2)
    variance = weights @ (np.array([0.01, 0.02, 0.04])[:, None] ** 2 + 0.5 * apart)
    np.testing.assert_allclose(spread[0], np.sqrt(variance), rtol=1e-6)
    np.testing.assert_allclose(mean[1], centers[0][1], atol=1e-12)


@given(seed=seeds, count=st.integers(2, 12), gap=st.integers(1, 5), lost=st.integers(0, 3))
def test_no_obstacle_is_predicted_to_outrun_what_it_was_seen_to_do(seed: int, count: int, gap: int, lost: int) -> None:
    rng = np.random.default_rng(seed)
    times, ahead = np.arange(float(count)), np.array([0.5, 2.0, 20.0])
    seen = rng.normal(size=(count, 2, 3))
    seen[max(1, count - lost) :, 1] = np.nan
    bounds, centers = rng.uniform(0.0, 1.0, size=(2, 3)), rng.normal(scale=50.0, size=(2, 3, 3))
    kept = centers.copy()
    keep_within_reach(times, seen, gap, ahead, bounds, kept)
    for j in range(2):
        known = np.flatnonzero(~np.isnan(seen[:, j, 0]))
        last = known[-1]
        pairs = [(min(k for k in known if k >= i - gap), i) for i in known]
        speed = max([np.linalg.norm(seen[i, j] - seen[k, j]) / (i - k) for k, i in pairs if k < i], default=0.0)
        reach = bounds[j, 0] + SPURT * speed * (times[-1] - times[last] + ahead)
        away = centers[j] - seen[last, j]
        share = np.minimum(1.0, reach / np.linalg.norm(away, axis=1))
        np.testing.assert_allclose(kept[j], seen[last, j] + share[:, None] * away, atol=1e-9)
