"""The methods: prediction, the OMPL space-time problem, and every planner."""

from planners.prediction import PREDICTORS, Observation, build_predictor
from planners.registry import (
    ALIASES,
    PLANNERS,
    PlannerEntry,
    PlannerSpec,
    code_hash,
    is_bound,
    parse_planner,
    split_specs,
)
from planners.session import Plan, Session, check_fit, warm_up

__all__ = [
    "ALIASES",
    "PLANNERS",
    "PREDICTORS",
    "Observation",
    "Plan",
    "PlannerEntry",
    "PlannerSpec",
    "Session",
    "build_predictor",
    "check_fit",
    "code_hash",
    "is_bound",
    "parse_planner",
    "split_specs",
    "warm_up",
]
