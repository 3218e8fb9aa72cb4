"""Algorithm 1 line by line, and the layered graph written out edge by edge."""

import itertools
import math
from typing import NamedTuple

import networkx as nx
import numpy as np

from twins.clearance import sampled_clearance

Cube = tuple[int, int, int]
CUBE_M = 0.01


def cube_of(point) -> Cube:
    return tuple(int(i) for i in np.floor(np.asarray(point) / CUBE_M))


def by_cube(tips) -> dict[Cube, list[int]]:
    """Numbers of the configurations whose tips are in each cube."""
    found: dict[Cube, list[int]] = {}
    for k, tip in enumerate(tips):
        found.setdefault(cube_of(tip), []).append(k)
    return found


def is_free(q, length, centers, reach) -> bool:
    """``reach``: the obstacles' radii plus the arm's."""
    return sampled_clearance(q, length, 0.0, centers, reach) > 0


def hops(a: Cube, b: Cube) -> int:
    return max(abs(x - y) for x, y in zip(a, b, strict=True))


class Situation(NamedTuple):
    q: np.ndarray
    tip: np.ndarray
    goal: np.ndarray
    centers: np.ndarray
    reach: np.ndarray


class Algorithm1:
    """The temporal cubes-graph, as many hops as there are predicted steps, read at whole seconds.

    Edge (u, v, t) is there when u can be reached at t and v holds a free configuration at t + 1; q_b is the cube
    nearest to the goal, of all that can be reached or of all within so many hops.
    """

    def __init__(self, now: Situation, configurations, cubes, length, waiting, reachable):
        self.h = len(now.centers) - 1
        self.now, self.here = now, cube_of(now.tip)
        self.configurations, self.cubes, self.length = configurations, cubes, length
        self.known: dict[tuple[Cube, int], bool] = {}
        self.edges: set[tuple[Cube, Cube, int]] = set()
        self.reached: list[set[Cube]] = [{self.here}]
        for t in range(self.h):
            self.reached.append(set())
            for u in self.reached[t]:
                for move in itertools.product((-1, 0, 1), repeat=3):
                    v = tuple(a + b for a, b in zip(u, move, strict=True))
                    if (v != u or waiting) and self.is_open(v, t + 1):
                        self.edges.add((u, v, t))
                        self.reached[t + 1].add(v)
        goal_cube = cube_of(now.goal)
        # Equally near ones: the first in the order of x, y, z.
        self.target = min(
            set().union(*self.reached[1:]) if reachable else self.within_hops(),
            key=lambda c: (sum((a - b) ** 2 for a, b in zip(c, goal_cube, strict=True)), c),
            default=None,
        )

    def within_hops(self) -> set[Cube]:
        """Cubes that hold configurations, free or not, as far as h moves from one to the next lead."""
        found = {self.here}
        for _ in range(self.h):
            moves = list(itertools.product((-1, 0, 1), repeat=3))
            near = {tuple(a + b for a, b in zip(u, move, strict=True)) for u in found for move in moves}
            found |= {cube for cube in near if cube in self.cubes}
        return found

    def is_open(self, cube: Cube, t: int) -> bool:
        if (cube, t) not in self.known:
            inside = [self.configurations[k] for k in self.cubes.get(cube, [])]
            inside += [self.now.q] if cube == self.here else []
            self.known[cube, t] = any(is_free(q, self.length, self.now.centers[t], self.now.reach[t]) for q in inside)
        return self.known[cube, t]

    def edges_towards(self, target: Cube) -> set[tuple[Cube, Cube, int]]:
        """Those on which a path to ``target`` can lie, by hops alone."""
        return {(u, v, t) for u, v, t in self.edges if hops(v, target) <= self.h - t - 1}

    def least_cost(self) -> float:
        """Cost of a cheapest path to q_b, by NetworkX in the time-expanded graph."""
        graph = nx.DiGraph()
        graph.add_node((self.here, 0))
        for u, v, t in self.edges:
            graph.add_edge((u, t), (v, t + 1), d=CUBE_M * math.dist(u, v))
        costs = nx.single_source_dijkstra_path_length(graph, (self.here, 0), weight="d")
        return min((cost for (cube, t), cost in costs.items() if cube == self.target and t > 0), default=math.inf)


def orientation_change(q0, q1) -> float:
    """The paper's Delta (section II-D) by its own letters, theta wrapped; a straight section has any theta."""
    total = 0.0
    for (u0, v0), (u1, v1) in zip(np.reshape(q0, (-1, 2)), np.reshape(q1, (-1, 2)), strict=True):
        phi0, phi1 = math.hypot(u0, v0), math.hypot(u1, v1)
        turn = math.remainder(math.atan2(v1, u1) - math.atan2(v0, u0), 2 * math.pi) if min(phi0, phi1) > 1e-9 else 0.0
        total += math.sqrt(turn**2 + (phi1 - phi0) ** 2)
    return total


def layered_graph(layers) -> nx.DiGraph:
    """Every configuration of a layer joined to every one of the next; "end" behind the last layer."""
    graph = nx.DiGraph()
    for k, (before, after) in enumerate(itertools.pairwise(layers)):
        for (a, p), (b, q) in itertools.product(enumerate(before), enumerate(after)):
            graph.add_edge((k, a), (k + 1, b), weight=orientation_change(p, q))
    for b in range(len(layers[-1])):
        graph.add_edge((len(layers) - 1, b), "end", weight=0.0)
    return graph
