"""Laws of motion: an orbit stays on its circle, a track on its points, and neither outruns its bound."""

import math

import numpy as np
import pytest
from hypothesis import given
from strategies import motions, orbits, tracks

from scenarios import Line, Orbit, Track, Wander, Wave
from scenarios.motion import Motion

TIMES = np.linspace(-20, 200, 441)


@given(orbits)
def test_an_orbit_stays_on_its_circle_in_its_plane(orbit: Orbit) -> None:
    arms = orbit.position(TIMES) - np.asarray(orbit.center_m)
    axis = np.asarray(orbit.normal) / np.linalg.norm(orbit.normal)
    np.testing.assert_allclose(np.linalg.norm(arms, axis=1), orbit.radius_m, atol=1e-10)
    np.testing.assert_allclose(arms @ axis, 0, atol=1e-10)


@given(orbits)
def test_an_orbit_turns_at_its_rate_about_its_normal(orbit: Orbit) -> None:
    dt = 1e-3
    a, b = orbit.position(np.array([2.0, 2.0 + dt])) - np.asarray(orbit.center_m)
    axis = np.asarray(orbit.normal) / np.linalg.norm(orbit.normal)
    turned = math.atan2(float(np.cross(a, b) @ axis), float(a @ b)) if orbit.radius_m > 1e-3 else orbit.rate_rad_s * dt
    assert turned == pytest.approx(orbit.rate_rad_s * dt, abs=1e-9)


def test_phase_and_rate_add_up() -> None:
    early = Orbit(center_m=(0, 0, 0), radius_m=1, normal=(0, 0, 2), rate_rad_s=0.5, phase_rad=0.25)
    late = Orbit(center_m=(0, 0, 0), radius_m=1, normal=(0, 0, 1), rate_rad_s=0.5, phase_rad=1.25)
    np.testing.assert_allclose(early.position(TIMES + 2), late.position(TIMES), atol=1e-12)


@given(motions)
def test_nothing_outruns_its_speed_bound(motion: Motion) -> None:
    steps = np.linalg.norm(np.diff(motion.position(TIMES), axis=0), axis=1)
    assert (steps <= motion.speed_bound_m_s * np.diff(TIMES) + 1e-9).all()


def test_speed_bounds_are_reached() -> None:
    line = Line(point_m=(0, 0, 0), velocity_m_s=(0, 0.3, -0.4))
    assert line.speed_bound_m_s == pytest.approx(0.5)
    crossed = Wander(
        center_m=(0, 0, 0),
        waves=(
            Wave(amplitude_m=(3, 0, 0), rate_rad_s=1, phase_rad=0),
            Wave(amplitude_m=(-1, 0, 0), rate_rad_s=1, phase_rad=0),
            Wave(amplitude_m=(0, 1.5, 0), rate_rad_s=2, phase_rad=0),
        ),
    )
    assert crossed.speed_bound_m_s == pytest.approx(5)  # (3 + 1, 3), with phases that bring all to their peak at once
    orbit = Orbit(center_m=(0, 0, 0), radius_m=0.1, normal=(1, 1, 1), rate_rad_s=-0.15, phase_rad=0)
    track = Track(times_s=(0, 1, 3), positions_m=((0, 0, 0), (3, 4, 0), (3, 4, 1)))
    assert orbit.speed_bound_m_s == pytest.approx(0.015)
    assert track.speed_bound_m_s == pytest.approx(5)
    assert Track(times_s=(4,), positions_m=((1, 2, 3),)).speed_bound_m_s == 0


def test_lines_and_waves_by_hand() -> None:
    line = Line(point_m=(1, 2, 3), velocity_m_s=(0.5, 0, -1))
    np.testing.assert_allclose(line.position(np.array([-2, 0, 4])), [[0, 2, 5], [1, 2, 3], [3, 2, -1]])
    waves = (
        Wave(amplitude_m=(2, 0, 0), rate_rad_s=math.pi, phase_rad=math.pi / 2),
        Wave(amplitude_m=(0, 1, 1), rate_rad_s=0.0, phase_rad=math.pi / 2),
    )
    wander = Wander(center_m=(5, 0, 0), waves=waves)
    np.testing.assert_allclose(wander.position(np.array([0, 0.5, 1])), [[7, 1, 1], [5, 1, 1], [3, 1, 1]], atol=1e-12)


def test_a_track_is_straight_between_its_points_and_rests_outside_them() -> None:
    track = Track(times_s=(0, 1, 3), positions_m=((0, 0, 0), (3, 4, 0), (3, 4, 1)))
    expected = [[0, 0, 0], [0, 0, 0], [1.5, 2, 0], [3, 4, 0], [3, 4, 0.25], [3, 4, 1], [3, 4, 1]]
    np.testing.assert_allclose(track.position(np.array([-5, 0, 0.5, 1, 1.5, 3, 99])), expected, atol=1e-15)


@given(tracks())
def test_a_track_passes_its_points(track: Track) -> None:
    np.testing.assert_array_equal(track.position(np.array(track.times_s)), track.positions_m)


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"times_s": (0, 0), "positions_m": ((0, 0, 0),) * 2}, "increase strictly"),
        ({"times_s": (1, 0), "positions_m": ((0, 0, 0),) * 2}, "increase strictly"),
        ({"times_s": (0, 1), "positions_m": ((0, 0, 0),)}, "2 entries, positions_m has 1"),
        ({"times_s": (), "positions_m": ()}, "at least 1"),
        ({"times_s": (math.nan,), "positions_m": ((0, 0, 0),)}, "finite"),
        ({"times_s": (0,), "positions_m": ((0, 0, 101),)}, "less than or equal"),
    ],
)
def test_a_track_that_is_none_is_refused(fields: dict[str, object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Track.model_validate(fields)


@pytest.mark.parametrize(
    ("field", "value"), [("normal", (0, 0, 0)), ("radius_m", -1), ("rate_rad_s", math.inf), ("center_m", (0, 0))]
)
def test_an_orbit_that_is_none_is_refused(field: str, value: object) -> None:
    good = {"center_m": (0, 0, 0), "radius_m": 1, "normal": (0, 0, 1), "rate_rad_s": 1, "phase_rad": 0}
    Orbit.model_validate(good)
    with pytest.raises(ValueError, match=field):
        Orbit.model_validate({**good, field: value})
