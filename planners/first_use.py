"""What has to be compiled, or loaded, and built once before a solve may be timed.

The parts compile different kernels, so that several processes can share the work; a planner's own part loads all that
its sessions call, whoever compiled it.
"""

from __future__ import annotations

import numpy as np

from planners.prediction import PORTFOLIO, Observation, Prediction, build_predictor
from planners.problem import Query, SpaceTimeProblem
from planners.problem.goals import GoalConfigurations
from planners.session import Session
from planners.spec import PlannerSpec
from scenarios.arm import ContinuumArm
from scenarios.motion import Orbit
from scenarios.obstacle import Obstacle
from scenarios.scenario import Scenario


def warm_up_problem(arm: ContinuumArm) -> None:
    """The shared checker and motion validator, and inverse kinematics of the goal."""
    scenario = _example(arm)
    nothing = Prediction(0.0, 1.0, np.empty((2, 0, 3)), np.empty(0), np.empty((2, 0)))
    query = Query(arm, scenario.goal, scenario.goal_tolerance_m, nothing, nothing.world(0.0), limits=True)
    problem = SpaceTimeProblem(query, 1.0)
    problem.si.isValid(problem.si.allocState())
    query.goal_distance(scenario.start)
    problem.validator.check(scenario.start, 0.0, scenario.start + 0.01, 1.0)
    GoalConfigurations(arm, query.goal_m, query.goal_tolerance_m, 1, np.random.default_rng(1)).configurations  # noqa: B018


def predictor_parts(name: str) -> tuple[str, ...]:
    """The predictors that predictor ``name`` is made of."""
    return PORTFOLIO if name == "portfolio" else (name,)


def warm_up_predictor(name: str, arm: ContinuumArm) -> None:
    """Predictor ``name``."""
    scenario = _example(arm)
    build_predictor(name, scenario).predict(_observed(scenario), 2.0, 1.0)


def warm_up_planner(spec: PlannerSpec, predictor: str, arm: ContinuumArm) -> None:
    """Everything that sessions of ``spec`` with ``predictor`` call, by sessions of it."""
    scenario = _example(arm)
    observation = _observed(scenario)
    for limits in (False, True):
        session = Session(spec, scenario, predictor=predictor, limits=limits, seed=1)
        plan = session.plan(scenario.start, 0.0, observation)
        if len(plan.times_s):
            session.still_valid(plan.times_s, plan.configurations_rad, observation)


def _example(arm: ContinuumArm) -> Scenario:
    """A short way past one obstacle."""
    motion = Orbit(center_m=(0.0, 0.0, 1.0), radius_m=0.1, normal=(0.0, 0.0, 1.0), rate_rad_s=0.1, phase_rad=0.0)
    start = np.full(arm.dof, 0.1)
    return Scenario(
        id="warm-up",
        arm=arm,
        start_rad=tuple(start.tolist()),
        goal_m=tuple(arm.tip(start + 0.3).tolist()),
        obstacles=(Obstacle(radius_m=0.02, motion=motion),),
    )


def _observed(scenario: Scenario) -> Observation:
    times = np.arange(-scenario.observation_s, 1.0)
    positions = np.stack([obstacle.position(times) for obstacle in scenario.obstacles], axis=1)
    return Observation(times, positions, np.array([obstacle.radius_m for obstacle in scenario.obstacles]))
