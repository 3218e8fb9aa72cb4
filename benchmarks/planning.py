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


def against_literal(quick: bool) -> list[Line]:
    """Same queries, same answers, both timed; raises AssertionError where an answer differs."""
    few = list(itertools.islice(queries.along(queries.scenarios(5, 1)[0], 3), 2 if quick else 8))
    fast, slow = np.array([_ratio(query) for query in few]).T
    lines = [
        Line("h = 3: queries with the same answers", len(few), "queries"),
        Line("h = 3: literal reading, CPU time of a query, median", 1e3 * float(np.median(slow)), "ms"),
        Line("h = 3: planner's search, CPU time of a query, median", 1e3 * float(np.median(fast)), "ms"),
        Line("h = 3: literal / planner, median", float(np.median(slow / fast)), "x", ">= 500"),
    ]
    deep = [
        query
        for n in ((6,) if quick else (1, 6))
        for query in itertools.islice(queries.along(queries.scenarios(n, 1)[0], 10), 1 if quick else None)
    ]
    fast, slow = np.array([_ratio(query) for query in deep]).T
    many = [q for n in (1, 3, 5, 6) for s in queries.scenarios(n, 2 if quick else 10) for q in queries.along(s, 10)]
    solves = [seconds_per_call([partial(queries.solve, query)], 0.0, rounds=2)[0] for query in many]
    return [
        *lines,
        Line("h = 10: queries with the same answers", len(deep), "queries"),
        Line("h = 10: literal / planner, median", float(np.median(slow / fast)), "x"),
        Line("h = 10: planner's search, CPU time, median", 1e3 * float(np.median(solves)), "ms", "<= 20"),
        Line("h = 10: planner's search, CPU time, 95th percentile", 1e3 * float(np.percentile(solves, 95)), "ms"),
    ]


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
    answers: list[literal.Answer | None] = []
    slow = cpu_seconds(lambda: answers.append(literal.solve(query)))
    solved = queries.solve(query)
    assert (answers[0] is None) == (solved is None), "one finds a path where the other finds none"
    if answers[0] is not None and solved is not None:
        _compare(query, answers[0], solved)
    return seconds_per_call([lambda: queries.solve(query)], 0.02, rounds=5)[0], slow


def _compare(query: literal.Query, answer: literal.Answer, solved: queries.Solved) -> None:
    side = 2 * query.space.half
    cubes = [(c // (side * side), c // side % side, c % side) for c in solved.cubes]
    goal = query.space.cube_of(query.goal_m)
    there = (goal // (side * side), goal // side % side, goal % side)
    squared = sum((a - b) ** 2 for a, b in zip(cubes[-1], there, strict=True))
    assert squared == answer.squared_to_goal, "q_b: another distance to the goal"
    assert math.isclose(solved.length_m, answer.length_m, abs_tol=TOLERANCE), "cube path: another cost"
    same = literal.smoothest(query, cubes)
    ours, theirs = (literal.path_smoothness(path) for path in (solved.configurations_rad, same))
    assert math.isclose(ours, theirs, abs_tol=TOLERANCE), "layered path: another smoothness"


def _build(query: literal.Query) -> object:
    return temporal_cubes_graph(query.arm, query.space, query.q, query.goal_m, query.obstacles, queries.WAITING)
