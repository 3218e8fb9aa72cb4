"""The scenes that planners are checked in, and how a planner is asked there."""

import functools
from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np
from ompl import base as ob

from planners.prediction import Observation, build_predictor
from planners.problem import Query, SpaceTimeProblem
from planners.problem.goals import GoalConfigurations
from planners.session import Plan, Session
from planners.spec import PlannerSpec, load, planner_class
from scenarios.arm import ContinuumArm, FloatArray
from scenarios.families import generate
from scenarios.motion import Track
from scenarios.obstacle import Obstacle
from scenarios.scenario import Scenario

PREDICTOR = "cubic"
"""The predictor for all planners but those that see the truth."""
RESTING = ("nothing in the way", "resting obstacles")
"""The scenes in which nothing moves."""
BUDGETS = ("iterations", "branches")
"""Settings that are budgets of a solve, wherever a planner has them."""


class FirstPlan(NamedTuple):
    """What a planner's first solve in a scene gave."""

    where: str
    """The scene, and whether motion limits bind, for messages."""
    scene: str
    limits: bool
    plan: Plan


@functools.cache
def scenes() -> dict[str, Scenario]:
    """Five small scenarios of the family ``orbit``, by name; the last is of another arm."""
    moving = generate("orbit", 3, 3, 11)
    two_sections = ContinuumArm(n_sections=2, section_length_m=0.2)
    return {
        "nothing in the way": generate("orbit", 0, 1, 11)[0],
        "moving obstacles": moving[0],
        "moving obstacles near by": moving[2],
        "resting obstacles": at_rest(moving[2]),
        "two sections": generate("orbit", 2, 1, 12, two_sections)[0],
    }


def at_rest(scenario: Scenario) -> Scenario:
    """The same with every obstacle where it is at t = 0."""
    balls = [resting_ball(obstacle.position(np.zeros(1))[0], obstacle.radius_m) for obstacle in scenario.obstacles]
    return scenario.model_copy(update={"id": scenario.id + "-rest", "obstacles": tuple(balls)})


def resting_ball(center_m: FloatArray, radius_m: float) -> Obstacle:
    """A sphere about ``center_m`` (3,) [m] that never moves."""
    x, y, z = center_m.tolist()
    return Obstacle(radius_m=radius_m, motion=Track(times_s=(0.0,), positions_m=((x, y, z),)))


@functools.cache
def hopeless_scenes() -> dict[str, Scenario]:
    """Scenarios without a path to the goal, by name."""
    empty, moving = scenes()["nothing in the way"], scenes()["moving obstacles"]
    return {
        "inside an obstacle": empty.model_copy(update={"obstacles": (resting_ball(np.zeros(3), 2.0),)}),
        "shut in": empty.model_copy(update={"obstacles": tuple(_balls_around(empty))}),
        "goal inside an obstacle": empty.model_copy(update={"obstacles": (resting_ball(empty.goal, 0.05),)}),
        "goal just out of reach": moving.model_copy(update={"goal_m": (0.0, 0.0, 0.465)}),
        "goal at the end of the world": moving.model_copy(update={"goal_m": (100.0, -100.0, 100.0)}),
    }


def _balls_around(scenario: Scenario) -> Iterator[Obstacle]:
    """The start stays free, but wherever the arm turns it meets one of hundreds of balls a millimetre off."""
    arm, rng = scenario.arm, np.random.default_rng(0)
    backbone = arm.backbone_points(scenario.start, 200)
    for point in arm.backbone_points(scenario.start, 4):
        for direction in rng.normal(size=(60, 3)):
            center = point + (arm.radius_m + 0.031) * direction / np.linalg.norm(direction)
            if np.linalg.norm(backbone - center, axis=1).min() > arm.radius_m + 0.0305:
                yield resting_ball(center, 0.03)


def observe(scenario: Scenario, now_s: float = 0.0) -> Observation:
    """What is known of the obstacles at ``now_s`` [s], without noise or losses."""
    times = np.arange(-scenario.observation_s, now_s + 0.5)
    positions = np.empty((len(times), len(scenario.obstacles), 3))
    for j, obstacle in enumerate(scenario.obstacles):
        positions[:, j] = obstacle.position(times)
    return Observation(times, positions, np.array([obstacle.radius_m for obstacle in scenario.obstacles]))


def session_of(planner: PlannerSpec, scenario: Scenario, limits: bool = False, seed: int = 1) -> Session:
    """The planner at work on ``scenario``."""
    return Session(planner, scenario, predictor=PREDICTOR, limits=limits, seed=seed)


def problem_of(planner: PlannerSpec, scenario: Scenario, limits: bool) -> SpaceTimeProblem:
    """The problem as the planner is given it at t = 0, built anew from what its class declares."""
    kind, settings = load(planner)
    horizon_s = kind.look_ahead_s(settings)
    predictor = build_predictor(kind.predictor_for(PREDICTOR), scenario)
    prediction = predictor.predict(observe(scenario), horizon_s, kind.prediction_step_s)
    world = prediction.world(kind.prediction_margin, kind.largest_bound_m)
    query = Query(scenario.arm, scenario.goal, scenario.goal_tolerance_m, prediction, world, limits)
    problem = SpaceTimeProblem(query, horizon_s)
    problem.update(query, 0.0)
    return problem


def solve(planner: PlannerSpec, problem: SpaceTimeProblem, scenario: Scenario, stop: Callable[[], bool]) -> bool:
    """Solve once without the suite's session in between; whether a path to the goal was found."""
    kind, settings = load(planner)
    instance, rng = kind(problem, settings), np.random.default_rng(0)
    goals = GoalConfigurations(scenario.arm, scenario.goal, scenario.goal_tolerance_m, 8, rng)
    definition = problem.definition(scenario.start, 0.0, goals, rng)
    instance.setProblemDefinition(definition)
    instance.setup()
    instance.solve(ob.PlannerTerminationCondition(stop))
    return bool(definition.hasExactSolution())


def first_plans(planner: PlannerSpec) -> Iterator[FirstPlan]:
    """The planner's first plan in every scene, with and without motion limits."""
    for scene in scenes():
        for limits in (False, True):
            plan = _first_plan(planner.name, planner.settings.model_dump_json(), scene, limits)
            yield FirstPlan(f"{scene}, {'with' if limits else 'without'} motion limits", scene, limits, plan)


@functools.lru_cache(maxsize=256)
def _first_plan(name: str, settings: str, scene: str, limits: bool) -> Plan:
    scenario = scenes()[scene]
    return session_of(read_again(name, settings), scenario, limits).plan(scenario.start, 0.0, observe(scenario))


def read_again(name: str, settings: str) -> PlannerSpec:
    """A spec from its name and its settings as JSON."""
    return PlannerSpec(name, name, planner_class(name).settings_model.model_validate_json(settings))


def budget_settings(planner: PlannerSpec) -> list[str]:
    """Which of the planner's settings are budgets of a solve."""
    return [name for name in BUDGETS if name in load(planner)[0].settings_model.model_fields]
