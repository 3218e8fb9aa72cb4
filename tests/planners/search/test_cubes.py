"""The paper's graphs against their literal twins: Algorithm 1, the layered graph, the static cube path."""

import math
from itertools import pairwise

import networkx as nx
import numpy as np
import pytest
from hypothesis import given
from strategies import ARM, configurations, random_configurations
from twins.cubes import Algorithm1, Situation, by_cube, cube_of, is_free, layered_graph, orientation_change

from planners.search.configurations import EnumeratedSpace, enumerated_space
from planners.search.cubes import LayeredGraph, LocalGraph, ObstacleSteps, _kernels, temporal_cubes_graph
from planners.search.temporal_graph.graph import Window
from scenarios import make_world

SPACING = 0.8  # 55 bends: most cubes hold a configuration or none, so that closed cubes are common
LENGTH = ARM.section_length_m


@pytest.fixture(scope="module")
def space() -> EnumeratedSpace:
    return enumerated_space(ARM, SPACING)


@pytest.fixture(scope="module")
def everything(space: EnumeratedSpace) -> tuple[np.ndarray, dict]:
    every = space.decode(np.arange(len(space.codes)))
    return every, by_cube(ARM.tips(every))


def situation(seed: int, horizon: int) -> tuple[np.ndarray, np.ndarray, ObstacleSteps]:
    """A free configuration, a goal two decimetres off, and obstacles crowding the way."""
    rng = np.random.default_rng(seed)
    while True:
        q, other = random_configurations(rng, 2)
        q, other = 0.8 * q, 0.8 * other
        tip, goal = ARM.tips([q, other])
        if np.linalg.norm(goal - tip) < 0.15:
            continue
        centers = tip + rng.normal(scale=0.06, size=(5, 3))
        drift = rng.uniform(-0.015, 0.015, size=(5, 3))
        steps = centers + np.arange(horizon + 1)[:, None, None] * drift
        reach = np.full((horizon + 1, 5), 0.043)
        if is_free(q, LENGTH, steps[0], reach[0]):
            return q, goal, ObstacleSteps(steps, reach)


def edges_of(local: LocalGraph, space: EnumeratedSpace) -> set:
    corner = space.half

    def cube(vertex: int) -> tuple[int, ...]:
        return tuple(int(i) - corner for i in np.unravel_index(local.cubes[vertex], (2 * corner,) * 3))

    graph = local.graph
    assert (graph.mu == 1).all()
    edges = {(cube(u), cube(v), int(t)) for u, v, t in zip(graph.u, graph.v, graph.t, strict=True)}
    assert len(edges) == len(graph.t)  # none twice
    for u, v, d in zip(graph.u, graph.v, graph.d, strict=True):
        assert d == pytest.approx(0.01 * math.dist(cube(u), cube(v)))
    return edges


@pytest.mark.parametrize("waiting", [True, False])
@pytest.mark.parametrize(("seed", "horizon"), [(0, 1), (1, 2), (2, 2), (3, 2), (4, 3), (5, 3), (6, 3), (7, 3)])
def test_algorithm_1_line_by_line(
    space: EnumeratedSpace, everything: tuple[np.ndarray, dict], seed: int, horizon: int, waiting: bool
) -> None:
    q, goal, obstacles = situation(seed, horizon)
    twin = Algorithm1(Situation(q, ARM.tip(q), goal, *obstacles), *everything, LENGTH, waiting)
    local = temporal_cubes_graph(ARM, space, q, goal, obstacles, waiting)
    if twin.target is None:
        assert local.target == -1
        return
    assert space.center_m(int(local.cubes[local.target])) == pytest.approx(0.01 * (np.array(twin.target) + 0.5))
    assert edges_of(local, space) == twin.edges_towards(twin.target)
    path = local.graph.shortest_path(local.source, local.target, Window(0, 0), horizon)
    assert local.graph.d[path].sum() == pytest.approx(twin.least_cost())


def test_the_situations_are_worth_testing(space: EnumeratedSpace, everything: tuple[np.ndarray, dict]) -> None:
    closed = opened = shut_in = 0
    for seed in range(8):
        q, goal, obstacles = situation(seed, 2)
        twin = Algorithm1(Situation(q, ARM.tip(q), goal, *obstacles), *everything, LENGTH, True)
        hit = [cube for (cube, _), is_open in twin.known.items() if not is_open and cube in everything[1]]
        closed += len(hit)
        opened += sum(twin.known.values())
        shut_in += not twin.is_open(twin.here, 2)
    assert min(closed, opened) > 100
    assert shut_in


def test_no_way_out_is_no_target(space: EnumeratedSpace) -> None:
    q = np.full(6, 0.5)
    everywhere = ObstacleSteps(np.zeros((4, 1, 3)), np.array([[0.01], [2.0], [2.0], [2.0]]))
    local = temporal_cubes_graph(ARM, space, q, np.zeros(3), everywhere, True)
    assert local.target == -1
    assert len(local.graph.t) == 0


def test_obstacles_are_read_at_whole_seconds_from_now() -> None:
    centers = np.arange(13.0)[:, None, None] * np.ones((1, 1, 3))
    world = make_world(10.0, 0.25, centers, np.linspace(0.1, 0.22, 13)[:, None])
    steps = ObstacleSteps.from_world(world, 11.0, 4, 0.018)
    assert steps.centers_m[:, 0, 0].tolist() == [4, 8, 12, 12, 12]  # held after the last
    np.testing.assert_allclose(steps.reach_m[:, 0], np.array([0.14, 0.18, 0.22, 0.22, 0.22]) + 0.018)


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


@pytest.mark.parametrize("seed", range(6))
def test_the_smoothest_path_is_that_of_bellman_ford(
    space: EnumeratedSpace, everything: tuple[np.ndarray, dict], seed: int
) -> None:
    every, cubes = everything
    q, goal, obstacles = situation(seed, 3)
    local = temporal_cubes_graph(ARM, space, q, goal, obstacles, True)
    edges = local.graph.shortest_path(local.source, local.target, Window(0, 0), 3)
    numbers = [int(local.cubes[v]) for v in (local.source, *local.graph.v[edges])]
    if seed % 2:
        numbers.insert(1, numbers[0])  # wait first: the present configuration is one of the layer's
        obstacles = ObstacleSteps(*(np.concatenate([rows[:1], rows]) for rows in obstacles))
    layers = [[q]]
    for step, number in enumerate(numbers[1:], start=1):
        layer = list(every[cubes.get(cube_of(space.center_m(number)), [])])
        layer += [q] if number == numbers[0] else []
        layers.append([p for p in layer if is_free(p, LENGTH, obstacles.centers_m[step], obstacles.reach_m[step])])
    path = LayeredGraph(ARM, space, q, numbers, obstacles).smoothest_path()
    least = nx.bellman_ford_path_length(layered_graph(layers), (0, 0), "end")
    assert length(path) == pytest.approx(least)
    for chosen, layer in zip(path, layers, strict=True):
        assert chosen.tolist() in [p.tolist() for p in layer]


def length(path: np.ndarray) -> float:
    return sum(orientation_change(a, b) for a, b in pairwise(path))


def test_a_filter_closes_edges(space: EnumeratedSpace, everything: tuple[np.ndarray, dict]) -> None:
    q, goal, obstacles = situation(1, 2)
    local = temporal_cubes_graph(ARM, space, q, goal, obstacles, True)
    edges = local.graph.shortest_path(local.source, local.target, Window(0, 0), 2)
    layered = LayeredGraph(
        ARM, space, q, [int(local.cubes[v]) for v in (local.source, *local.graph.v[edges])], obstacles
    )
    free = layered.smoothest_path()
    assert layered.smoothest_path(lambda k, a, b: np.ones((len(a), len(b)), bool)).tolist() == free.tolist()
    assert layered.smoothest_path(lambda k, a, b: np.zeros((len(a), len(b)), bool)) is None

    def all_but_the_best(k: int, before: np.ndarray, after: np.ndarray) -> np.ndarray:
        return ~(after == free[k + 1]).all(axis=1)[None].repeat(len(before), axis=0)

    other = layered.smoothest_path(all_but_the_best)
    if other is not None:
        assert length(other) >= length(free)
        assert not (other[1:] == free[1:]).all(axis=1).any()


@pytest.mark.parametrize("seed", range(3))
def test_the_static_path_is_a_shortest_one(space: EnumeratedSpace, seed: int) -> None:
    rng = np.random.default_rng(seed)
    side = 2 * space.half
    # Within a slab of 12 cm, which is enough for NetworkX.
    purged = np.abs(np.indices((side,) * 3)[1].reshape(-1) + 0.5 - space.half) > 6
    occupied = np.flatnonzero((np.diff(space.offsets) > 0) & ~purged)
    start, goal = (int(k) for k in rng.choice(occupied, 2, replace=False))
    purged[rng.choice(occupied, len(occupied) // 3)] = True
    purged[[start, goal]] = False
    index = {int(k): tuple(int(i) for i in np.unravel_index(k, (side,) * 3)) for k in occupied if not purged[k]}
    at = {place: k for k, place in index.items()}
    graph = nx.Graph()
    for k, (x, y, z) in index.items():
        for dx, dy, dz in np.ndindex(3, 3, 3):
            other = at.get((x + dx - 1, y + dy - 1, z + dz - 1))
            if other is not None and other != k:
                graph.add_edge(k, other, d=0.01 * math.dist(index[k], index[other]))
    path = _kernels.static_path(start, goal, purged, space.offsets, space.half, space.cube_m)
    if not (graph.has_node(start) and graph.has_node(goal) and nx.has_path(graph, start, goal)):
        assert len(path) == 0
        return
    assert [path[0], path[-1]] == [start, goal]
    covered = sum(graph.edges[int(a), int(b)]["d"] for a, b in pairwise(path))
    assert covered == pytest.approx(nx.dijkstra_path_length(graph, start, goal, weight="d"))


def test_a_cube_contains_an_obstacle_that_reaches_into_it(space: EnumeratedSpace) -> None:
    cube = space.cube_of(np.array([0.105, 0.105, 0.105]))
    for center, radius, inside in [
        ((0.105, 0.105, 0.105), 0.001, True),
        ((0.135, 0.105, 0.105), 0.0249, False),
        ((0.135, 0.105, 0.105), 0.0251, True),
        ((0.12, 0.12, 0.12), 0.0173, False),
        ((0.12, 0.12, 0.12), 0.0174, True),
    ]:
        found = _kernels.contains_obstacle(cube, space.half, space.cube_m, np.array([center]), np.array([radius]))
        assert found is inside
