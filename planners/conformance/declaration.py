"""Checks of what a planner's class says of itself, and whether another process makes the same of it."""

import math
from typing import get_args

from pydantic import ValidationError

from planners.base import Commitment
from planners.conformance.conduct import difference_of
from planners.conformance.elsewhere import plan_elsewhere
from planners.conformance.scenes import first_plans
from planners.prediction import PREDICTORS
from planners.spec import PlannerSpec, load


def check_class_attributes(planner: PlannerSpec) -> None:
    """Summary, commitment, horizon, prediction and predictor are such as the suite can work with."""
    kind, settings = load(planner)
    horizon_s = kind.look_ahead_s(settings)
    if not kind.summary or len(kind.summary.splitlines()) != 1:
        raise AssertionError(f"summary: found {kind.summary!r}, allowed a line that says what it does")
    if kind.commitment not in get_args(Commitment):
        raise AssertionError(f"commitment: found {kind.commitment!r}, allowed {', '.join(get_args(Commitment))}")
    if kind.predictor not in PREDICTORS:
        raise AssertionError(f"predictor: found {kind.predictor!r}, allowed {', '.join(PREDICTORS)}")
    if not 0 < horizon_s < math.inf:
        raise AssertionError(f"horizon_s: found {horizon_s}, allowed more than 0 and finite")
    if not 0 < kind.prediction_step_s < math.inf:
        raise AssertionError(f"prediction_step_s: found {kind.prediction_step_s}, allowed more than 0 and finite")
    if not 0 <= kind.prediction_margin < math.inf:
        raise AssertionError(f"prediction_margin: found {kind.prediction_margin}, allowed 0 and more, finite")
    if not kind.largest_bound_m > 0:
        raise AssertionError(f"largest_bound_m: found {kind.largest_bound_m}, allowed more than 0")


def check_settings(planner: PlannerSpec) -> None:
    """Every setting is described and has a default, which its limits allow and which can be written as text."""
    model = load(planner)[0].settings_model
    for name, field in model.model_fields.items():
        if not field.description:
            raise AssertionError(f"{name}: found no description, allowed Field(..., description=...)")
        if field.is_required():
            raise AssertionError(f"{name}: found no default, allowed one, so that a name alone is a planner")
        default = field.get_default(call_default_factory=True)
        try:
            read = getattr(model.model_validate(planner.settings.model_dump() | {name: str(default)}), name)
        except ValidationError as error:
            first = error.errors(include_url=False)[0]
            where = f"{first['loc'][0] if first['loc'] else name}={first['input']}"
            raise AssertionError(f"{where}: found as a default, allowed within limits: {first['msg']}") from None
        if read != default:
            raise AssertionError(f"{name}: found {read!r} read from {str(default)!r}, allowed {default!r}")
    settings = planner.settings.model_dump_json()
    if model.model_validate_json(settings).model_dump_json() != settings:
        raise AssertionError("found other settings when read again from JSON, allowed the same")


def check_plans_the_same_in_another_process(planner: PlannerSpec) -> None:
    """Another process finds it by its spec, reads its settings and makes the same plan of the same seed."""
    first = next(first for first in first_plans(planner) if first.scene == "moving obstacles")
    try:
        other = plan_elsewhere(planner, first.scene)
    except ChildProcessError as error:
        raise AssertionError(f"another process: found {error}, allowed a plan") from None
    difference = difference_of(first.plan, other)
    if difference:
        raise AssertionError(f"another process: found {difference} of equal seeds, allowed equal plans")
