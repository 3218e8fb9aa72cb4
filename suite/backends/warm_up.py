"""The warm-up of a run, in parts that several processes can share."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import partial

from planners import PlannerSpec
from planners.first_use import predictor_parts, warm_up_planner, warm_up_predictor, warm_up_problem
from scenarios import ContinuumArm, Scenario, start_is_free
from suite.auditor import audit, collides
from suite.backends.job import Part
from suite.trial.impossibility import impossibility
from suite.trial.task import TrialTask

TYPICAL_S = {"arc": 8.0, "gp": 6.0, "kalman": 4.0}
"""What a predictor takes to compile, about [s]; nothing but the progress line depends on this and the next two."""
TYPICAL_HOUSE_S = 9.0
TYPICAL_PLANNER_S = 5.0


def warm_up_parts(tasks: Iterable[TrialTask]) -> list[Part]:
    """Everything that trials of ``tasks`` call.

    First what every trial needs, then the predictors in use, each to be compiled once for all planners, then planners.
    """
    examples: dict[ContinuumArm, Scenario] = {}
    planners: dict[str, tuple[PlannerSpec, set[str]]] = {}
    for task in tasks:
        examples.setdefault(task.scenario.arm, task.scenario)
        planners.setdefault(task.spec.label, (task.spec, set()))[1].add(task.predictor)
    arms = list(examples)
    predictors = {part for _, names in planners.values() for name in names for part in predictor_parts(name)}
    return [
        Part("audit", partial(_warm_up_audit, list(examples.values())), TYPICAL_HOUSE_S),
        Part("collision checks", partial(_for_each, warm_up_problem, arms), TYPICAL_HOUSE_S),
        *(
            [Part("proofs", partial(_warm_up_proofs, list(examples.values())), TYPICAL_HOUSE_S)]
            if any(spec.is_bound for spec, _ in planners.values())
            else []
        ),
        *(
            Part(f"predictor {name}", partial(warm_up_predictor, name, arms[0]), typical_s, is_shared=False)
            for typical_s, name in sorted(((TYPICAL_S.get(name, 1.0), name) for name in predictors), reverse=True)
        ),
        *(
            Part(
                label,
                partial(_warm_up_planner, spec, sorted(names), arms),
                TYPICAL_PLANNER_S,
                planner=label,
                is_outside=bool(spec.code),
            )
            for label, (spec, names) in planners.items()
        ),
    ]


def _warm_up_audit(examples: Iterable[Scenario]) -> None:
    for scenario in examples:
        start_is_free(scenario)
        audit(scenario, [0.0, 1.0], [scenario.start, scenario.start])
        collides(scenario, scenario.start, 0.0)


def _warm_up_planner(spec: PlannerSpec, predictors: Iterable[str], arms: Iterable[ContinuumArm]) -> None:
    for predictor in predictors:
        for arm in arms:
            warm_up_planner(spec, predictor, arm)


def _warm_up_proofs(examples: Iterable[Scenario]) -> None:
    for scenario in examples:
        impossibility(scenario)


def _for_each(warm_up: Callable[[ContinuumArm], None], arms: Iterable[ContinuumArm]) -> None:
    for arm in arms:
        warm_up(arm)
