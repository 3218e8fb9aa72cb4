"""OMPL's PRM, searched in time.

A roadmap's edges are undirected and know no time, so OMPL's PRM cannot plan in space-time itself. Here it builds its
roadmap once per trial in configuration space, where nothing moves; every solve then looks for the earliest arrival over
the roadmap's edges, each run as fast as the arm's rates allow and checked against the predicted obstacles at the time
it is run (roadmap and time apart: van den Berg, Ferguson and Kuffner, ICRA 2006). PRM's own ``solve`` is not used: its
second thread would make results depend on the machine's load.
"""

import heapq
import math
from collections.abc import Callable

import numpy as np
from ompl import base as ob
from ompl import geometric as og
from pydantic import BaseModel, ConfigDict, Field

from planners.base import ReplanningPlanner
from planners.problem import SpaceTimeProblem, TimedPath
from planners.problem._kernels import least_durations
from planners.sampling.roadmap import _kernels
from scenarios.arm import ContinuumArm, FloatArray
from scenarios.collision import CONTACT_TOLERANCE_M


class PRMSettings(BaseModel):
    """Settings of ``prm``."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    milestones: int = Field(default=800, ge=1, le=100_000, description="samples from which OMPL builds its roadmap")
    neighbors: int = Field(default=10, ge=1, le=100, description="nearest milestones that a state is joined to")
    goals: int = Field(default=16, ge=1, le=64, description="goal configurations that can be reached soonest, joined")
    motions: int = Field(default=1500, ge=1, le=10**7, description="budget of one solve, in edges checked")
    wait_s: float = Field(default=3.0, gt=0, le=60, description="how long to wait before a blocked edge is tried again")
    waits: int = Field(default=3, ge=0, le=100, description="how often to wait at a milestone")
    horizon_s: float = Field(default=90.0, gt=0, le=3600, description="latest arrival considered, from now")


class PRMPlanner(ReplanningPlanner):
    """Earliest arrival over OMPL's roadmap, by A* with edges checked when they are first to be taken."""

    name = "prm"
    settings_model = PRMSettings
    budget = ("milestones", "motions")
    summary = "OMPL's roadmap, searched for the earliest arrival among the predicted obstacles"
    source = "Kavraki et al. 1996; van den Berg et al. 2006"

    def __init__(self, problem: SpaceTimeProblem, settings: PRMSettings) -> None:
        """Build the roadmap of ``problem``'s arm."""
        super().__init__(problem, settings)
        self._settings = settings
        self._milestones, self._joined = build_roadmap(problem.query.arm, settings)
        self._durations: dict[tuple[int, int], FloatArray] = {}

    def search(self, q: FloatArray, now_s: float, stop: Callable[[], bool]) -> TimedPath | None:
        """The path that arrives first, among those that the budget lets it see."""
        goals, earliest_s = self.goal.reachable
        goals = goals[np.argsort(earliest_s)[: self._settings.goals]]
        start = len(self._milestones)
        self._states = np.vstack([self._milestones, q[None], goals])
        self._durations = {edge: durations for edge, durations in self._durations.items() if max(edge) < start}
        joined = self._join(start)
        bounds = self._least_times(start)
        latest_s = now_s + self._settings.horizon_s
        arrival, came = {start: now_s}, dict[int, tuple[int, float]]()
        queue, done = [(now_s + bounds[start], start)], set[int]()
        motions_before = self.motion_checks
        while queue and not stop():
            _, here = heapq.heappop(queue)
            if here > start:
                return self._path(here, arrival, came)
            if here in done:
                continue
            done.add(here)
            for there in joined[here]:
                if self.motion_checks - motions_before >= self._settings.motions:
                    return None
                needed_s = self._edge(here, there).sum()
                best_s = min(arrival.get(there, math.inf), latest_s - bounds[there])
                leaves_s = self._leave(here, there, arrival[here], best_s - needed_s)
                if leaves_s is not None:
                    arrival[there], came[there] = leaves_s + needed_s, (here, leaves_s)
                    heapq.heappush(queue, (arrival[there] + bounds[there], there))
        return None

    def _join(self, start: int) -> list[list[int]]:
        """Neighbours of every state: the roadmap's, with start and goals joined to their nearest milestones."""
        joined = [list(neighbors) for neighbors in self._joined]
        joined.append([*self._nearest(start), *range(start + 1, len(self._states))])
        for goal in range(start + 1, len(self._states)):
            for milestone in self._nearest(goal):
                joined[milestone].append(goal)
        return joined

    def _nearest(self, state: int) -> list[int]:
        """The milestones that can be reached soonest from a state."""
        arm = self.problem.query.arm
        apart = np.linalg.norm(self._milestones - self._states[state], axis=1)
        likely = np.argsort(apart)[: 4 * self._settings.neighbors]
        needed_s = least_durations(
            self._states[state],
            self._milestones[likely],
            arm.section_length_m,
            arm.max_bend_rate_rad_s,
            arm.max_tip_speed_m_s,
        )
        return [int(k) for k in likely[np.argsort(needed_s)[: self._settings.neighbors]]]

    def _least_times(self, start: int) -> FloatArray:
        """Lower bound on the time [s] from every state to the goal, by its tip's distance; 0 at goals."""
        query = self.problem.query
        distances = np.linalg.norm(query.arm.tips(self._states) - query.goal_m, axis=1) - query.goal_tolerance_m
        bounds = np.maximum(distances, 0.0) / query.arm.max_tip_speed_m_s
        bounds[start + 1 :] = 0.0
        return np.asarray(bounds)

    def _edge(self, here: int, there: int) -> FloatArray:
        """Durations [s] of the pieces of an edge, remembered between solves."""
        if (here, there) not in self._durations:
            arm = self.problem.query.arm
            self._durations[here, there] = _kernels.edge_durations(
                self._states[here],
                self._states[there],
                arm.section_length_m,
                arm.max_bend_rate_rad_s,
                arm.max_tip_speed_m_s,
            )
        return self._durations[here, there]

    def _leave(self, here: int, there: int, since_s: float, before_s: float) -> float | None:
        """Earliest time before ``before_s`` at which the edge is free, waiting at ``here`` from ``since_s`` on."""
        q, leaves_s = self._states[here], since_s
        for _ in range(self._settings.waits + 1):
            if leaves_s >= before_s:
                return None
            if self._is_free(here, there, leaves_s):
                return leaves_s
            if not self.problem.validator.check(q, leaves_s, q, leaves_s + self._settings.wait_s):
                return None
            leaves_s += self._settings.wait_s
        return None

    def _is_free(self, here: int, there: int, leaves_s: float) -> bool:
        self.motion_checks += 1
        arm = self.problem.query.arm
        return bool(
            _kernels.edge_valid(
                self._states[here],
                self._states[there],
                leaves_s,
                self._edge(here, there),
                arm.section_length_m,
                arm.radius_m,
                arm.max_bend_rad,
                arm.max_bend_rate_rad_s,
                arm.max_tip_speed_m_s,
                CONTACT_TOLERANCE_M,
                self.problem.query.world,
            )
        )

    def _path(self, goal: int, arrival: dict[int, float], came: dict[int, tuple[int, float]]) -> TimedPath:
        """Timed states from the start to ``goal``: waits, then the pieces of each edge."""
        edges = []
        there = goal
        while there in came:
            edges.append((came[there][0], there, came[there][1]))
            there = came[there][0]
        times, path = [arrival[there]], [self._states[there]]
        for here, there, leaves_s in reversed(edges):
            if leaves_s > times[-1]:
                times.append(leaves_s)
                path.append(self._states[here])
            durations = self._edge(here, there)
            shares = np.arange(1, len(durations) + 1) / len(durations)
            path.extend(self._states[here] + shares[:, None] * (self._states[there] - self._states[here]))
            times.extend(leaves_s + np.cumsum(durations))
        return TimedPath(np.array(times), np.array(path))


def build_roadmap(arm: ContinuumArm, settings: PRMSettings) -> tuple[FloatArray, list[list[int]]]:
    """OMPL's PRM of an arm among no obstacles: milestones (M, dof) [rad] and the neighbours of each.

    Randomness is OMPL's own generator, seeded by the session.
    """
    space = ob.RealVectorStateSpace(arm.dof)
    bounds = ob.RealVectorBounds(arm.dof)
    bounds.setLow(-arm.max_bend_rad)
    bounds.setHigh(arm.max_bend_rad)
    space.setBounds(bounds)
    si = ob.SpaceInformation(space)
    si.setStateValidityChecker(lambda state: bool(arm.within_bends(np.array([state[i] for i in range(arm.dof)]))))
    si.setStateValidityCheckingResolution(0.9)  # discs of bends are convex: the ends of a motion say it all
    si.setup()
    planner = og.PRM(si)
    planner.setMaxNearestNeighbors(settings.neighbors)
    planner.setProblemDefinition(ob.ProblemDefinition(si))
    planner.setup()
    left = iter(range(settings.milestones))
    planner.constructRoadmap(ob.PlannerTerminationCondition(lambda: next(left, None) is None))
    data = ob.PlannerData(si)
    planner.getPlannerData(data)
    count = data.numVertices()
    milestones = np.empty((count, arm.dof))
    for k in range(count):
        state = data.getVertex(k).getState()
        milestones[k] = [state[i] for i in range(arm.dof)]
    return milestones, [[int(j) for j in data.getEdges(k)] for k in range(count)]
