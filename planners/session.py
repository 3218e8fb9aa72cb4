"""One planner at work on one scenario: the only door through which the suite speaks to planners."""

import time
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from ompl import base as ob
from ompl import util as ou

from planners.prediction import Observation, Prediction, build_predictor
from planners.problem import Query, SpaceTimeProblem, read_state
from planners.problem.goals import GoalConfigurations
from planners.spec import PlannerSpec, is_outside, load
from scenarios.arm import ContinuumArm, FloatArray
from scenarios.obstacle import Obstacle
from scenarios.scenario import Scenario
from scenarios.shaped_world import shaped_world
from scenarios.world import SampledWorld, cover_world

GOALS = 64
"""Goal configurations looked for per trial."""


class Plan(NamedTuple):
    """What one solve gave."""

    status: str
    """OMPL's name of the status."""
    times_s: FloatArray
    """Times of the path, shape (k,), [s]; empty when there is no path."""
    configurations_rad: FloatArray
    """Shape (k, dof), [rad]."""
    solve_time_s: float
    """Wall time of ``Planner.solve`` alone."""
    state_checks: int
    motion_checks: int


class Session:
    """Owns every OMPL object of a trial; fresh per trial, so that equal seeds give equal paths."""

    def __init__(
        self,
        spec: PlannerSpec,
        scenario: Scenario,
        *,
        predictor: str,
        limits: bool,
        seed: int,
        margin: float | None = None,
    ) -> None:
        """Set up ``spec`` for ``scenario``.

        Args:
            spec: The planner with its settings.
            scenario: The problem; planners see its arm, start and goal, never its obstacles' motion.
            predictor: Name of the predictor that stands between observations and planner.
            limits: Whether the motion limits bind planners whose paths may otherwise jump in shape.
            seed: Seed of all randomness in this trial.
            margin: Standard deviations by which predicted obstacles are grown; the planner's own when None.

        Raises:
            SpecError: Unknown predictor.
        """
        kind, settings = load(spec)
        self.commitment = kind.commitment
        self._iterations = getattr(settings, "iterations", None)
        self._horizon_s = kind.look_ahead_s(settings)
        self._step_s = kind.prediction_step_s
        self._asked_margin = None if kind.is_bound else margin
        self._margin = kind.prediction_margin if self._asked_margin is None else self._asked_margin
        self._largest_bound_m = kind.largest_bound_m
        self._scenario, self._limits = scenario, limits
        self._predictor = build_predictor(kind.predictor_for(predictor), scenario)
        self._rng = np.random.default_rng(seed)
        _seed_ompl(seed)
        nothing = Prediction(0.0, 1.0, np.empty((2, 0, 3)), np.empty(0), np.empty((2, 0)))
        self._problem = SpaceTimeProblem(self._query(nothing), self._horizon_s)
        self._goals = GoalConfigurations(
            scenario.arm, scenario.goal, scenario.goal_tolerance_m, GOALS, np.random.default_rng(seed)
        )
        self._planner = kind(self._problem, settings)

    def plan(self, q: FloatArray, now_s: float, observation: Observation) -> Plan:
        """Predict the obstacles and solve once from ``q`` (dof,) [rad] at ``now_s`` [s]."""
        self._look(observation, now_s)
        definition = self._problem.definition(q, now_s, self._goals, self._rng)
        self._planner.setProblemDefinition(definition)
        self._planner.clearQuery()
        self._planner.setup()
        before = self._checks()
        budget = _budget(self._iterations)
        started = time.perf_counter()
        status = self._planner.solve(budget)
        elapsed = time.perf_counter() - started
        states, motions = (after - b for after, b in zip(self._checks(), before, strict=True))
        times, path = self._path(definition)
        return Plan(_name(status), times, path, elapsed, states, motions)

    def still_valid(self, times_s: FloatArray, configurations_rad: FloatArray, observation: Observation) -> bool:
        """Whether the rest of a path, its first state being now, leads to the goal and is valid as seen now."""
        self._look(observation, float(times_s[0]))
        if self._problem.query.goal_distance(configurations_rad[-1]) > self._scenario.goal_tolerance_m:
            return False
        check = self._problem.validator.check
        return all(
            check(configurations_rad[k], times_s[k], configurations_rad[k + 1], times_s[k + 1])
            for k in range(len(times_s) - 1)
        )

    def expected(self) -> SampledWorld:
        """Where the obstacles were expected at the latest look, grown as this planner wants them."""
        return self._problem.query.prediction.world(self._margin, self._largest_bound_m)

    def _look(self, observation: Observation, now_s: float) -> None:
        prediction = self._predictor.predict(observation, self._horizon_s, self._step_s)
        self._problem.update(self._query(prediction, self._scenario.obstacles), now_s)

    def _query(self, prediction: Prediction, obstacles: Sequence[Obstacle] = ()) -> Query:
        """What the next solve is about; ``obstacles`` are asked for their shapes, never for their motion."""
        scenario, world = self._scenario, prediction.world(self._margin, self._largest_bound_m)
        margins = world.radii_m - prediction.radii_m
        placed = (obstacles, prediction.start_s, prediction.step_s, prediction.centers_m, margins)
        shapes = shaped_world(*placed)
        return Query(
            scenario.arm,
            scenario.goal,
            scenario.goal_tolerance_m,
            prediction,
            world if shapes is None else cover_world(*placed),
            self._limits,
            shapes,
            self._asked_margin,
        )

    def _checks(self) -> tuple[int, int]:
        problem, planner = self._problem, self._planner
        return problem.checker.checks + planner.state_checks, problem.validator.checks + planner.motion_checks

    def _path(self, definition: ob.ProblemDefinition) -> tuple[FloatArray, FloatArray]:
        """Times (k,) and configurations (k, dof) of the solution; empty without one.

        A path that ends short of the goal, which OMPL calls approximate, counts for every planner alike: the house's
        return it on purpose, one window at a time, and a tree's leads where it came nearest.
        """
        dof = self._scenario.arm.dof
        if not definition.hasSolution():
            return np.empty(0), np.empty((0, dof))
        states = [read_state(state, dof) for state in definition.getSolutionPath().getStates()]
        return np.array([t for _, t in states]), np.array([q for q, _ in states])


def _name(status: ob.PlannerStatus) -> str:
    """OMPL's name of ``status``; for the one that OMPL has not named, a name in its manner."""
    return "Infeasible" if status == ob.PlannerStatus.INFEASIBLE else str(status.asString())


def check_fit(specs: Sequence[PlannerSpec], arm: ContinuumArm) -> None:
    """Refuse planners of the house whose settings do not fit ``arm``, before anything is built or written.

    Raises:
        ScenarioError: A lattice of configurations would be too large.
    """
    for spec in specs:
        if not is_outside(spec.name):
            planner, settings = load(spec)
            planner.check_fit(settings, arm)


def _budget(iterations: int | None) -> ob.PlannerTerminationCondition:
    """A budget counted in the planner's own questions, so that a seed gives the same path on any machine."""
    if iterations is None:
        return ob.PlannerTerminationCondition(lambda: False)
    asked = iter(range(iterations))
    return ob.PlannerTerminationCondition(lambda: next(asked, None) is None)


def _seed_ompl(seed: int) -> None:
    """Reseed OMPL's process-wide generator; it warns about every seed after the first, but takes it.

    OMPL stays silent from here on: what it has to say is in the status of each solve.
    """
    ou.setLogLevel(ou.LogLevel.LOG_NONE)
    ou.RNG.setSeed(seed % (2**31 - 1) + 1)
