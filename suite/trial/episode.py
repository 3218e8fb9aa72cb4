"""The story of a trial: observe, predict, solve, execute, audit.

Once per step the obstacles are observed. When the planner's commitment asks for it, the planner predicts and solves;
what it returns is executed for a step. The trial ends at arrival, at the first collision at a whole second, or at the
time limit; then everything that was executed is audited against the true motion by code that no planner shares.
"""

import time
from collections.abc import Callable

import numpy as np

from planners import Failure, Observation, Plan, Session
from scenarios import start_is_free
from suite.auditor import Audit, audit, collides
from suite.auditor.verdicts import Kind, contact_columns
from suite.trial.execution import Execution, PathError, check_path
from suite.trial.impossibility import impossibility
from suite.trial.look import Look
from suite.trial.metrics import smoothness_bending_rad, smoothness_paper_rad, tip_path_length_m
from suite.trial.observation import Observer
from suite.trial.task import TrialResult, TrialTask, failed_trial, trial_row

STUCK_S = 10.0
"""An arm that has not moved for this long when time runs out is called stuck."""


def run_trial(task: TrialTask, watch: Callable[[Look], object] | None = None) -> TrialResult:
    """Run one planner on one scenario and judge what was executed; ``watch`` is told of every step."""
    started = time.perf_counter()
    scenario = task.scenario  # no planner ever sees this one: what it is handed, it may change
    if not start_is_free(scenario):
        message = "the start is hit while the obstacles are observed"
        return failed_trial(task, Failure("invalid_scenario", message), time.perf_counter() - started)
    theirs = scenario.model_copy(deep=True)
    session = Session(
        task.spec, theirs, predictor=task.predictor, limits=task.limits, seed=task.trial_seed, margin=task.margin
    )
    observer, execution, solves = Observer(task), Execution(scenario), list[Plan]()
    outcome, message = "", ""
    while not (outcome or execution.has_arrived):
        observation = observer.until(execution.now_s)
        asked = len(solves)
        try:
            _plan_if_due(session, execution, observation, solves)
        except PathError as error:
            outcome, message = "planner_error", str(error)
            break
        if watch is not None:
            watch(Look(execution.now_s, session.expected(), solves[-1] if len(solves) > asked else None))
        execution.step()
        if collides(scenario, execution.q, execution.now_s) and not execution.has_arrived:
            outcome = "collided"
        elif execution.now_s >= scenario.time_limit_s and not execution.has_arrived:
            outcome = "stuck" if execution.held_still_for(STUCK_S) else "timeout"
    audit_started = time.perf_counter()
    judged = audit(scenario, execution.times_s, execution.configurations_rad)
    audit_time_s = time.perf_counter() - audit_started
    if execution.has_arrived:  # perhaps too late: within the step in which time runs out
        late = judged.per_step.violation_kind == Kind.TIME_LIMIT
        outcome = "reached" if judged.per_step.success else "timeout" if late else "collided"
    measured = {
        "outcome": outcome,
        "message": message,
        **_judgement(judged),
        **_solving(solves),
        **(impossibility(scenario) if task.spec.is_bound and not judged.executable.success else {}),
        "tip_path_length_m": tip_path_length_m(scenario.arm, execution.configurations_rad),
        "smoothness_paper_rad": smoothness_paper_rad(execution.configurations_rad),
        "smoothness_bending_rad": smoothness_bending_rad(execution.configurations_rad),
        "audit_time_s": audit_time_s,
        "trial_wall_s": time.perf_counter() - started,
    }
    return TrialResult(trial_row(task, measured), execution.times_s, execution.configurations_rad)


def _plan_if_due(session: Session, execution: Execution, observation: Observation, solves: list[Plan]) -> None:
    """Ask the planner for a path unless its commitment says that the present one still holds.

    Raises:
        PathError: The planner's answer is not a path from where the arm is.
    """
    rest = execution.rest
    if rest is not None and session.commitment == "path":
        return
    if rest is not None and session.commitment == "while_valid" and session.still_valid(*rest, observation):
        return
    plan = session.plan(execution.q, execution.now_s, observation)
    solves.append(plan)
    if len(plan.times_s):
        check_path(plan.times_s, plan.configurations_rad, execution.now_s, execution.q, len(execution.q))
    execution.take(plan.times_s, plan.configurations_rad)


def _judgement(judged: Audit) -> dict[str, object]:
    """The audit's columns of the row."""
    columns: dict[str, object] = {
        "arrival_time_s": judged.arrival_time_s,
        "min_clearance_m": judged.min_clearance_m,
        **contact_columns(judged.contact),
    }
    for name in ("per_step", "swept", "executable"):
        verdict = getattr(judged, name)
        columns[f"success_{name}"] = verdict.success
        columns[f"violation_{name}_time_s"] = verdict.violation_time_s
        columns[f"violation_{name}_kind"] = verdict.violation_kind or None
    return columns


def _solving(solves: list[Plan]) -> dict[str, object]:
    """The columns about solves; a trial that arrives without asking has none."""
    times = np.array([plan.solve_time_s for plan in solves])
    p50, p95 = np.percentile(times, [50, 95]) if len(times) else (np.nan, np.nan)
    return {
        "planning_time_s": float(times.sum()),
        "n_solves": len(times),
        "solve_p50_s": p50,
        "solve_p95_s": p95,
        "solve_max_s": times.max() if len(times) else np.nan,
        "state_checks": sum(plan.state_checks for plan in solves),
        "motion_checks": sum(plan.motion_checks for plan in solves),
    }
