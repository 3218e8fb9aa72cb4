"""The temporal planner against the literal reading, and how its graph grows with the horizon."""

from __future__ import annotations

import itertools
import math
from functools import partial

import numpy as np

from benchmarks import literal, queries
from benchmarks.timing import Line, cpu_seconds, seconds_per_call
from planners.search.cubes import temporal_cubes_graph

TOLERANCE = 1e-9
READINGS = (
    ("t3's reading", "edges", "closest", ((3, "<= 1"), (6, ""), (10, "<= 20"))),
    ("temporal-best's", "chained", "reachable", ((3, "<= 2"), (6, ""))),
)
"""Name, transitions, target, and horizons with what a solve may take [ms]."""


def against_literal(quick: bool) -> list[Line]:
    """Same queries, same answers, both timed; raises AssertionError where an answer differs."""
    lines = []
    for name, transitions, target, depths in READINGS:
        few = [
            query
            for scenario in queries.scenarios(5, 1 if quick else 2)
            for query in itertools.islice(queries.along(scenario, 2, transitions, target), 1 if quick else 2)
        ]
        fast, slow = np.array([_ratio(query) for query in few]).T
        lines += [
            Line(f"{name}, h = 2: queries with the same answers", len(few), "queries"),
            Line(f"{name}, h = 2: literal, CPU time of a query, median", float(np.median(slow)), "s"),
            Line(f"{name}, h = 2: literal / planner, median", float(np.median(slow / fast)), "x", ">= 500"),
        ]
        for horizon, target_ms in depths:
            many = [
                query
                for n in (1, 3, 5, 6)
                for scenario in queries.scenarios(n, 2 if quick else 10)
                for query in queries.along(scenario, horizon, transitions, target)
            ]
            times = [seconds_per_call([partial(queries.solve, query)], 0.0, rounds=2)[0] for query in many]
            title = f"{name}, h = {horizon}: search, CPU time"
            lines += [
                Line(f"{title}, median", 1e3 * float(np.median(times)), "ms", target_ms),
                Line(f"{title}, 95th percentile", 1e3 * float(np.percentile(times, 95)), "ms"),
            ]
    return lines


def growth(quick: bool) -> list[Line]:
    """Median time to build the temporal cubes-graph over h = 2..20, and the exponent of its growth."""
    depths = (2, 3, 5, 8, 12, 20) if quick else tuple(range(2, 21, 2))
    drawn = queries.scenarios(5, 4 if quick else 20)
    medians = []
    for h in depths:
        first = [next(queries.along(scenario, h)) for scenario in drawn]
        medians.append(
            float(np.median([seconds_per_call([partial(_build, query)], 0.0, rounds=3)[0] for query in first]))
        )
    exponent = np.polyfit(np.log(depths), np.log(medians), 1)[0]
    return [
        *(Line(f"temporal graph, h = {h}: median", 1e3 * t, "ms") for h, t in zip(depths, medians, strict=True)),
        Line("temporal graph: exponent of growth, h = 2..20", float(exponent), ""),
    ]


def _ratio(query: literal.Query) -> tuple[float, float]:
    """CPU seconds of the planner's search and of the literal one, their answers compared."""
    solved = queries.solve(query)
    slow = cpu_seconds(partial(_compare, query, solved))
    return seconds_per_call([lambda: queries.solve(query)], 0.02, rounds=5)[0], slow


def _compare(query: literal.Query, solved: queries.Solved) -> None:
    """Read the query literally, and compare what comes out."""
    algorithm = literal.Round(query)
    answer = algorithm.solve()
    if answer is None or math.isinf(answer.length_m):
        assert not solved.cubes, "a path where there is none"
        return
    side = 2 * query.space.half
    cubes = [(c // (side * side), c // side % side, c % side) for c in solved.cubes]
    assert algorithm.squared(cubes[-1]) == answer.squared_to_goal, "q_b: another distance to the goal"
    length = math.fsum(query.space.cube_m * math.dist(a, b) for a, b in itertools.pairwise(cubes))
    assert math.isclose(length, answer.length_m, abs_tol=TOLERANCE), "cube path: another cost"
    same = algorithm.smoothest(cubes)
    assert (same is None) == (not len(solved.configurations_rad)), "layered graph: a path where there is none"
    if same is not None:
        ours, theirs = (literal.path_smoothness(path) for path in (solved.configurations_rad, same))
        assert math.isclose(ours, theirs, abs_tol=TOLERANCE), "layered path: another smoothness"


def _build(query: literal.Query) -> object:
    return temporal_cubes_graph(queries.scene(query), query.goal_m, True, True)
