"""Our ST-RRT* against OMPL 1.7.0's, which needs an environment and a process of its own."""

from __future__ import annotations

import json
import math
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

from benchmarks.strrt_queries import HORIZON_S, Query, Result, is_valid, prediction_of, queries
from benchmarks.timing import Line
from planners import problem
from planners.strrt import STRRTPlanner, STRRTSettings
from planners.strrt._kernels import best_join
from scenarios.kernels.jit import cache_folder

ROOT = Path(__file__).resolve().parents[1]
PEER = "ompl==1.7.0"  # the last with a Python binding of its ST-RRT*
NEEDED = ("numpy", "numba", "scipy", "pydantic", "python-fcl", "platformdirs", "pyyaml")


def against_ompl(quick: bool) -> list[Line]:
    """Share solved, time of the first path, arrivals: both at the same queries, motions and processor time."""
    count, budget_s = (5, 0.2) if quick else (20, 0.5)
    lines = []
    for n in (1, 6):
        ours = [_solve(query, budget_s) for query in queries(n, count)]
        lines += [
            Line(f"n = {n}: ours, solved of {count}", sum(map(_solved, ours)), "queries"),
            Line(f"n = {n}: ours, first path, median of those", 1e3 * _median([r.first_s for r in ours]), "ms"),
        ]
        for name, least in (("OMPL", False), ("OMPL, our least times", True)):
            theirs = _ask_peer({"n_obstacles": n, "count": count, "budget_s": budget_s, "least": least})
            assert all(result.valid for result in (*ours, *theirs)), "a path that the shared validator refuses"
            both = [(a, b) for a, b in zip(ours, theirs, strict=True) if _solved(a) and _solved(b)]
            first, arrival, last = (_median([b[k] / a[k] for a, b in both]) for k in (0, 1, 2))
            lines += [
                Line(f"n = {n}: {name}, solved of {count}", sum(map(_solved, theirs)), "queries"),
                Line(f"n = {n}: {name} / ours, time of first path, median", first, "x"),
                Line(f"n = {n}: {name} / ours, arrival of first path, median", arrival, "x"),
                Line(f"n = {n}: {name} / ours, arrival after {budget_s:g} s, median", last, "x"),
            ]
    return lines


def _solve(query: Query, budget_s: float) -> Result:
    """Our solve from t = 0 for ``budget_s`` of processor time."""
    scenario, prediction = query.scenario, prediction_of(query)
    posed = problem.Query(scenario.arm, scenario.goal, scenario.goal_tolerance_m, prediction, query.world, limits=True)
    space = problem.SpaceTimeProblem(posed, HORIZON_S)
    space.update(posed, 0.0)
    settings = STRRTSettings(iterations=10**7, refinements=10**7, nodes=20_000, horizon_s=HORIZON_S)
    planner = STRRTPlanner(space, settings)
    definition = space.definition(scenario.start, 0.0, query.goals, np.random.default_rng(0))
    planner.setProblemDefinition(definition)
    found: list[tuple[float, float]] = []

    def spent() -> bool:
        tree = planner.workspace.goal_tree
        passed = time.process_time() - began
        if not found and (best := best_join(tree)) >= 0:
            found.append((passed, float(tree.arrivals[best])))
        return passed > budget_s

    began = -math.inf
    planner.search(scenario.start, 0.0, spent)  # compiles
    found.clear()
    began = time.process_time()
    path = planner.search(scenario.start, 0.0, spent)
    if path is None or not found:
        return Result(math.inf, math.inf, math.inf, True)
    return Result(*found[0], float(path.times_s[-1]), is_valid(query, path.times_s, path.configurations_rad))


def _ask_peer(asked: dict[str, float]) -> list[Result]:
    """The peer's results, from its own process."""
    done = subprocess.run(
        [str(_peer()), "-m", "benchmarks.strrt_peer", json.dumps(asked)],
        cwd=ROOT, check=True, capture_output=True, text=True,
    )  # fmt: skip
    return [Result(**result) for result in json.loads(done.stdout)]


def _peer() -> Path:
    """The interpreter of an environment with OMPL 1.7.0, made when first asked for."""
    folder = cache_folder() / "ompl-1.7.0"
    python = folder / "bin" / "python"
    ready = folder / "ready"
    if not ready.exists():
        subprocess.run([sys.executable, "-m", "venv", "--clear", str(folder)], check=True)
        subprocess.run(
            [str(python), "-m", "pip", "install", "--quiet", "--disable-pip-version-check", PEER, *NEEDED], check=True
        )
        ready.touch()
    return python


def _solved(result: Result) -> bool:
    return math.isfinite(result.arrival_s)


def _median(values: list[float]) -> float:
    """Median of what is finite, NaN of nothing."""
    finite = [value for value in values if math.isfinite(value)]
    return float(np.median(finite)) if finite else math.nan
