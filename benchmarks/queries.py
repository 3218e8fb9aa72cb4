"""Queries as they arise in trials: a scenario, and what the planner was asked on its way."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from benchmarks.literal import Query
from planners import Observation, build_predictor
from planners.paper.temporal import READINGS
from planners.search.configurations import enumerated_space
from planners.search.cube_paths import _kernels
from planners.search.layers import call, empty_layers
from planners.search.scene import Scene, scene_of
from scenarios import Scenario, generate
from scenarios.arm import FloatArray

SPACING_RAD = 0.5


class Solved(NamedTuple):
    """What the planner finds for a query."""

    cubes: list[int]
    """Cube numbers along the path, none where there is no path."""
    configurations_rad: FloatArray
    """The smoothest path through them, shape (k, dof) [rad]; no rows where there is none."""


def scene(query: Query) -> Scene:
    """The query as the kernels take it."""
    return scene_of(query.arm, query.space, query.q, query.now_s, query.world, query.horizon)


def solve(query: Query) -> Solved:
    """The search of ``planners.paper.temporal``."""
    space = query.space
    layers = empty_layers(space.n_sections, len(space.bends_rad), query.horizon)
    reading = _kernels.Reading(READINGS[query.transitions], query.target == "reachable", True)
    goal = space.cube_of(query.goal_m)
    _, (cubes, path) = call(_kernels.plan, layers, scene(query), goal, query.horizon, reading)
    return Solved(cubes.tolist(), path)


def scenarios(n_obstacles: int, count: int) -> list[Scenario]:
    """Scenarios of the paper's family."""
    return generate("orbit", n_obstacles, count, seed=0)


def along(scenario: Scenario, horizon: int, transitions: str = "edges", target: str = "closest") -> Iterator[Query]:
    """The queries of one trial at ``horizon``: each begins where the path of the one before ended.

    Ends when the goal is reached, there is no path, or time is up.
    """
    arm, q, now_s = scenario.arm, scenario.start, 0.0
    space, predictor = enumerated_space(arm, SPACING_RAD), build_predictor("cubic", scenario)
    while now_s < scenario.time_limit_s and np.linalg.norm(arm.tip(q) - scenario.goal) > scenario.goal_tolerance_m:
        times = np.arange(-scenario.observation_s, now_s + 1.0)
        centers = np.stack([obstacle.position(times) for obstacle in scenario.obstacles], axis=1)
        observation = Observation(times, centers, np.array([obstacle.radius_m for obstacle in scenario.obstacles]))
        world = predictor.predict(observation, float(horizon), 1.0).world(0.0)
        query = Query(arm, space, q, scenario.goal, world, now_s, transitions, target)
        yield query
        solved = solve(query)
        if not len(solved.configurations_rad):
            return
        q, now_s = solved.configurations_rad[-1], now_s + len(solved.configurations_rad) - 1.0
