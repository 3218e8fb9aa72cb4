"""The queries on which ST-RRT* is compared with OMPL 1.7.0's, and the judge of both: importable under either OMPL."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from planners.prediction import Prediction
from planners.problem import _kernels
from planners.problem.goals import GoalConfigurations
from scenarios import Scenario, generate, sample_world
from scenarios.arm import FloatArray
from scenarios.collision import CONTACT_TOLERANCE_M
from scenarios.world import SampledWorld

SEED = 1000
"""Of the scenarios: never that of a published table."""
HORIZON_S, STEP_S, GOALS = 90.0, 0.25, 64


class Query(NamedTuple):
    """One scenario with its future known, from t = 0."""

    scenario: Scenario
    world: SampledWorld
    goals: GoalConfigurations


class Result(NamedTuple):
    """What one planner made of a query; times are infinite where it found no path."""

    first_s: float
    """Processor time until the first path [s]."""
    first_arrival_s: float
    """Arrival of the first path [s]."""
    arrival_s: float
    """Arrival of the best path when the budget is spent [s]."""
    valid: bool
    """Whether the best path passes ``is_valid``; true without one."""


def queries(n_obstacles: int, count: int) -> list[Query]:
    """``count`` queries among ``n_obstacles``."""
    found = [
        Query(
            scenario,
            sample_world(scenario.obstacles, 0.0, HORIZON_S, STEP_S),
            GoalConfigurations(
                scenario.arm, scenario.goal, scenario.goal_tolerance_m, GOALS, np.random.default_rng(SEED)
            ),
        )
        for scenario in generate("orbit", n_obstacles, count, SEED)
    ]
    assert all(len(query.goals.configurations) for query in found)  # looked for here, not while a clock runs
    return found


def prediction_of(query: Query) -> Prediction:
    """The known future as planners take it."""
    centers, radii = query.world.centers_m, query.world.radii_m
    return Prediction(0.0, STEP_S, centers, radii, np.zeros(centers.shape[:2]))


def is_free(query: Query, q0: FloatArray, t0_s: float, q1: FloatArray, t1_s: float) -> bool:
    """Whether a motion is valid: the kernel of the shared motion validator."""
    arm = query.scenario.arm
    return t1_s <= HORIZON_S and bool(
        _kernels.motion_valid(
            q0,
            t0_s,
            q1,
            t1_s,
            arm.section_length_m,
            arm.radius_m,
            arm.max_bend_rad,
            arm.max_bend_rate_rad_s,
            arm.max_tip_speed_m_s,
            CONTACT_TOLERANCE_M,
            query.world,
        )
    )


def is_valid(query: Query, times_s: FloatArray, configurations_rad: FloatArray) -> bool:
    """Whether a path (k,) [s], (k, dof) [rad] leads from the start to the goal by valid motions."""
    gap = np.linalg.norm(query.scenario.arm.tip(configurations_rad[-1]) - query.scenario.goal)
    return (
        bool(gap <= query.scenario.goal_tolerance_m)
        and np.array_equal(configurations_rad[0], query.scenario.start)
        and all(
            is_free(query, configurations_rad[k], times_s[k], configurations_rad[k + 1], times_s[k + 1])
            for k in range(len(times_s) - 1)
        )
    )
