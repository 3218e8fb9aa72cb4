import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenarios import Line, Orbit, ScenarioError, Wander, Wave, load_scenarios

coordinates = st.floats(-10, 10)
points = st.tuples(coordinates, coordinates, coordinates)
waves = st.builds(Wave, amplitude_m=points, rate_rad_s=st.floats(-3, 3), phase_rad=st.floats(-10, 10))
lines = st.builds(Line, point_m=points, velocity_m_s=points)
wanders = st.builds(Wander, center_m=points, waves=st.lists(waves, min_size=1, max_size=8).map(tuple))


def at(law, *times):
    return law.position(np.array(times, dtype=float))


def test_a_line_is_where_it_has_to_be_at_any_time():
    line = Line(point_m=(1, 2, 3), velocity_m_s=(0.3, 0, -0.4))
    np.testing.assert_allclose(at(line, -10, 0, 100), [[-2, 2, 7], [1, 2, 3], [31, 2, -37]])
    assert line.speed_bound_m_s == pytest.approx(0.5)


def test_two_waves_a_quarter_turn_apart_are_an_orbit():
    across = Wave(amplitude_m=(0.1, 0, 0), rate_rad_s=0.2, phase_rad=0.7)
    along = Wave(amplitude_m=(0, 0.1, 0), rate_rad_s=0.2, phase_rad=0.7 + np.pi / 2)
    orbit = Orbit(center_m=(1, 0, 0), radius_m=0.1, normal=(0, 0, 1), rate_rad_s=0.2, phase_rad=0)
    wander = Wander(center_m=(1, 0, 0), waves=(across, along))
    times = np.linspace(-50, 50, 101)
    np.testing.assert_allclose(np.linalg.norm(wander.position(times) - [1, 0, 0], axis=1), 0.1)
    # As fast as the orbit; the bound allows for phases that line the two up.
    steps = [np.linalg.norm(np.diff(law.position(times), axis=0), axis=1) for law in (wander, orbit)]
    np.testing.assert_allclose(*steps)
    assert wander.speed_bound_m_s == pytest.approx(np.sqrt(2) * orbit.speed_bound_m_s)


@given(st.one_of(lines, wanders), st.floats(-1000, 1000))
def test_nothing_is_ever_faster_than_its_bound(law, start_s):
    times = start_s + np.linspace(0, 5, 200)
    steps = np.linalg.norm(np.diff(law.position(times), axis=0), axis=1)
    assert (steps <= law.speed_bound_m_s * np.diff(times) * (1 + 1e-9) + 1e-9).all()


@given(st.lists(waves, min_size=1, max_size=4))
def test_some_phases_reach_the_bound(terms):
    """At t = 0 a wave of phase 0 or pi is at its fastest, one way or the other."""
    law = Wander(center_m=(0, 0, 0), waves=tuple(terms))
    h = 1e-6
    fastest = 0.0
    for flips in np.ndindex(*(2,) * len(terms)):
        flipped = [wave.model_copy(update={"phase_rad": np.pi * flip}) for wave, flip in zip(terms, flips, strict=True)]
        before, after = at(law.model_copy(update={"waves": tuple(flipped)}), -h, h)
        fastest = max(fastest, np.linalg.norm(after - before) / (2 * h))
    assert fastest == pytest.approx(law.speed_bound_m_s, rel=1e-6, abs=1e-6)


@given(st.one_of(lines, wanders))
def test_many_times_at_once_give_what_each_gives(law):
    times = np.array([-3.0, 0.0, 0.5, 77.0])
    np.testing.assert_allclose(law.position(times), np.concatenate([at(law, t) for t in times]), atol=1e-12)


@pytest.mark.parametrize(
    ("motion", "field"),
    [
        ("{kind: line, point_m: [0, 0, .inf], velocity_m_s: [0, 0, 0]}", "point_m"),
        ("{kind: line, point_m: [0, 0, 0]}", "velocity_m_s"),
        ("{kind: wander, center_m: [0, 0, 0], waves: []}", "waves"),
        (
            "{kind: wander, center_m: [0, 0, 0], waves: [{amplitude_m: [1, 0], rate_rad_s: 1, phase_rad: 0}]}",
            "amplitude_m",
        ),
        ("{kind: jump}", "motion"),
    ],
)
def test_a_wrong_law_in_a_file_is_one_line_that_names_the_field(tmp_path, motion, field):
    file = tmp_path / "s.yaml"
    obstacle = f"{{radius_m: 0.02, motion: {motion}}}"
    file.write_text(f"{{id: a, start_rad: [0, 0, 0, 0, 0, 0], goal_m: [0, 0, 0.4], obstacles: [{obstacle}]}}")
    with pytest.raises(ScenarioError) as error:
        load_scenarios(file)
    assert str(file) in str(error.value)
    assert field in str(error.value)
    assert "\n" not in str(error.value)
