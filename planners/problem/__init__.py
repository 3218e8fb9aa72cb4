"""The space-time planning problem: one checker, one motion validator and one goal, shared by every planner."""

from planners.problem.checker import SpaceTimeChecker
from planners.problem.problem import SpaceTimeProblem
from planners.problem.query import Query, TimedPath
from planners.problem.states import read_state, write_path, write_state
from planners.problem.tip_goal import TipGoal
from planners.problem.validator import SpaceTimeMotionValidator

__all__ = [
    "Query",
    "SpaceTimeChecker",
    "SpaceTimeMotionValidator",
    "SpaceTimeProblem",
    "TimedPath",
    "TipGoal",
    "read_state",
    "write_path",
    "write_state",
]
