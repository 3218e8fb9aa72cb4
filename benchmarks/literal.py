"""Algorithms 1 and 2 of the paper, read literally: plain Python, NetworkX and NumPy.

Every cube within h hops is checked at every step, all of its configurations at once in NumPy; the temporal graph is
expanded over time and searched by NetworkX; so is the layered graph, by Bellman-Ford. Two readings are the planner's
own: q_b is the nearest to the goal of the cubes that can be reached, and a cube at a time is open when it holds a free
configuration then.
"""

from __future__ import annotations

import itertools
import math
from typing import NamedTuple

import networkx as nx
import numpy as np

from planners.search.configurations import EnumeratedSpace
from planners.search.cubes import ObstacleSteps
from scenarios import ContinuumArm
from scenarios.arm import FloatArray

Cube = tuple[int, int, int]
State = tuple[Cube, int]

MOVES = list(itertools.product((-1, 0, 1), repeat=3))
STRAIGHT_RAD = 1e-9


class Query(NamedTuple):
    """One round of Algorithm 2."""

    arm: ContinuumArm
    space: EnumeratedSpace
    q: FloatArray
    """Present configuration, shape (dof,), [rad]."""
    goal_m: FloatArray
    obstacles: ObstacleSteps
    """Predicted obstacles; one row per step, as many as the horizon and the present."""

    @property
    def horizon(self) -> int:
        """Number of steps ahead, h."""
        return len(self.obstacles.centers_m) - 1


class Answer(NamedTuple):
    """What lines 7 to 10 of Algorithm 2 find."""

    q_b: Cube
    squared_to_goal: int
    """Squared distance of q_b from the goal's cube, in cubes."""
    cubes: list[Cube]
    """The shortest temporal cube path, one cube per step."""
    length_m: float
    """Its length."""
    configurations_rad: FloatArray
    """The smoothest path through it, shape (steps + 1, dof)."""


def solve(query: Query) -> Answer | None:
    """Predicted obstacles in, timed configurations out; None where no cube can be reached."""
    here, there = _cube_of(query.space, query.arm.tip(query.q)), _cube_of(query.space, query.goal_m)
    graph = _time_expanded(query, here)
    cost, paths = nx.single_source_dijkstra(graph, (here, 0), weight="d")
    arrivals = [state for state in cost if state[1] > 0]
    if not arrivals:
        return None
    q_b = min((_squared(cube, there), cube) for cube, _ in arrivals)[1]
    end = min((state for state in arrivals if state[0] == q_b), key=lambda state: (cost[state], state[1]))
    cubes = [cube for cube, _ in paths[end]]
    return Answer(q_b, _squared(q_b, there), cubes, cost[end], smoothest(query, cubes))


def _time_expanded(query: Query, here: Cube) -> nx.DiGraph:
    """Algorithm 1: the cubes within h hops, and an edge for every move that ends in an open cube."""
    hops = {here: 0}
    queue = [here]
    for cube in queue:  # breadth first: the list grows while it is read
        if hops[cube] < query.horizon:
            for other in _around(cube):
                if other not in hops and (other == here or _codes(query.space, other).size):
                    hops[other] = hops[cube] + 1
                    queue.append(other)
    is_open = {(cube, t): _is_open(query, cube, t, here) for cube in hops for t in range(1, query.horizon + 1)}
    is_open[here, 0] = True
    graph = nx.DiGraph()
    graph.add_node((here, 0))
    for (cube, t), free in is_open.items():
        if free and t < query.horizon:
            for other in _around(cube):
                if is_open.get((other, t + 1)):
                    graph.add_edge((cube, t), (other, t + 1), d=query.space.cube_m * math.dist(cube, other))
    return graph


def smoothest(query: Query, cubes: list[Cube]) -> FloatArray:
    """The layered graph over a path of cubes and its shortest path by Bellman-Ford: configurations (steps + 1, dof)."""
    layers = [query.q[None]]
    for step, cube in enumerate(cubes[1:], start=1):
        configurations = _configurations(query, cube, cubes[0])
        layers.append(configurations[_clearances(query, configurations, step) > 0.0])
    graph = nx.DiGraph()
    for step, (before, after) in enumerate(itertools.pairwise(layers)):
        for (a, one), (b, other) in itertools.product(enumerate(before), enumerate(after)):
            graph.add_edge((step, a), (step + 1, b), s=smoothness(one, other))
    cost, paths = nx.single_source_bellman_ford(graph, (0, 0), weight="s")
    last = len(layers) - 1
    end = min((node for node in cost if node[0] == last), key=lambda node: (cost[node], node))
    return np.array([layers[step][k] for step, k in paths[end]])


def smoothness(one: FloatArray, other: FloatArray) -> float:
    """Orientation change between two configurations (dof,) (paper, section II-D), theta wrapped [rad]."""
    total = 0.0
    for (u0, v0), (u1, v1) in zip(one.reshape(-1, 2), other.reshape(-1, 2), strict=True):
        phi0, phi1, turn = math.hypot(u0, v0), math.hypot(u1, v1), 0.0
        if phi0 > STRAIGHT_RAD and phi1 > STRAIGHT_RAD:
            turn = abs(math.atan2(v1, u1) - math.atan2(v0, u0))
            turn = min(turn, 2.0 * math.pi - turn)
        total += math.hypot(turn, phi1 - phi0)
    return total


def path_smoothness(configurations: FloatArray) -> float:
    """Smoothness of a path (k, dof) [rad]."""
    return sum(smoothness(one, other) for one, other in itertools.pairwise(configurations))


def _is_open(query: Query, cube: Cube, step: int, here: Cube) -> bool:
    configurations = _configurations(query, cube, here)
    return bool((_clearances(query, configurations, step) > 0.0).any())


def _configurations(query: Query, cube: Cube, here: Cube) -> FloatArray:
    """Those enumerated in the cube, (N, dof); the present one counts as one of its own cube's."""
    inside = query.space.decode(_codes(query.space, cube))
    return np.vstack([query.q, inside]) if cube == here else inside


def _clearances(query: Query, configurations: FloatArray, step: int) -> FloatArray:
    """Distance of each configuration (N, dof) from the obstacles at ``step``, arcs exact: (N,) [m]."""
    centers, reach = query.obstacles.centers_m[step], query.obstacles.reach_m[step]
    nearest = np.full(len(configurations), np.inf)
    turn, base = np.tile(np.eye(3), (len(configurations), 1, 1)), np.zeros((len(configurations), 3))
    for u, v in configurations.reshape(len(configurations), -1, 2).transpose(1, 2, 0):
        phi = np.maximum(np.hypot(u, v), 1e-6)
        theta = np.arctan2(v, u)
        c, s = np.cos(theta), np.sin(theta)
        radius = (query.arm.section_length_m / phi)[:, None]
        toward = turn[:, :, 0] * c[:, None] + turn[:, :, 1] * s[:, None]
        normal = turn[:, :, 1] * c[:, None] - turn[:, :, 0] * s[:, None]
        tangent = turn[:, :, 2]
        sin, cos = np.sin(phi)[:, None], np.cos(phi)[:, None]
        end = base + radius * (1.0 - cos) * toward + radius * sin * tangent
        to = centers - base[:, None]
        inward = radius - np.einsum("nmk,nk->nm", to, toward)
        beside = np.einsum("nmk,nk->nm", to, normal)
        along = np.einsum("nmk,nk->nm", to, tangent)
        on_arc = np.hypot(np.hypot(inward, along) - radius, beside)
        at_ends = np.minimum(np.linalg.norm(to, axis=2), np.linalg.norm(centers - end[:, None], axis=2))
        distance = np.where((along >= 0.0) & (sin * inward >= cos * along), on_arc, at_ends)
        nearest = np.minimum(nearest, (distance - reach).min(axis=1, initial=np.inf))
        bent, onward = cos * toward - sin * tangent, cos * tangent + sin * toward
        turn = np.stack(
            [c[:, None] * bent - s[:, None] * normal, s[:, None] * bent + c[:, None] * normal, onward], axis=2
        )
        base = end
    return nearest


def _around(cube: Cube) -> list[Cube]:
    """The cube itself and those it touches."""
    x, y, z = cube
    return [(x + i, y + j, z + k) for i, j, k in MOVES]


def _codes(space: EnumeratedSpace, cube: Cube) -> np.ndarray:
    side = 2 * space.half
    if min(cube) < 0 or max(cube) >= side:
        return space.codes[:0]
    number = (cube[0] * side + cube[1]) * side + cube[2]
    return space.codes[space.offsets[number] : space.offsets[number + 1]]


def _cube_of(space: EnumeratedSpace, point_m: FloatArray) -> Cube:
    x, y, z = (int(i) + space.half for i in np.floor(np.asarray(point_m) / space.cube_m))
    return x, y, z


def _squared(cube: Cube, other: Cube) -> int:
    return sum((a - b) ** 2 for a, b in zip(cube, other, strict=True))
