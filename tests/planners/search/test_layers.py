"""The layered graph and its motions: every pair by the shared check, every path by Bellman-Ford."""

import itertools
import math
from itertools import pairwise

import networkx as nx
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from situations import LENGTH, SPACING, situation
from strategies import ARM, configurations, random_configurations, random_world, seeds
from twins.cubes import by_cube, cube_of, is_free, layered_graph, orientation_change

from planners.search.certificate._kernels import Stack, is_motion_free
from planners.search.configurations import EnumeratedSpace, enumerated_space
from planners.search.cubes import temporal_cubes_graph
from planners.search.layers import LayeredGraph, _kernels, call, empty_layers
from planners.search.scene import Scene, frozen, scene_of
from planners.search.temporal_graph.graph import Window
from scenarios import SampledWorld, is_motion_valid, make_world
from scenarios.kernels.clearance import section_clearances
from scenarios.kernels.kinematics import ARC_SIZE


@pytest.fixture(scope="module")
def space() -> EnumeratedSpace:
    return enumerated_space(ARM, SPACING)


@pytest.fixture(scope="module")
def everything(space: EnumeratedSpace) -> tuple[np.ndarray, dict]:
    every = space.decode(np.arange(len(space.codes)))
    return every, by_cube(ARM.tips(every))


def is_free_by_kernel(q0: np.ndarray, t0: float, q1: np.ndarray, t1: float, world: SampledWorld) -> bool:
    stack = Stack(np.empty(10), np.empty((10, 3, ARC_SIZE)), np.empty((10, 3)), np.empty(6))
    for row, (q, t) in enumerate([(q0, t0), (q1, t1)]):
        section_clearances(q, t, LENGTH, ARM.radius_m, world, stack.arcs[row], stack.gaps[row])
    return bool(is_motion_free(q0, t0, q1, t1, np.empty(6), LENGTH, ARM.radius_m, world, stack))


@settings(max_examples=300, deadline=None)
@given(seeds, st.sampled_from([0.02, 0.1, 0.3, 1.0]), st.integers(0, 6))
def test_a_motion_is_free_when_the_shared_validator_says_so(seed: int, share: float, crowd: int) -> None:
    rng = np.random.default_rng(seed)
    world = random_world(rng, crowd, spread_m=0.2)
    q0, q1 = random_configurations(rng, 2)
    q1 = q0 + share * (q1 - q0)
    for t0 in (-2.0, 0.3, 1.0):
        assert is_free_by_kernel(q0, t0, q1, t0 + 1.0, world) == is_motion_valid(ARM, q0, t0, q1, t0 + 1.0, world)


def test_motions_of_both_kinds_are_among_them() -> None:
    rng = np.random.default_rng(0)
    answers = [
        is_free_by_kernel(q0, 0.0, q0 + 0.3 * (q1 - q0), 1.0, random_world(rng, 8, spread_m=0.2))
        for q0, q1 in zip(random_configurations(rng, 200), random_configurations(rng, 200), strict=True)
    ]
    assert 40 < sum(answers) < 160


@given(configurations(), configurations())
def test_the_weight_is_the_papers_with_theta_wrapped(q0: np.ndarray, q1: np.ndarray) -> None:
    by_kernel = sum(_kernels.section_change(*q0[k : k + 2], *q1[k : k + 2]) for k in (0, 2, 4))
    assert by_kernel == pytest.approx(orientation_change(q0, q1), abs=1e-9)


def test_weights_by_hand() -> None:
    quarter = math.pi / 2
    assert _kernels.section_change(1.0, 0.0, 0.0, 1.0) == pytest.approx(quarter)
    assert _kernels.section_change(1.0, 0.0, 0.0, -3.0) == pytest.approx(math.hypot(quarter, 2.0))
    # From theta = 3 to theta = -3 it is 0.28 rad, not 6.
    across = _kernels.section_change(math.cos(3), math.sin(3), math.cos(3), -math.sin(3))
    assert across == pytest.approx(2 * math.pi - 6)
    assert _kernels.section_change(0.0, 0.0, 0.0, -2.0) == pytest.approx(2.0)


def a_path(space: EnumeratedSpace, seed: int, horizon: int, limits: bool = False) -> tuple[Scene, list[int]]:
    """A scene and a cube path through it that is open at whole seconds."""
    local = None
    while local is None or local.target < 0:  # shut in
        q, goal, world = situation(seed, horizon)
        scene = scene_of(ARM, space, q, 0.0, world, horizon, limits)
        local = temporal_cubes_graph(scene, goal, True, True)
        seed += 1000
    edges = local.graph.shortest_path(local.source, local.target, Window(0, 0), horizon)
    return scene, [int(local.cubes[v]) for v in (local.source, *local.graph.v[edges])]


def layers_of(scene: Scene, cubes: list[int], everything: tuple[np.ndarray, dict]) -> list[list[np.ndarray]]:
    every, inside = everything
    layers = [[scene.q]]
    for step, number in enumerate(cubes[1:], start=1):
        layer = [scene.q] if number == cubes[0] else []
        layer += list(every[inside.get(cube_of(scene.space.center_m(number)), [])])
        layers.append([p for p in layer if is_free(p, LENGTH, *(rows[step] for rows in scene.steps))])
    return layers


def length(path: np.ndarray) -> float:
    return sum(orientation_change(a, b) for a, b in pairwise(path))


@pytest.mark.parametrize("seed", range(6))
def test_the_smoothest_path_is_that_of_bellman_ford(
    space: EnumeratedSpace, everything: tuple[np.ndarray, dict], seed: int
) -> None:
    scene, cubes = a_path(space, seed, 3)
    if seed % 2:  # wait first: the present configuration is one of the layer's
        cubes = [cubes[0], *cubes]
        centers = np.concatenate([scene.world.centers_m[:1], scene.world.centers_m])
        scene = scene_of(ARM, space, scene.q, 0.0, make_world(0.0, 1.0, centers, scene.world.radii_m[0]), 4)
    layers = layers_of(scene, cubes, everything)
    path = LayeredGraph(scene, cubes).smoothest_path()
    least = nx.bellman_ford_path_length(layered_graph(layers), (0, 0), "end")
    assert length(path) == pytest.approx(least)
    for chosen, layer in zip(path, layers, strict=True):
        assert chosen.tolist() in [p.tolist() for p in layer]


@pytest.mark.parametrize("limits", [False, True])
def test_the_smoothest_path_of_possible_motions_by_all_of_them(
    space: EnumeratedSpace, everything: tuple[np.ndarray, dict], limits: bool
) -> None:
    found = blocked = 0
    for seed in range(30):
        scene, cubes = a_path(space, seed, 2, limits)
        layers = layers_of(scene, cubes, everything)
        graph = layered_graph(layers)
        for (k, a), node in list(graph.edges):
            if node == "end":
                continue
            q0, q1 = layers[k][a], layers[k + 1][node[1]]
            slow = not limits or max(np.hypot(*(q1 - q0).reshape(-1, 2).T)) <= ARM.max_bend_rate_rad_s
            if not slow or not is_motion_valid(ARM, q0, float(k), q1, k + 1.0, scene.world):
                graph.remove_edge((k, a), node)
        layered = LayeredGraph(scene, cubes)
        path = layered.smoothest_path(look=True)
        assert layered.motion_checks <= sum(len(a) * len(b) for a, b in pairwise(layers))
        if limits:  # the tip's speed binds besides: what is found keeps to both, and is no better than without it
            if path is not None:
                assert all(np.linalg.norm(b - a) <= 1.01 * ARM.max_tip_speed_m_s for a, b in pairwise(ARM.tips(path)))
                assert length(path) >= nx.bellman_ford_path_length(graph, (0, 0), "end") - 1e-9
            continue
        assert (path is not None) == nx.has_path(graph, (0, 0), "end")
        if path is not None:
            assert length(path) == pytest.approx(nx.bellman_ford_path_length(graph, (0, 0), "end"))
            found += 1
        blocked += path is None or length(path) > length(LayeredGraph(scene, cubes).smoothest_path()) + 1e-9
    assert limits or (found > 10 and blocked > 3)


@pytest.mark.parametrize("seed", range(20))
def test_some_motion_by_all_of_them(space: EnumeratedSpace, seed: int) -> None:
    scene, cubes = a_path(space, seed, 2)
    layers = empty_layers(3, len(space.bends_rad), 2)
    _kernels.clear(layers)
    before = _kernels.add_layer(layers, scene, cubes[1], 1)
    after = _kernels.add_layer(layers, scene, cubes[min(2, len(cubes) - 1)], 2)
    block = _kernels.first_motion(layers, scene, before, after, 0)
    some = _kernels.some_motion(layers, scene, before, after, block)
    (_, first, end), (_, begin, last) = layers.spans[before], layers.spans[after]
    states = layers.configurations.states
    every = [
        is_motion_valid(ARM, states[a], 1.0, states[b], 2.0, scene.world)
        for a, b in itertools.product(range(first, end), range(begin, last))
    ]
    assert some == any(every)
    assert layers.counts[_kernels.MOTION_CHECKS] <= len(every)


def test_where_room_is_short_the_answer_is_the_same(space: EnumeratedSpace) -> None:
    scene, cubes = a_path(space, 0, 2)
    scant = empty_layers(3, len(space.bends_rad), 2, capacity=4)
    layers, (chain, blocks) = call(_kernels.layered_graph, scant, scene, np.array(cubes))
    assert len(layers.configurations.codes) > 4
    rows = _kernels.smoothest_path(layers, scene, chain, blocks, True)
    np.testing.assert_array_equal(
        layers.configurations.states[rows], LayeredGraph(scene, cubes).smoothest_path(look=True)
    )


def test_obstacles_are_read_at_whole_seconds_from_now(space: EnumeratedSpace) -> None:
    centers = np.arange(13.0)[:, None, None] * np.ones((1, 1, 3))
    world = SampledWorld(10.0, 0.25, centers, np.linspace(0.1, 0.22, 13)[:, None], 1.0)
    steps = scene_of(ARM, space, np.zeros(6), 11.0, world, 4).steps
    assert steps.centers_m[:, 0, 0].tolist() == [4, 8, 12, 12, 12]  # held after the last
    np.testing.assert_allclose(steps.reach_m[:, 0], np.array([0.14, 0.18, 0.22, 0.22, 0.22]) + 0.018)


def test_a_frozen_world_stays_as_it_is_now() -> None:
    world = random_world(np.random.default_rng(0), 3)
    still = frozen(world)
    assert still.speed_m_s == 0.0
    for row in range(2):
        np.testing.assert_array_equal(still.centers_m[row], world.centers_m[0])
        np.testing.assert_array_equal(still.radii_m[row], world.radii_m[0])
