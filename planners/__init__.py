"""The methods: prediction, the OMPL space-time problem, and every planner."""

from planners.base import ArmPlanner, NoSettings
from planners.failure import Failure, failure_of
from planners.isolation import describe
from planners.prediction import PREDICTORS, Observation, build_predictor
from planners.problem import TimedPath
from planners.registry import ALIASES, PLANNERS, is_bound
from planners.sampling.by_name import ompl_planners, ompl_refused
from planners.session import Plan, Session, check_fit
from planners.spec import PlannerSpec, label_of, parse_planner, split_specs

__all__ = [
    "ALIASES",
    "PLANNERS",
    "PREDICTORS",
    "ArmPlanner",
    "Failure",
    "NoSettings",
    "Observation",
    "Plan",
    "PlannerSpec",
    "Session",
    "TimedPath",
    "build_predictor",
    "check_fit",
    "describe",
    "failure_of",
    "is_bound",
    "label_of",
    "ompl_planners",
    "ompl_refused",
    "parse_planner",
    "split_specs",
]
