"""The four path problems of Wu et al. (2014) against a list of all paths and against NetworkX."""

import math

import networkx as nx
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from twins.temporal_graph import Edge, arrival, cost, departure, paths, time_expanded

from planners.search.temporal_graph.graph import TemporalGraph, Window

N = 4
LAST = 7

small_edges = st.lists(
    st.tuples(
        st.integers(0, N - 1), st.integers(0, N - 1), st.integers(0, LAST - 1), st.integers(1, 3), st.integers(0, 4)
    ),
    min_size=1,
    max_size=12,
)


@st.composite
def windows(draw: st.DrawFn) -> tuple[Window, int]:
    first = draw(st.integers(-1, LAST))
    return Window(first, draw(st.integers(first, LAST + 2))), draw(st.integers(-1, LAST + 3))


def graph_of(edges: list[Edge], n: int = N) -> TemporalGraph:
    return TemporalGraph(n, *np.array(edges, dtype=float).T.astype(object))


def best(values: list[float], none: float) -> float:
    return (max if none == -math.inf else min)(values, default=none)


@given(small_edges, windows(), st.integers(0, N - 1))
def test_all_four_against_every_path(edges: list[Edge], when: tuple[Window, int], source: int) -> None:
    window, by = when
    graph = graph_of(edges)
    arrivals, fastest, shortest = (
        f(source, window, by) for f in (graph.earliest_arrival, graph.fastest, graph.shortest)
    )
    departures = graph.latest_departure(source, window, by)  # source is the target here
    for v in range(N):
        if v == source:
            continue
        there = [path for path in paths(edges, source, *window, by) if path[-1][1] == v]
        back = [path for path in paths(edges, v, *window, by) if path[-1][1] == source]
        assert arrivals[v] == best([arrival(p) for p in there], math.inf)
        assert fastest[v] == best([arrival(p) - departure(p) for p in there], math.inf)
        assert shortest[v] == best([cost(p) for p in there], math.inf)
        assert departures[v] == best([departure(p) for p in back], -math.inf)


@given(small_edges, windows(), st.integers(0, N - 1), st.integers(0, N - 1))
def test_the_edges_of_a_shortest_path(edges: list[Edge], when: tuple[Window, int], source: int, target: int) -> None:
    window, by = when
    if source == target:
        window = Window(window.first, window.first)
    graph = graph_of(edges)
    found = graph.shortest_path(source, target, window, by)
    known = [path for path in paths(edges, source, *window, by) if path[-1][1] == target]
    if found is None:
        assert not known
        return
    path = [tuple(array[e] for array in (graph.u, graph.v, graph.t, graph.mu, graph.d)) for e in found]
    assert path in known  # it starts, connects and ends as a path must
    least = min(cost(p) for p in known)
    assert cost(path) == least
    assert arrival(path) == min(arrival(p) for p in known if cost(p) == least)


@given(small_edges, windows(), st.integers(0, N - 1))
def test_with_waiting_everywhere_these_are_the_problems_of_wu(
    edges: list[Edge], when: tuple[Window, int], source: int
) -> None:
    first, by = when[0].first, when[1]
    waits = [(v, v, t, 1, 0) for v in range(N) for t in range(-1, LAST + 4)]
    graph, window = graph_of(edges + waits), Window(first, by)
    arrivals, fastest, shortest = (
        f(source, window, by) for f in (graph.earliest_arrival, graph.fastest, graph.shortest)
    )
    departures = graph.latest_departure(source, window, by)
    for v in range(N):
        if v == source:
            continue
        there = [path for path in paths(edges, source, first, by, by, free_waiting=True) if path[-1][1] == v]
        back = [path for path in paths(edges, v, first, by, by, free_waiting=True) if path[-1][1] == source]
        assert arrivals[v] == best([arrival(p) for p in there], math.inf)
        assert fastest[v] == best([arrival(p) - departure(p) for p in there], math.inf)
        assert shortest[v] == best([cost(p) for p in there], math.inf)
        assert departures[v] == best([departure(p) for p in back], -math.inf)


@pytest.mark.parametrize("seed", range(3))
def test_large_graphs_against_networkx(seed: int) -> None:
    rng = np.random.default_rng(seed)
    n, m, last = 60, 12_000, 40
    edges = [
        (int(u), int(v), int(t), int(mu), float(d))
        for u, v, t, mu, d in zip(
            rng.integers(n, size=m), rng.integers(n, size=m), rng.integers(last, size=m),
            rng.integers(1, 4, size=m), rng.uniform(0, 1, size=m), strict=True,
        )
    ]  # fmt: skip
    graph, expanded = graph_of(edges, n), time_expanded(edges)
    source, window, by = 0, Window(2, 6), 30
    entry = [(source, t) for t in range(window.first, window.last + 1) if expanded.has_node((source, t))]
    costs = nx.multi_source_dijkstra_path_length(expanded, set(entry), weight="d")
    reached = {t: nx.descendants(expanded, (source, t)) | {(source, t)} for _, t in entry}
    arrivals, fastest, shortest = (
        f(source, window, by) for f in (graph.earliest_arrival, graph.fastest, graph.shortest)
    )
    some = 0
    for v in range(1, n):
        labels = {time: c for (w, time), c in costs.items() if w == v and time <= by}
        assert shortest[v] == pytest.approx(min(labels.values(), default=math.inf))
        assert arrivals[v] == min(labels, default=math.inf)
        spans = [time - start for start, nodes in reached.items() for w, time in nodes if w == v and time <= by]
        assert fastest[v] == min(spans, default=math.inf)
        some += len(labels) > 0
        found = graph.shortest_path(source, v, window, by)
        if found is not None:
            assert graph.d[found].sum() == pytest.approx(shortest[v])
            assert (graph.u[found[1:]] == graph.v[found[:-1]]).all()
            assert (graph.t[found[1:]] == (graph.t + graph.mu)[found[:-1]]).all()
    assert some > n / 2
    target = 1
    ancestors = {
        node
        for time in range(by + 1)
        if expanded.has_node((target, time))
        for node in nx.ancestors(expanded, (target, time))
    }
    departures = graph.latest_departure(target, window, by)
    for v in range(n):
        if v != target:
            times = [t for w, t in ancestors if w == v and window.first <= t <= window.last]
            assert departures[v] == max(times, default=-math.inf)


A, B, C = 0, 1, 2
TRAP = [(A, B, 0, 1, 5), (A, B, 8, 1, 1), (B, C, 6, 1, 1)]


def with_waiting(edges: list[Edge], n: int, last: int) -> list[Edge]:
    return edges + [(v, v, t, 1, 0) for v in range(n) for t in range(last)]


def test_a_prefix_of_a_shortest_path_need_not_be_shortest() -> None:
    graph = graph_of(with_waiting(TRAP, 3, 10), 3)
    assert graph.shortest(A, Window(0, 10), 10).tolist() == [0, 1, 6]
    path = graph.shortest_path(A, C, Window(0, 10), 10)
    moves = [(graph.u[e], graph.v[e], graph.t[e]) for e in path if graph.u[e] != graph.v[e]]
    assert moves == [(A, B, 0), (B, C, 6)]


def test_no_one_waits_where_there_is_no_edge_for_it() -> None:
    graph = graph_of(TRAP, 3)
    assert graph.shortest(A, Window(0, 10), 10).tolist() == [0, 1, math.inf]
    assert graph.shortest_path(A, C, Window(0, 10), 10) is None
    assert graph.earliest_arrival(A, Window(0, 10), 10)[B] == 1
    # One missing wait on the way is enough.
    gap = [edge for edge in with_waiting(TRAP, 3, 10) if edge[:3] != (B, B, 4)]
    assert graph_of(gap, 3).shortest_path(A, C, Window(0, 10), 10) is None


def test_the_order_of_the_edges_does_not_matter() -> None:
    edges = with_waiting(TRAP, 3, 10)
    for seed in range(5):
        shuffled = [edges[k] for k in np.random.default_rng(seed).permutation(len(edges))]
        np.testing.assert_array_equal(
            graph_of(shuffled, 3).shortest(A, Window(0, 10), 10), graph_of(edges, 3).shortest(A, Window(0, 10), 10)
        )


def test_far_apart_times() -> None:
    graph = graph_of([(0, 1, -(10**9), 1, 1), (1, 2, 1 - 10**9, 2 * 10**9, 1)], 3)
    assert graph.earliest_arrival(0, Window(-(10**9), 0), 2 * 10**9)[2] == 10**9 + 1
    assert graph.fastest(0, Window(-(10**9), 0), 2 * 10**9)[2] == 2 * 10**9 + 1


def test_a_graph_without_edges() -> None:
    graph = TemporalGraph(3, [], [], [], [], [])
    assert graph.shortest(0, Window(0, 5), 5)[1:].tolist() == [math.inf] * 2
    assert graph.earliest_arrival(0, Window(0, 5), 5)[1:].tolist() == [math.inf] * 2
    assert graph.latest_departure(0, Window(0, 5), 5)[1:].tolist() == [-math.inf] * 2
    assert graph.fastest(0, Window(0, 5), 5)[1:].tolist() == [math.inf] * 2
    assert graph.shortest_path(0, 1, Window(0, 5), 5) is None


@pytest.mark.parametrize(
    ("edge", "message"),
    [
        ((0, 3, 0, 1, 1.0), "vertex outside 0 to 2"),
        ((-1, 0, 0, 1, 1.0), "vertex outside"),
        ((0, 1, 0, 0, 1.0), "mu must be at least 1"),
        ((0, 1, 0, 1, -1.0), "negative or NaN"),
        ((0, 1, 0, 1, math.nan), "negative or NaN"),
        ((0, [1, 2], 0, 1, 1.0), "one shape"),
    ],
)
def test_edges_that_are_none_are_refused(edge: tuple, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        TemporalGraph(3, *edge)
