"""All checks: those of single solves, and what only a whole trial can tell."""

from __future__ import annotations

import sys

from planners import ArmPlanner, PlannerSpec, parse_planner
from planners import conformance as solves
from planners.conformance import Check
from scenarios import SpecError, generate
from suite.trial.episode import run_trial
from suite.trial.task import TrialTask

TRIALS = 5
SEED = 1000
"""Scenarios of reported results have other seeds."""


def check_reaches_every_goal_among_no_obstacles(planner: PlannerSpec) -> None:
    """In five trials of the default arm, executed and audited as in a run."""
    for scenario in generate("orbit", 0, TRIALS, SEED):
        task = TrialTask(scenario, planner, predictor=planner.predictor, limits=False, seed=SEED)
        row = run_trial(task).row
        if row["outcome"] != "reached":
            why = f" ({row['message']})" if row["message"] else ""
            raise AssertionError(f"{scenario.id}: found outcome {row['outcome']!r}{why}, allowed 'reached'")


CHECKS: tuple[Check, ...] = (*solves.CHECKS, check_reaches_every_goal_among_no_obstacles)
"""All of them."""


def checks_for(planner: PlannerSpec) -> list[Check]:
    """The checks that concern ``planner``."""
    return [*solves.checks_for(planner), check_reaches_every_goal_among_no_obstacles]


def spec_of(planner: str | type[ArmPlanner]) -> PlannerSpec:
    """The spec of a planner given as text or as its class.

    Raises:
        SpecError: Unknown planner or setting, or a class that no other process could import.
    """
    if isinstance(planner, str):
        return parse_planner(planner)
    if getattr(sys.modules.get(planner.__module__), planner.__qualname__, None) is not planner:
        raise SpecError(f"planner: found class {planner.__qualname__!r}, allowed one at the top of a module")
    return parse_planner(f"{planner.__module__}:{planner.__qualname__}")
