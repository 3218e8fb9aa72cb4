"""The paper's cubes against their literal twins: Algorithm 1 at whole seconds, the static cube path."""

import math
from itertools import pairwise

import networkx as nx
import numpy as np
import pytest
from situations import LENGTH, SPACING, situation
from strategies import ARM
from twins.cubes import Algorithm1, Situation, by_cube

from planners.search.configurations import EnumeratedSpace, enumerated_space
from planners.search.cubes import LocalGraph, _kernels, temporal_cubes_graph
from planners.search.scene import ObstacleSteps, scene_of
from planners.search.temporal_graph.graph import Window
from scenarios import make_world


@pytest.fixture(scope="module")
def space() -> EnumeratedSpace:
    return enumerated_space(ARM, SPACING)


@pytest.fixture(scope="module")
def everything(space: EnumeratedSpace) -> tuple[np.ndarray, dict]:
    every = space.decode(np.arange(len(space.codes)))
    return every, by_cube(ARM.tips(every))


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


@pytest.mark.parametrize("reachable", [True, False])
@pytest.mark.parametrize("waiting", [True, False])
@pytest.mark.parametrize(("seed", "horizon"), [(0, 1), (1, 2), (2, 2), (3, 2), (4, 3), (5, 3), (6, 3), (7, 3)])
def test_algorithm_1_line_by_line(
    space: EnumeratedSpace, everything: tuple[np.ndarray, dict], seed: int, horizon: int, waiting: bool, reachable: bool
) -> None:
    q, goal, world = situation(seed, horizon)
    scene = scene_of(ARM, space, q, 0.0, world, horizon)
    twin = Algorithm1(Situation(q, ARM.tip(q), goal, *scene.steps), *everything, LENGTH, waiting, reachable)
    local = temporal_cubes_graph(scene, goal, waiting, reachable)
    if twin.target is None:
        assert local.target == -1
        return
    assert space.center_m(int(local.cubes[local.target])) == pytest.approx(0.01 * (np.array(twin.target) + 0.5))
    assert edges_of(local, space) == twin.edges_towards(twin.target)
    path = local.graph.shortest_path(local.source, local.target, Window(0, 0), horizon)
    least = twin.least_cost()
    assert (path is None) == math.isinf(least)
    if path is not None:
        assert local.graph.d[path].sum() == pytest.approx(least)


def test_the_situations_are_worth_testing(space: EnumeratedSpace, everything: tuple[np.ndarray, dict]) -> None:
    closed = opened = shut_in = 0
    for seed in range(8):
        q, goal, world = situation(seed, 2)
        steps = scene_of(ARM, space, q, 0.0, world, 2).steps
        twin = Algorithm1(Situation(q, ARM.tip(q), goal, *steps), *everything, LENGTH, True, True)
        hit = [cube for (cube, _), is_open in twin.known.items() if not is_open and cube in everything[1]]
        closed += len(hit)
        opened += sum(twin.known.values())
        shut_in += not twin.is_open(twin.here, 2)
    assert min(closed, opened) > 100
    assert shut_in


def test_no_way_out_is_no_target(space: EnumeratedSpace) -> None:
    q = np.full(6, 0.5)
    everywhere = make_world(0.0, 1.0, np.zeros((4, 1, 3)), np.array([[0.01], [2.0], [2.0], [2.0]]))
    local = temporal_cubes_graph(scene_of(ARM, space, q, 0.0, everywhere, 3), np.zeros(3), True, True)
    assert local.target == -1
    assert len(local.graph.t) == 0


def test_obstacles_are_read_at_whole_seconds_from_now() -> None:
    centers = np.arange(13.0)[:, None, None] * np.ones((1, 1, 3))
    world = make_world(10.0, 0.25, centers, np.linspace(0.1, 0.22, 13)[:, None])
    steps = ObstacleSteps.from_world(world, 11.0, 4, 0.018)
    assert steps.centers_m[:, 0, 0].tolist() == [4, 8, 12, 12, 12]  # held after the last
    np.testing.assert_allclose(steps.reach_m[:, 0], np.array([0.14, 0.18, 0.22, 0.22, 0.22]) + 0.018)


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
