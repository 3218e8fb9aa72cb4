import numpy as np
import pytest
from audit_twin import random_direction
from hypothesis import given, settings
from hypothesis import strategies as st

from scenarios import Line, Obstacle, Orbit, Scenario, Track, Wander, Wave
from suite.auditor._kernels import obstacle_at
from suite.auditor.truth import assemble, pack, pack_law


def random_track(rng):
    times = np.cumsum(rng.exponential(size=rng.integers(1, 8))) - 2.0
    return Track(times_s=tuple(times), positions_m=tuple(map(tuple, rng.normal(size=(len(times), 3)))))


def random_orbit(rng):
    return Orbit(
        center_m=tuple(rng.normal(size=3)),
        radius_m=rng.uniform(0, 0.5),
        normal=tuple(rng.choice([1e-3, 1.0, 5.0]) * random_direction(rng)),
        rate_rad_s=rng.choice([0.0, 1e-16, 1e-9, 0.1, -2.0]),
        phase_rad=rng.uniform(-7, 7),
    )


def random_line(rng):
    return Line(
        point_m=tuple(rng.normal(size=3)), velocity_m_s=tuple(rng.choice([0.0, 0.01, 1.0]) * rng.normal(size=3))
    )


def random_wander(rng):
    waves = [
        Wave(amplitude_m=tuple(a), rate_rad_s=r, phase_rad=p)
        for a, r, p in zip(rng.normal(size=(8, 3)), rng.normal(size=8), rng.uniform(-7, 7, 8), strict=True)
    ]
    return Wander(center_m=tuple(rng.normal(size=3)), waves=tuple(waves[: rng.integers(1, 9)]))


@settings(max_examples=100)
@given(seed=st.integers(0, 2**32 - 1))
def test_packed_obstacles_are_where_their_laws_say_and_no_faster_than_they_claim(seed):
    rng = np.random.default_rng(seed)
    kinds = [random_track, random_orbit, random_line, random_wander]
    laws = [kinds[k](rng) for k in rng.permutation(np.repeat(np.arange(4), 2))]
    obstacles = tuple(Obstacle(radius_m=0.02, motion=law) for law in laws)
    truth = pack(Scenario(id="laws", start_rad=(0,) * 6, goal_m=(0, 0, 0), obstacles=obstacles))
    for t in rng.uniform(-3.0, 120.0, 8):
        for j, law in enumerate(laws):
            x, y, z, speed, holds_s = obstacle_at(j, t, truth)
            assert (x, y, z) == pytest.approx(law.position(np.array([t]))[0], abs=1e-9)
            ahead = t + min(holds_s, 10.0) * np.linspace(0.0, 1.0, 9)
            path = law.position(ahead)
            length = np.linalg.norm(np.diff(path, axis=0), axis=1).sum()
            assert length <= speed * (ahead[-1] - t) + 1e-9
            assert speed <= truth.speeds_m_s[j] * (1 + 1e-9)


class Swing:
    """A law that no kernel knows."""

    speed_bound_m_s = 0.03

    def position(self, times_s):
        return 0.01 * np.stack([np.sin(2 * times_s), np.cos(2 * times_s), np.sin(times_s)], axis=1)


def test_a_law_without_a_kernel_is_followed_within_its_pad():
    packed = pack_law(Swing(), 60.0)
    sphere = Obstacle(radius_m=0.02, motion=Line(point_m=(0, 0, 0), velocity_m_s=(0, 0, 0)))
    truth = assemble([sphere], [packed])
    assert 0.0 < packed.pad_m <= 2.1e-5
    assert truth.radii_m[0] == 0.02 + packed.pad_m
    for t in np.random.default_rng(3).uniform(0.0, 60.0, 300):
        x, y, z, _, _ = obstacle_at(0, t, truth)
        assert np.linalg.norm(Swing().position(np.array([t]))[0] - (x, y, z)) <= packed.pad_m
