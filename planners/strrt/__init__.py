"""ST-RRT*: trees from the start and from goals at times of arrival that are not known beforehand.

Grothe, Hartmann, Orthey and Toussaint, ICRA 2022 (arXiv 2203.02176). The search is compiled as a whole, ``_kernels``;
here are its settings, and the way from OMPL to it and back. ``docs/strrt.md`` compares it with the paper and with OMPL.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from ompl import util as ou
from pydantic import BaseModel, ConfigDict, Field

from planners.base import ReplanningPlanner
from planners.problem import SpaceTimeProblem, TimedPath
from planners.strrt import _kernels
from planners.strrt.region import _kernels as region
from planners.strrt.trees import _kernels as trees
from scenarios.arm import ContinuumArm, FloatArray
from scenarios.collision import CONTACT_TOLERANCE_M
from scenarios.kernels.kinematics import ARC_SIZE

RATE_RESERVE = 0.02
"""Share of the arm's rates held back: the tip's speed is measured on chords, over which it varies by up to 2 %."""
CHUNK = 50
"""Iterations between two questions whether to stop."""


class STRRTSettings(BaseModel):
    """Settings of ``strrt``; the first five bear the paper's names."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    p_goal: float = Field(default=0.5, gt=0, le=1, description="probability to sample a new goal in an iteration")
    range_factor: float = Field(default=2.0, gt=1, le=100, description="growth of the goal region's times at a batch")
    initial_batch_size: int = Field(default=64, ge=1, le=10**9, description="samples before the first growth")
    sample_ratio: float = Field(default=0.75, gt=0, lt=1, description="share of a later batch for what it has grown by")
    weight: float = Field(default=0.5, gt=0, lt=1, description="lambda: weight of the way against the time it is given")
    range: float = Field(default=10.0, gt=0, le=1000, description="longest motion added to a tree, as distance [s]")
    rewiring: bool = Field(default=True, description="whether near nodes are tried and the goal tree is rewired")
    iterations: int = Field(default=300, ge=1, le=10**7, description="budget of one solve")
    refinements: int = Field(default=50, ge=0, le=10**7, description="iterations after the first path")
    nodes: int = Field(default=4000, ge=10, le=10**6, description="largest tree")
    horizon_s: float = Field(default=90.0, gt=0, le=3600, description="latest arrival considered, from now")


class Workspace(NamedTuple):
    """The arrays of a search, made once per planner."""

    start_tree: trees.Tree
    goal_tree: trees.Tree
    work: trees.Work

    @classmethod
    def of(cls, n_sections: int, capacity: int) -> "Workspace":
        """Arrays for an arm of ``n_sections`` and trees of up to ``capacity`` nodes."""
        dof = 2 * n_sections

        def tree() -> trees.Tree:
            return trees.Tree(
                states=np.empty((capacity, dof)),
                tips=np.empty((capacity, 3)),
                times=np.empty(capacity),
                parents=np.empty(capacity, np.int64),
                arrivals=np.empty(capacity),
                joined=np.empty(capacity, np.int64),
                fresh=np.empty(capacity, np.bool_),
                size=np.zeros(1, np.int64),
            )

        work = trees.Work(
            state=np.empty(dof),
            tip=np.empty(3),
            step=np.empty(dof),
            glance=np.empty(dof),
            arcs=np.empty((n_sections, ARC_SIZE)),
            far=np.empty(capacity),
            near=np.empty(capacity, np.int64),
            checks=np.zeros(2, np.int64),
        )
        return cls(tree(), tree(), work)


def numbers_of(arm: ContinuumArm) -> trees.Arm:
    """The numbers of ``arm`` with its rates cut by the reserve."""
    return trees.Arm(
        arm.section_length_m,
        arm.radius_m,
        arm.max_bend_rad,
        (1.0 - RATE_RESERVE) * arm.max_bend_rate_rad_s,
        (1.0 - RATE_RESERVE) * arm.max_tip_speed_m_s,
        CONTACT_TOLERANCE_M,
    )


class STRRTPlanner(ReplanningPlanner):
    """``strrt``: searches anew at every solve."""

    name = "strrt"
    settings_model = STRRTSettings
    budget = ("iterations", "refinements", "nodes")
    summary = "ST-RRT* in space-time, replanned when the prediction invalidates the path"
    source = "Grothe et al., ICRA 2022"

    def __init__(self, problem: SpaceTimeProblem, settings: STRRTSettings) -> None:
        """Plan on ``problem``; random numbers derive from OMPL's seed."""
        super().__init__(problem, settings)
        arm = problem.query.arm
        self._settings, self._arm = settings, numbers_of(arm)
        self.workspace = Workspace.of(arm.n_sections, settings.nodes)
        """The trees of the latest search."""
        self._rng = np.array([ou.RNG().uniformInt(0, 2**31 - 1)], np.uint64)

    def search(self, q: FloatArray, now_s: float, stop: Callable[[], bool]) -> TimedPath | None:
        """The path that arrives first; without one, the one that stays free longest."""
        configurations = self.goal.configurations
        if len(configurations) == 0:
            return None
        settings, space = self._settings, self.workspace
        least_s = np.full(len(configurations), np.nan)
        goals = region.Goals(configurations, self.problem.query.arm.tips(configurations), least_s)
        parameters = region.Parameters(
            settings.p_goal,
            settings.range_factor,
            float(settings.initial_batch_size),
            settings.sample_ratio,
            settings.weight,
            settings.range,
            settings.rewiring,
            now_s + settings.horizon_s,
        )
        space.start_tree.size[0] = space.goal_tree.size[0] = 0
        space.work.checks[:] = 0
        trees.add_node(space.start_tree, q, now_s, -1, self._arm, space.work)
        bound, done, last = region.initialize_bound(parameters), 0, settings.iterations
        while done < last and not stop():
            searching = math.isinf(bound.t_max)
            bound, done = _kernels.search(
                done,
                min(done + CHUNK, last),
                bound,
                parameters,
                self._rng,
                goals,
                self._arm,
                self.problem.query.world,
                *space,
            )
            if searching and math.isfinite(bound.t_max):
                last = min(last, done + settings.refinements)
        self.state_checks += int(space.work.checks[0])
        self.motion_checks += int(space.work.checks[1])
        return self._path()

    def _path(self) -> TimedPath | None:
        """The best path in the trees; None where the start tree has nothing but its root."""
        start_tree, goal_tree, _ = self.workspace
        joined = int(_kernels.best_join(goal_tree))
        node = int(goal_tree.joined[joined] if joined >= 0 else np.argmax(start_tree.times[: start_tree.size[0]]))
        before = _ancestry(start_tree, node)[::-1]
        after = _ancestry(goal_tree, joined)[1:] if joined >= 0 else []  # the joined states are one
        if len(before) + len(after) < 2:
            return None
        return TimedPath(
            np.concatenate([start_tree.times[before], goal_tree.times[after]]),
            np.concatenate([start_tree.states[before], goal_tree.states[after]]),
        )


def _ancestry(tree: trees.Tree, node: int) -> list[int]:
    """The node, its parent and so on up to the root."""
    nodes = [node]
    while (parent := int(tree.parents[nodes[-1]])) >= 0:
        nodes.append(parent)
    return nodes
