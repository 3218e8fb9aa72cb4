"""The methods: prediction, the OMPL space-time problem, and every planner."""

from planners.prediction import PREDICTORS, Observation, build_predictor
from planners.registry import ALIASES, PLANNERS, PlannerEntry, PlannerSpec, is_bound, parse_planner, split_specs
from planners.session import Plan, Session, check_fit

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
    "is_bound",
    "parse_planner",
    "split_specs",
]
