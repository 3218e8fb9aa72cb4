"""Algorithms 1 and 2 of the paper, read literally: plain Python, NetworkX and NumPy.

Every cube within h hops is checked at every step, all of its configurations at once in NumPy; every edge is asked for
every pair of configurations until one can be moved; the temporal graph is expanded over time and searched by NetworkX;
so is the layered graph, by Bellman-Ford. A motion is sampled at equal shares, which proves it free where the clearance
exceeds what can happen between two samples, and hit where a sample touches; the shared motion validator decides on the
few that graze.
"""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Iterator
from typing import NamedTuple

import networkx as nx
import numpy as np

from planners.search.configurations import EnumeratedSpace
from planners.search.scene import ObstacleSteps
from scenarios import ContinuumArm, SampledWorld, is_motion_valid
from scenarios.arm import FloatArray

Cube = tuple[int, int, int]
Place = tuple[Cube, int]
"""A cube and the number of a configuration in it."""

MOVES = list(itertools.product((-1, 0, 1), repeat=3))
STRAIGHT_RAD = 1e-9
SAMPLES = 128


class Query(NamedTuple):
    """One round of Algorithm 2."""

    arm: ContinuumArm
    space: EnumeratedSpace
    q: FloatArray
    """Present configuration, shape (dof,), [rad]."""
    goal_m: FloatArray
    world: SampledWorld
    """Predicted obstacles from ``now_s`` on, a sample per step, as many as the horizon and the present."""
    now_s: float = 0.0
    transitions: str = "edges"
    target: str = "closest"

    @property
    def horizon(self) -> int:
        """Number of steps ahead, h."""
        return len(self.world.centers_m) - 1

    @property
    def obstacles(self) -> ObstacleSteps:
        """Obstacles at whole steps."""
        return ObstacleSteps.from_world(self.world, self.now_s, self.horizon, self.arm.radius_m)


class Answer(NamedTuple):
    """What lines 7 to 10 of Algorithm 2 find."""

    q_b: Cube
    squared_to_goal: int
    """Squared distance of q_b from the goal's cube, in cubes."""
    length_m: float
    """Length of a shortest temporal cube path to q_b; inf where there is none."""


class Round:
    """One round of Algorithm 2, with what was found out in it remembered."""

    def __init__(self, query: Query) -> None:
        """Find the cubes within h hops by breadth-first search."""
        self.query = query
        self.here, self.goal = _cube_of(query.space, query.arm.tip(query.q)), _cube_of(query.space, query.goal_m)
        hops = {self.here: 0}
        queue = [self.here]
        for cube in queue:  # the list grows while it is read
            if hops[cube] < query.horizon:
                for other in _around(cube):
                    if other not in hops and _codes(query.space, other).size:
                        hops[other] = hops[cube] + 1
                        queue.append(other)
        self.cubes = list(hops)
        self.layer = functools.cache(self._layer)
        self.is_free = functools.cache(self._is_free)

    def solve(self) -> Answer | None:
        """Lines 7 and 8: G_T, q_b and the length of a shortest path; None where no cube can be reached."""
        chained = self.query.transitions == "chained"
        graph = self._configurations_graph() if chained else self._cubes_graph()
        start = ((self.here, 0), 0) if chained else (self.here, 0)
        cost = nx.single_source_dijkstra_path_length(graph, start, weight="d")
        length: dict[Cube, float] = {}
        for (place, step), d in cost.items():
            if step > 0:
                cube = place[0] if chained else place
                length[cube] = min(length.get(cube, math.inf), d)
        candidates = self.cubes if self.query.target == "closest" else list(length)
        if not candidates:
            return None
        q_b = min((self.squared(cube), cube) for cube in candidates)[1]
        return Answer(q_b, self.squared(q_b), length.get(q_b, math.inf))

    def squared(self, cube: Cube) -> int:
        """Squared distance from the goal's cube, in cubes."""
        return sum((a - b) ** 2 for a, b in zip(cube, self.goal, strict=True))

    def _cubes_graph(self) -> nx.DiGraph:
        """Algorithm 1, expanded over time."""
        graph = nx.DiGraph()
        graph.add_node((self.here, 0))
        for step in range(self.query.horizon):
            for cube in [self.here] if step == 0 else self.cubes:
                if graph.has_node((cube, step)):  # else nothing leads there
                    for other in _around(cube):
                        if other in self.cubes and self._is_edge(cube, other, step):
                            d = self.query.space.cube_m * math.dist(cube, other)
                            graph.add_edge((cube, step), (other, step + 1), d=d)
        return graph

    def _is_edge(self, cube: Cube, other: Cube, step: int) -> bool:
        """Line 4 of Algorithm 1."""
        if self.query.transitions != "edges":
            return len(self.layer(other, step + 1)) > 0
        return any(self.is_free((cube, a), (other, b), step) for a, b in self.pairs(cube, other, step))

    def pairs(self, cube: Cube, other: Cube, step: int) -> Iterator[tuple[int, int]]:
        """All pairs of free configurations, the smallest change of orientation first: they are the likeliest."""
        before, after = self.layer(cube, step), self.layer(other, step + 1)
        pairs = itertools.product(range(len(before)), range(len(after)))
        return iter(sorted(pairs, key=lambda pair: smoothness(before[pair[0]], after[pair[1]])))

    def _configurations_graph(self) -> nx.DiGraph:
        """Which configuration can move to which, from the present one on; lengths are those of the cubes' edges."""
        graph = nx.DiGraph()
        reached: list[Place] = [(self.here, 0)]
        graph.add_node((reached[0], 0))
        for step in range(self.query.horizon):
            following: dict[Place, None] = {}
            for cube, a in reached:
                for other in _around(cube):
                    for b in range(len(self.layer(other, step + 1))) if other in self.cubes else ():
                        if self.is_free((cube, a), (other, b), step):
                            d = self.query.space.cube_m * math.dist(cube, other)
                            graph.add_edge(((cube, a), step), ((other, b), step + 1), d=d)
                            following[other, b] = None
            reached = list(following)
        return graph

    def smoothest(self, cubes: list[Cube]) -> FloatArray | None:
        """The layered graph over a path of cubes and its shortest path by Bellman-Ford: (steps + 1, dof)."""
        graph, looked_at = nx.DiGraph(), self.query.transitions != "steps"
        graph.add_node((0, 0))
        for step, (cube, other) in enumerate(itertools.pairwise(cubes)):
            before, after = self.layer(cube, step), self.layer(other, step + 1)
            for a, b in itertools.product(range(len(before) if step else 1), range(len(after))):
                if not looked_at or self.is_free((cube, a), (other, b), step):
                    graph.add_edge((step, a), (step + 1, b), s=smoothness(before[a], after[b]))
        cost, paths = nx.single_source_bellman_ford(graph, (0, 0), weight="s")
        ends = [node for node in cost if node[0] == len(cubes) - 1]
        if not ends:
            return None
        end = min(ends, key=lambda node: (cost[node], node))
        return np.array([self.layer(cubes[step], step)[k] for step, k in paths[end]])

    def _layer(self, cube: Cube, step: int) -> FloatArray:
        """Free configurations of a cube at a step, (N, dof); the present one counts as one of its own cube's."""
        query = self.query
        inside = query.space.decode(_codes(query.space, cube))
        if cube == self.here:
            inside = np.vstack([query.q, inside])
        centers = np.broadcast_to(
            query.obstacles.centers_m[step], (len(inside), *query.obstacles.centers_m[step].shape)
        )
        free = _clearances(query.arm, inside, centers, query.obstacles.reach_m[step]) > 0.0
        free[:1] |= cube == self.here and step == 0  # that is where the arm is
        return np.asarray(inside[free])

    def _is_free(self, before: Place, after: Place, step: int) -> bool:
        """Whether the motion touches nothing at any instant of [step, step + 1]."""
        query = self.query
        q0, q1 = self.layer(before[0], step)[before[1]], self.layer(after[0], step + 1)[after[1]]
        shares = np.linspace(0.0, 1.0, SAMPLES + 1)
        states = q0 + shares[:, None] * (q1 - q0)
        ends, reach = query.obstacles.centers_m[step : step + 2], query.obstacles.reach_m[step : step + 2]
        centers = ends[0] + shares[:, None, None] * (ends[1] - ends[0])
        gap = float(_clearances(query.arm, states, centers, reach.max(axis=0)).min())
        turns = np.linalg.norm((q1 - q0).reshape(-1, 2), axis=1)
        # The tip is the point that moves most: each section bends half of itself and carries what lies beyond.
        way = query.arm.section_length_m * (turns * (np.arange(len(turns), 0, -1) - 0.5)).sum()
        between = (way + np.linalg.norm(ends[1] - ends[0], axis=1).max(initial=0.0)) / (2 * SAMPLES)
        if gap <= 0.0 and (reach[0] == reach[1]).all():
            return False
        if gap > between + 2e-4:
            return True
        return is_motion_valid(query.arm, q0, query.now_s + step, q1, query.now_s + step + 1.0, query.world)


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


def _clearances(arm: ContinuumArm, configurations: FloatArray, centers: FloatArray, reach: FloatArray) -> FloatArray:
    """Distance of each configuration (N, dof) from its own spheres (N, m, 3), (m,), arcs exact: (N,) [m]."""
    nearest = np.full(len(configurations), np.inf)
    turn, base = np.tile(np.eye(3), (len(configurations), 1, 1)), np.zeros((len(configurations), 3))
    for u, v in configurations.reshape(len(configurations), -1, 2).transpose(1, 2, 0):
        phi = np.maximum(np.hypot(u, v), 1e-6)
        theta = np.arctan2(v, u)
        c, s = np.cos(theta), np.sin(theta)
        radius = (arm.section_length_m / phi)[:, None]
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
