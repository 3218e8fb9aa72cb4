"""OMPL's own planners in space-time."""

from ompl import base as ob
from ompl import geometric as og
from pydantic import BaseModel, ConfigDict, Field

from planners.problem import SpaceTimeProblem


class RRTSettings(BaseModel):
    """Settings of ``rrt``."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    range: float = Field(
        default=5.0, gt=0, le=1000, description="longest motion added to the tree, in space-time units"
    )
    goal_bias: float = Field(default=0.1, ge=0, le=1, description="share of samples drawn from the goal")
    iterations: int = Field(default=5000, ge=1, le=10**9, description="budget of one solve, in samples")
    horizon_s: float = Field(default=60.0, gt=0, le=3600, description="latest arrival considered, from now")


def build_rrt(problem: SpaceTimeProblem, settings: RRTSettings) -> ob.Planner:
    """OMPL's RRT (LaValle 1998) on the space-time problem."""
    planner = og.RRT(problem.si)
    planner.setRange(settings.range)
    planner.setGoalBias(settings.goal_bias)
    return planner
