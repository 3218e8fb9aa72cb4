"""Queries as they arise in trials: a scenario, and what the planner was asked on its way."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from benchmarks.literal import Query
from planners import Observation, build_predictor
from planners.search.configurations import enumerated_space
from planners.search.cubes import LayeredGraph, LocalGraph, ObstacleSteps, temporal_cubes_graph
from planners.search.temporal_graph.graph import Window
from scenarios import Scenario, generate
from scenarios.arm import FloatArray

SPACING_RAD = 0.5
WAITING = True


class Solved(NamedTuple):
    """What the planner finds for a query."""

    local: LocalGraph
    cubes: list[int]
    """Cube numbers along the path."""
    length_m: float
    configurations_rad: FloatArray


def solve(query: Query) -> Solved | None:
    """The search of ``planners.paper.temporal``, with what lies between its steps."""
    arm, space, q, goal_m, obstacles = query
    local = temporal_cubes_graph(arm, space, q, goal_m, obstacles, WAITING)
    edges = local.graph.shortest_path(local.source, local.target, Window(0, 0), query.horizon)
    if local.target < 0 or edges is None:
        return None
    cubes = [int(local.cubes[v]) for v in (local.source, *local.graph.v[edges])]
    path = LayeredGraph(arm, space, q, cubes, obstacles).smoothest_path()
    return None if path is None else Solved(local, cubes, float(local.graph.d[edges].sum()), path)


def scenarios(n_obstacles: int, count: int) -> list[Scenario]:
    """Scenarios of the paper's family."""
    return generate("orbit", n_obstacles, count, seed=0)


def along(scenario: Scenario, horizon: int) -> Iterator[Query]:
    """The queries of one trial at ``horizon``: each begins where the path of the one before ended.

    Ends when the goal's cube is reached, nothing can be reached, or time is up.
    """
    arm, q, now_s = scenario.arm, scenario.start, 0.0
    space, predictor = enumerated_space(arm, SPACING_RAD), build_predictor("cubic", scenario)
    while now_s < scenario.time_limit_s and np.linalg.norm(arm.tip(q) - scenario.goal) > scenario.goal_tolerance_m:
        times = np.arange(-scenario.observation_s, now_s + 1.0)
        centers = np.stack([obstacle.position(times) for obstacle in scenario.obstacles], axis=1)
        observation = Observation(times, centers, np.array([obstacle.radius_m for obstacle in scenario.obstacles]))
        world = predictor.predict(observation, float(horizon), 1.0).world(0.0)
        query = Query(arm, space, q, scenario.goal, ObstacleSteps.from_world(world, now_s, horizon, arm.radius_m))
        yield query
        solved = solve(query)
        if solved is None:
            return
        q, now_s = solved.configurations_rad[-1], now_s + len(solved.configurations_rad) - 1.0
