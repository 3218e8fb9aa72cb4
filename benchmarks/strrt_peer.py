"""OMPL 1.7.0's ST-RRT* on our queries; runs in an environment of its own: ``python -m benchmarks.strrt_peer``.

OMPL 2 has no Python binding of it (ompl#1419). Facts of 1.7.0 behind this file: functions must be wrapped in their
Boost types, distances know no direction of time, so that the motion validator must; and it may crash when the
interpreter takes its objects down, so that the process ends without doing that.
"""

from __future__ import annotations

import json
import math
import os
import sys
import time

import numpy as np
from ompl import base as ob
from ompl import geometric as og
from ompl import util as ou

from benchmarks.strrt_queries import HORIZON_S, Query, Result, is_free, is_valid, queries
from planners.problem._kernels import clearance
from planners.strrt import numbers_of
from planners.strrt.trees._kernels import least_time, place_tip
from scenarios.arm import ContinuumArm, FloatArray
from scenarios.kernels.kinematics import ARC_SIZE


def read(space: ob.SpaceTimeStateSpace, state: ob.State, dof: int) -> tuple[FloatArray, float]:
    """Configuration and time of a state; ``state[1]`` would not know its time."""
    return np.array([state[0][i] for i in range(dof)]), space.getStateTime(state)


class LeastTimes(ob.RealVectorStateSpace):
    """Configurations whose distance is the least time [s] between them that our own ST-RRT* reckons with."""

    def __init__(self, arm: ContinuumArm) -> None:
        super().__init__(arm.dof)
        self.dof, self.tips = arm.dof, np.empty((2, 3))
        self.numbers = numbers_of(arm)
        self.arcs = np.empty((arm.n_sections, ARC_SIZE))

    def distance(self, one: ob.State, other: ob.State) -> float:
        """Least time [s]."""
        q0, q1 = (np.array([state[i] for i in range(self.dof)]) for state in (one, other))
        place_tip(q0, self.numbers.section_length, self.arcs, self.tips[0])
        place_tip(q1, self.numbers.section_length, self.arcs, self.tips[1])
        return float(least_time(q0, self.tips[0], q1, self.tips[1], self.numbers))


class Motions(ob.MotionValidator):
    """The shared motion validator."""

    def __init__(self, si: ob.SpaceInformation, query: Query) -> None:
        super().__init__(si)
        self.space, self.query = si.getStateSpace(), query

    def checkMotion(self, start: ob.State, end: ob.State) -> bool:
        """Whether the motion goes forward in time and is valid."""
        dof = self.query.scenario.arm.dof
        return is_free(self.query, *read(self.space, start, dof), *read(self.space, end, dof))


class Goals(ob.GoalSampleableRegion):
    """The goal configurations, uniformly; the planner chooses the time."""

    def __init__(self, si: ob.SpaceInformation, query: Query) -> None:
        super().__init__(si)
        self.query, self.rng = query, np.random.default_rng(1)

    def distanceGoal(self, state: ob.State) -> float:
        """Distance of the tip from the goal [m]."""
        arm = self.query.scenario.arm
        tip = arm.tip(np.array([state[0][i] for i in range(arm.dof)]))
        return float(np.linalg.norm(tip - self.query.scenario.goal))

    def sampleGoal(self, state: ob.State) -> None:
        """Write a goal configuration."""
        known = self.query.goals.configurations
        for i, value in enumerate(known[self.rng.integers(len(known))]):
            state[0][i] = float(value)

    def maxSampleCount(self) -> int:
        """Any number."""
        return 1_000_000

    def couldSample(self) -> bool:
        """Whether a goal configuration is known."""
        return len(self.query.goals.configurations) > 0


def solve(query: Query, budget_s: float, least: bool) -> Result:
    """One solve from t = 0, where the bound that it puts on goal times is right."""
    arm = query.scenario.arm
    configurations = LeastTimes(arm) if least else ob.RealVectorStateSpace(arm.dof)
    bounds = ob.RealVectorBounds(arm.dof)
    bounds.setLow(-arm.max_bend_rad)
    bounds.setHigh(arm.max_bend_rad)
    configurations.setBounds(bounds)
    space = ob.SpaceTimeStateSpace(
        configurations, 1.0 if least else arm.max_bend_rate_rad_s * math.sqrt(arm.n_sections)
    )
    space.setTimeBounds(0.0, HORIZON_S)
    si = ob.SpaceInformation(space)

    def valid(state: ob.State) -> bool:
        q, t = read(space, state, arm.dof)
        return bool(clearance(q, t, arm.section_length_m, arm.radius_m, arm.max_bend_rad, query.world) > 0.0)

    si.setStateValidityChecker(ob.StateValidityCheckerFn(valid))
    motions = Motions(si, query)
    si.setMotionValidator(motions)
    si.setup()
    start, goal = ob.State(space), Goals(si, query)
    for i, value in enumerate(query.scenario.start):
        start[i] = float(value)
    start[arm.dof] = 0.0  # the time
    definition = ob.ProblemDefinition(si)
    definition.addStartState(start)
    definition.setGoal(goal)
    found: list[tuple[float, float]] = []
    began = time.process_time()
    definition.setIntermediateSolutionCallback(
        ob.ReportIntermediateSolutionFn(lambda _, __, cost: found.append((time.process_time() - began, cost.value())))
    )
    planner = og.STRRTstar(si)
    planner.setProblemDefinition(definition)
    planner.setup()
    began = time.process_time()
    spent = ob.PlannerTerminationConditionFn(lambda: time.process_time() - began > budget_s)
    planner.solve(ob.PlannerTerminationCondition(spent))
    if not found or not definition.hasExactSolution():
        return Result(math.inf, math.inf, math.inf, True)
    path = definition.getSolutionPath()
    states = [read(space, path.getState(k), arm.dof) for k in range(path.getStateCount())]
    times, path_rad = np.array([t for _, t in states]), np.array([q for q, _ in states])
    return Result(*found[0], float(times[-1]), is_valid(query, times, path_rad))


def main() -> None:
    """Read what is asked for as JSON, write the results as JSON."""
    asked = json.loads(sys.argv[1])
    ou.setLogLevel(ou.LogLevel.LOG_NONE)
    ou.RNG.setSeed(1)
    given = queries(asked["n_obstacles"], asked["count"])
    solve(given[0], 0.05, asked["least"])  # compiles
    results = [solve(query, asked["budget_s"], asked["least"]) for query in given]
    sys.stdout.write(json.dumps([result._asdict() for result in results]))
    sys.stdout.flush()
    os._exit(0)


if __name__ == "__main__":
    main()
