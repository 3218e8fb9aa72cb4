"""What the tests draw from: arms, configurations, worlds and scenarios, awkward ones included."""

import math

import numpy as np
from hypothesis import strategies as st

from scenarios import ContinuumArm, Line, Obstacle, Orbit, SampledWorld, Scenario, Track, Wander, Wave, make_world

ARM = ContinuumArm()

seeds = st.integers(0, 2**32 - 1)
planes = st.floats(-math.pi, math.pi)
# Straight, almost straight on both sides of every branch, and bent all the way, besides everything between.
bends = st.one_of(st.sampled_from([0.0, 1e-12, 9.9e-7, 1.1e-6, 1e-4, 1.1e-3, math.pi]), st.floats(0.0, math.pi))


@st.composite
def configurations(draw: st.DrawFn, n_sections: int = 3) -> np.ndarray:
    sections = [(draw(planes), draw(bends)) for _ in range(n_sections)]
    return np.array([[phi * math.cos(theta), phi * math.sin(theta)] for theta, phi in sections]).reshape(-1)


def random_configurations(rng: np.random.Generator, count: int, n_sections: int = 3) -> np.ndarray:
    """Uniform over the disc of each section, (count, 2 n_sections)."""
    phi = math.pi * np.sqrt(rng.uniform(size=(count, n_sections)))
    theta = rng.uniform(-math.pi, math.pi, size=(count, n_sections))
    return np.stack([phi * np.cos(theta), phi * np.sin(theta)], axis=2).reshape(count, -1)


def random_world(rng: np.random.Generator, n_obstacles: int, spread_m: float = 0.35, samples: int = 6) -> SampledWorld:
    """Spheres that wander about the arm's reach and grow, sampled each second from t = -2 on."""
    start = rng.uniform(-spread_m, spread_m, size=(1, n_obstacles, 3)) + np.array([0.0, 0.0, 0.1])
    steps = rng.uniform(-0.03, 0.03, size=(samples - 1, n_obstacles, 3))
    radii = rng.uniform(0.01, 0.04, size=n_obstacles) + 0.002 * np.arange(samples)[:, None]
    return make_world(-2.0, 1.0, np.concatenate([start, start + np.cumsum(steps, axis=0)]), radii)


def empty_world() -> SampledWorld:
    return make_world(0.0, 1.0, np.empty((2, 0, 3)), np.empty(0))


coordinates = st.floats(-100, 100)
points = st.tuples(coordinates, coordinates, coordinates)
rates = st.floats(-10, 10)
orbits = st.builds(
    Orbit,
    center_m=points,
    radius_m=st.floats(0, 100),
    normal=points.filter(lambda p: np.linalg.norm(p) > 1e-3),
    rate_rad_s=rates,
    phase_rad=rates,
)
lines = st.builds(Line, point_m=points, velocity_m_s=points)
waves = st.builds(Wave, amplitude_m=points, rate_rad_s=rates, phase_rad=rates)
wanders = st.builds(Wander, center_m=points, waves=st.lists(waves, min_size=1, max_size=4).map(tuple))


@st.composite
def tracks(draw: st.DrawFn) -> Track:
    times = sorted(draw(st.sets(st.integers(-1000, 1000), min_size=1, max_size=6)))
    positions = draw(st.lists(points, min_size=len(times), max_size=len(times)))
    return Track(times_s=tuple(t / 8 for t in times), positions_m=tuple(positions))


motions = st.one_of(orbits, lines, wanders, tracks())


@st.composite
def scenarios(draw: st.DrawFn) -> Scenario:
    n = draw(st.integers(1, 4))
    obstacles = st.builds(Obstacle, radius_m=st.floats(0, 10, exclude_min=True), motion=motions)
    return Scenario(
        id=draw(st.from_regex(r"[A-Za-z0-9._-]{1,20}", fullmatch=True)),
        family=draw(st.from_regex(r"[A-Za-z0-9._-]{1,20}", fullmatch=True)),
        seed=draw(st.integers(0, 2**63 - 1)),
        parameters=draw(st.dictionaries(st.text(max_size=8), st.floats(allow_nan=False, allow_infinity=False))),
        arm=ContinuumArm(n_sections=n, radius_m=draw(st.floats(0.001, 1))),
        start_rad=tuple(draw(configurations(n)).tolist()),
        goal_m=draw(points),
        goal_tolerance_m=draw(st.floats(0, 1, exclude_min=True)),
        obstacles=tuple(draw(st.lists(obstacles, max_size=3))),
        time_limit_s=draw(st.floats(1, 3600)),
        observation_s=float(draw(st.integers(4, 100))),
    )
