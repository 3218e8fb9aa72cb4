"""Temporal paths by listing all of them, and by NetworkX in the time-expanded graph."""

import math
from collections.abc import Iterator

import networkx as nx

Edge = tuple[int, int, int, int, float]
"""(u, v, t, mu, d)"""


def paths(
    edges: list[Edge], source: int, first: int, last: int, arrive_by: int, free_waiting: bool = False
) -> Iterator[list[Edge]]:
    """Every path of one or more edges that leaves ``source`` within [first, last] and arrives by ``arrive_by``."""

    def extend(path: list[Edge]) -> Iterator[list[Edge]]:
        yield path
        _, here, left, mu, _ = path[-1]
        now = left + mu
        for edge in edges:
            on_time = edge[2] >= now if free_waiting else edge[2] == now
            if edge[0] == here and on_time and edge[2] + edge[3] <= arrive_by:
                yield from extend([*path, edge])

    for edge in edges:
        if edge[0] == source and first <= edge[2] <= last and edge[2] + edge[3] <= arrive_by:
            yield from extend([edge])


def departure(path: list[Edge]) -> int:
    return path[0][2]


def arrival(path: list[Edge]) -> int:
    return path[-1][2] + path[-1][3]


def cost(path: list[Edge]) -> float:
    return math.fsum(edge[4] for edge in path)


def time_expanded(edges: list[Edge]) -> nx.DiGraph:
    """Vertices (u, time); of parallel edges the cheapest."""
    graph = nx.DiGraph()
    for u, v, t, mu, d in edges:
        known = graph.get_edge_data((u, t), (v, t + mu))
        if known is None or d < known["d"]:
            graph.add_edge((u, t), (v, t + mu), d=d)
    return graph
