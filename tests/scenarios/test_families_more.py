import numpy as np
import pytest

from scenarios import generate, start_is_free

TIMES = np.linspace(0, 120, 1201)


def to_way(scenario, points):
    """Distance of points (N, 3) from the straight way from the start's tip to the goal."""
    start = scenario.arm.tip(scenario.start)
    along = scenario.goal - start
    shares = np.clip((points - start) @ along / (along @ along), 0, 1)
    return np.linalg.norm(points - start - np.outer(shares, along), axis=1)


@pytest.fixture(scope="module", params=["crossing", "wander"])
def drawn(request):
    return generate(request.param, 5, 40, seed=3)


def test_starts_are_free_and_draws_repeat(drawn):
    assert all(start_is_free(scenario) for scenario in drawn)
    assert drawn == generate(drawn[0].family, 5, 40, seed=3)
    assert drawn[:5] == generate(drawn[0].family, 5, 5, seed=3)


def test_no_obstacle_is_faster_than_the_paper_s_and_sizes_are_the_paper_s(drawn):
    for scenario in drawn:
        for obstacle in scenario.obstacles:
            steps = np.linalg.norm(np.diff(obstacle.position(TIMES), axis=0), axis=1)
            assert 0 < steps.max() / np.diff(TIMES).min() <= 0.015 + 1e-9
            assert obstacle.motion.speed_bound_m_s <= 0.015 * (1 + 1e-9)
            assert obstacle.radius_m in {0.02, 0.03}


def test_crossings_come_from_afar_and_pass_the_way_in_time():
    for scenario in generate("crossing", 5, 40, seed=0):
        for obstacle in scenario.obstacles:
            away = to_way(scenario, obstacle.position(TIMES))
            assert away[(TIMES >= 5) & (TIMES <= 60)].min() <= 0.05 + 0.0015
            assert obstacle.motion.kind == "line"
    firsts = [to_way(s, s.obstacles[0].position(TIMES[:1]))[0] for s in generate("crossing", 1, 100, seed=0)]
    assert np.median(firsts) > 0.1


def test_wandering_keeps_about_its_point_and_is_no_circle():
    far = []
    for scenario in generate("wander", 5, 40, seed=0):
        for obstacle in scenario.obstacles:
            away = np.linalg.norm(obstacle.position(np.linspace(0, 1e5, 2000)) - obstacle.motion.center_m, axis=1)
            far.append(np.sqrt(np.mean(away**2)))
            assert np.std(away) > 1e-3
    assert min(far) > 0.05
    assert max(far) < 0.17


def test_settings_are_obeyed():
    slow = generate("wander[max_speed_m_s=0.006,n_waves=2]", 3, 5, seed=0)
    assert all(len(o.motion.waves) == 2 and o.motion.speed_bound_m_s <= 0.00601 for s in slow for o in s.obstacles)
    near = generate("crossing[max_miss_m=0,min_pass_s=10,max_pass_s=10]", 3, 5, seed=0)
    at_ten = [to_way(s, o.position(np.array([10.0])))[0] for s in near for o in s.obstacles]
    assert max(at_ten) < 1e-9
