"""Every reading of Algorithms 1 and 2 against the literal one: q_b, the shortest path's cost, the smoothest path."""

import itertools
import math

import numpy as np
import pytest
from situations import SPACING, situation
from strategies import ARM

from benchmarks import literal
from planners.search.configurations import EnumeratedSpace, enumerated_space
from planners.search.cube_paths import _kernels
from planners.search.layers import call, empty_layers
from planners.search.scene import scene_of

TRANSITIONS = {name: number for number, name in enumerate(("steps", "layers", "edges", "chained"))}


@pytest.fixture(scope="module")
def space() -> EnumeratedSpace:
    return enumerated_space(ARM, SPACING)


def cube(space: EnumeratedSpace, number: int) -> tuple[int, int, int]:
    side = 2 * space.half
    return number // (side * side), number // side % side, number % side


@pytest.mark.parametrize("target", ["closest", "reachable"])
@pytest.mark.parametrize("transitions", TRANSITIONS)
@pytest.mark.parametrize(("seeds", "horizon"), [(range(12), 2), (range(12, 16), 3), (range(16, 20), 1)])
def test_it_answers_as_the_literal_reading_does(
    space: EnumeratedSpace, seeds: range, horizon: int, transitions: str, target: str
) -> None:
    for seed in seeds:
        q, goal, world = situation(seed, horizon)
        query = literal.Query(ARM, space, q, goal, world, 0.0, transitions, target)
        scene = scene_of(ARM, space, q, 0.0, world, horizon)
        reading = _kernels.Reading(TRANSITIONS[transitions], target == "reachable", True)
        layers = empty_layers(3, len(space.bends_rad), horizon)
        _, (path, states) = call(_kernels.plan, layers, scene, space.cube_of(goal), horizon, reading)
        round_ = literal.Round(query)
        answer = round_.solve()
        if answer is None or math.isinf(answer.length_m):
            assert len(path) == 0
            assert len(states) == 0
            continue
        cubes = [cube(space, int(number)) for number in path]
        assert cubes[0] == round_.here
        assert round_.squared(cubes[-1]) == answer.squared_to_goal
        steps = [space.cube_m * math.dist(a, b) for a, b in itertools.pairwise(cubes)]
        assert math.fsum(steps) == pytest.approx(answer.length_m)
        smoothest = round_.smoothest(cubes)
        assert (smoothest is None) == (len(states) == 0)
        assert transitions in {"layers", "edges"} or smoothest is not None
        if smoothest is not None:
            assert literal.path_smoothness(states) == pytest.approx(literal.path_smoothness(smoothest))
            assert [round_.here, *cubes[1:]] == [literal._cube_of(space, ARM.tip(state)) for state in states]


@pytest.mark.parametrize("transitions", TRANSITIONS)
def test_without_waiting_it_never_stays(space: EnumeratedSpace, transitions: str) -> None:
    stayed = {True: 0, False: 0}
    for seed, waiting in itertools.product(range(30), (True, False)):
        q, _, world = situation(seed, 3)
        reading = _kernels.Reading(TRANSITIONS[transitions], True, waiting)
        layers = empty_layers(3, len(space.bends_rad), 3)
        scene = scene_of(ARM, space, q, 0.0, world, 3)
        _, (path, _) = call(_kernels.plan, layers, scene, space.cube_of(ARM.tip(q)), 3, reading)
        stayed[waiting] += sum(a == b for a, b in itertools.pairwise(path.tolist()))
    assert stayed[True] > 0
    assert stayed[False] == 0


def test_with_room_to_grow_the_answer_is_the_same() -> None:
    fine = enumerated_space(ARM, 0.5)
    q, goal, world = situation(3, 6)
    scene = scene_of(ARM, fine, q, 0.0, world, 6)
    reading = _kernels.Reading(_kernels.CHAINED, True, True)
    scant = empty_layers(3, len(fine.bends_rad), 6, capacity=8)
    layers, first = call(_kernels.plan, scant, scene, fine.cube_of(goal), 6, reading)
    assert len(layers.configurations.codes) > 8
    again = _kernels.plan(layers, scene, fine.cube_of(goal), 6, reading)
    for one, other in zip(first, again, strict=True):
        np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize(
    ("spacing", "horizon", "crowd", "seeds"),
    [(0.5, 3, 8, range(100)), (0.5, 4, 8, [228]), (0.5, 5, 12, [502, 686]), (0.628, 4, 12, [542])],
)
def test_a_chained_path_can_always_be_followed(spacing: float, horizon: int, crowd: int, seeds: list[int]) -> None:
    """Paths that meet in a cube bring other configurations there; the seeds named are some where that matters."""
    fine = enumerated_space(ARM, spacing)
    layers, reading = empty_layers(3, len(fine.bends_rad), horizon), _kernels.Reading(_kernels.CHAINED, True, True)
    found = 0
    for seed in seeds:
        q, goal, world = situation(seed, horizon, crowd)
        scene = scene_of(ARM, fine, q, 0.0, world, horizon)
        layers, (path, states) = call(_kernels.plan, layers, scene, fine.cube_of(goal), horizon, reading)
        assert len(states) == len(path), seed
        found += len(path) > 0
    assert found > len(seeds) / 2
