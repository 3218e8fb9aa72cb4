"""What ``temporal-ct`` takes on its way, as it arises in trials: every solve, and every step's whole decision."""

from __future__ import annotations

import time

import numpy as np

from benchmarks.timing import Line
from planners import Session, parse_planner
from scenarios import Scenario, generate
from suite.auditor import collides
from suite.trial.execution import Execution
from suite.trial.observation import Observer
from suite.trial.task import TrialTask

PLANNER = "temporal-ct"


def solve_times(quick: bool) -> list[Line]:
    """Wall time of every solve over trials at n = 1, 3, 5, 6 on every family, without and with noise.

    Wall time, since a step of the arm does not wait for a busy machine either.
    """
    lines = list[Line]()
    _decide(_task(generate("orbit", 3, 1, seed=1)[0], 2.0))  # compiles
    for family in ("orbit", "crossing", "wander"):
        drawn = [scenario for n in (1, 3, 5, 6) for scenario in generate(family, n, 5 if quick else 100, seed=0)]
        for noise_mm in (0.0, 2.0):
            lines += _lines([_decide(_task(scenario, noise_mm)) for scenario in drawn], f"{family}, {noise_mm:g} mm")
    return lines


def _task(scenario: Scenario, noise_mm: float) -> TrialTask:
    spec = parse_planner(PLANNER)
    return TrialTask(scenario, spec, spec.predictor, limits=False, seed=0, noise_mm=noise_mm)


def _lines(trials: list[tuple[list[float], list[float]]], where: str) -> list[Line]:
    solves, decisions = (1e3 * np.concatenate(times) for times in zip(*trials, strict=True))
    median, late = (float(np.percentile(solves, share)) for share in (50, 99))
    return [
        Line(f"{where}: solves", len(solves), ""),
        Line(f"{where}: a solve, median", median, "ms", "<= 2"),
        Line(f"{where}: a solve, 99th percentile", late, "ms", "<= 50"),
        Line(f"{where}: a solve, longest", float(solves.max()), "ms"),
        Line(f"{where}: observe, predict, check or solve, median", float(np.median(decisions)), "ms"),
        Line(f"{where}: the same, 99th percentile", float(np.percentile(decisions, 99)), "ms"),
    ]


def _decide(task: TrialTask) -> tuple[list[float], list[float]]:
    """Seconds of every solve of a trial, and of every step's decision."""
    scenario = task.scenario
    session = Session(task.spec, scenario, predictor=task.predictor, limits=task.limits, seed=task.trial_seed)
    observer, execution = Observer(task), Execution(scenario)
    solves, decisions = list[float](), list[float]()
    while not execution.has_arrived and execution.now_s < scenario.time_limit_s:
        started = time.perf_counter()
        observation, rest = observer.until(execution.now_s), execution.rest
        if rest is None or not session.still_valid(*rest, observation):
            plan = session.plan(execution.q, execution.now_s, observation)
            solves.append(plan.solve_time_s)
            execution.take(plan.times_s, plan.configurations_rad)
        decisions.append(time.perf_counter() - started)
        execution.step()
        if collides(scenario, execution.q, execution.now_s):
            break  # as in a trial
    return solves, decisions
