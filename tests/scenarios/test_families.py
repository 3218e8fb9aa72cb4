"""The generator: the same draws whatever is asked for beside them, and no hard case removed; for every family."""

import csv

import numpy as np
import pytest
from twins.clearance import sampled_clearance

from scenarios import (
    FAMILIES,
    ContinuumArm,
    Obstacle,
    Scenario,
    ScenarioError,
    SpecError,
    Track,
    generate,
    start_is_free,
)
from scenarios.families import drawing
from scenarios.families.hard import LIST

DRAWN = [family for family in FAMILIES if family != "hard"]


@pytest.mark.parametrize("family", DRAWN)
def test_a_draw_depends_on_its_number_alone(family: str) -> None:
    drawn = generate(family, 3, 9, 0)
    assert generate(family, 3, 4, 0) == drawn[:4]
    assert [s.content_hash for s in generate(family, 3, 4, 0)] == [s.content_hash for s in drawn[:4]]
    others = [generate(family, 3, 1, 1)[0], generate(family, 2, 1, 0)[0], drawn[1]]
    assert len({s.start_rad for s in [drawn[0], *others]}) == 4


@pytest.mark.parametrize("family", DRAWN)
def test_a_draw_is_a_problem_of_its_family(family: str) -> None:
    for scenario in generate(family, 4, 20, 1):
        assert scenario.family == family
        assert len(scenario.obstacles) == 4
        assert scenario.arm.within_bends(scenario.start).all()
        np.testing.assert_allclose(scenario.goal / 0.01 % 1, 0.5, atol=1e-9)
        assert all(o.motion.speed_bound_m_s <= scenario.parameters["max_speed_m_s"] + 1e-12 for o in scenario.obstacles)
        assert Scenario.model_validate(scenario.model_dump(mode="json")) == scenario


def hit_while_observed(scenario: Scenario) -> bool:
    """Whether the start is hit at one of 251 instants of the observation."""
    times = np.linspace(-scenario.observation_s, 0, 251)
    tracks = np.stack([obstacle.position(times) for obstacle in scenario.obstacles], axis=1)
    radii = np.array([obstacle.radius_m for obstacle in scenario.obstacles])
    arm = scenario.arm
    closest = sampled_clearance(
        scenario.start, arm.section_length_m, arm.radius_m, tracks.reshape(-1, 3), np.tile(radii, len(times)), 20
    )
    return closest <= 0


@pytest.mark.parametrize("family", DRAWN)
def test_nothing_but_a_hit_start_is_rejected(family: str) -> None:
    drawn, rejected = generate(family, 6, 40, 0), 0
    for first, kept in zip(generate(f"{family}[redraw=false]", 6, 40, 0), drawn, strict=True):
        assert not hit_while_observed(kept)
        if hit_while_observed(first):
            rejected += 1
            assert kept.content_hash != first.content_hash
        else:
            assert kept.content_hash == first.content_hash
    assert rejected > 0


def test_a_start_is_hit_at_any_instant_not_at_whole_seconds_only() -> None:
    (scenario,) = generate("orbit", 0, 1, 0)
    tip = scenario.arm.tip(scenario.start)
    far = tuple((tip + 50.0).tolist())
    passing = Track(times_s=(-4.0, -3.5, -3.0), positions_m=(far, tuple(tip.tolist()), far))
    for obstacles, free in [((), True), ((Obstacle(radius_m=0.02, motion=passing),), False)]:
        assert start_is_free(scenario.model_copy(update={"obstacles": obstacles})) is free


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("orbit", -1, 1, 0), "obstacles: found -1, allowed 0 to 1000"),
        (("orbit", 1, 0, 0), "trials: found 0"),
        (("orbit", 1, 1, -1), "seed: found -1"),
        (("orbit[min_distance_m=1.5,max_distance_m=1.6]", 1, 1, 0), "tips 1.5 to 1.6 m apart"),
    ],
)
def test_impossible_requests_are_refused_in_one_line(arguments: tuple, message: str) -> None:
    with pytest.raises(ScenarioError, match=message):
        generate(*arguments)


def test_a_family_that_always_hits_the_start_is_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(drawing, "start_is_free", lambda _: False)
    with pytest.raises(ScenarioError, match="every one of 1000 draws hits the start"):
        generate("orbit", 0, 1, 0)


@pytest.mark.parametrize(
    ("spec", "message"),
    [
        ("swarm", "family: found 'swarm', allowed orbit"),
        ("orbit[speed=1]", "found setting 'speed', allowed redraw, min_distance_m"),
        ("orbit[max_speed_m_s=fast]", "max_speed_m_s"),
        ("orbit[max_speed_m_s=-1]", "max_speed_m_s"),
        ("hard[redraw=false]", "hard: found setting 'redraw', allowed none"),
    ],
)
def test_unknown_families_and_settings_are_refused(spec: str, message: str) -> None:
    with pytest.raises(SpecError) as caught:
        generate(spec, 1, 1, 0)
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_hard_scenarios_are_the_listed_ones_whatever_the_seed() -> None:
    with LIST.open(encoding="utf-8", newline="") as file:
        listed = list(csv.DictReader(file))
    for n in (3, 6, 10, 15):
        rows = [row for row in listed if int(row["n_obstacles"]) == n]
        drawn = generate("hard", n, len(rows), 0)
        assert len(rows) == 200
        assert [scenario.content_hash for scenario in drawn] == [row["scenario_hash"] for row in rows]
        assert generate("hard", n, 3, 77) == drawn[:3]
        assert {scenario.family for scenario in drawn} == {"hard"}
        assert len({scenario.id for scenario in drawn}) == 200
        assert min(scenario.seed for scenario in drawn) >= 1000  # reported seeds are not looked at


@pytest.mark.parametrize(
    ("asked", "line"),
    [
        (("hard", 4, 1, 0), "hard: found 4 obstacles, allowed 3, 6, 10, 15"),
        (("hard", 3, 201, 0), "hard: found 201 trials, allowed the 200 listed with 3 obstacles"),
        (("hard", 3, 1, 0, ContinuumArm(radius_m=0.01)), "hard: found another arm"),
    ],
)
def test_what_is_not_listed_is_one_line(asked: tuple, line: str) -> None:
    with pytest.raises(ScenarioError, match=line):
        generate(*asked)
