"""The planners around the search: what they keep between solves, and the margins they try."""

import functools
import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from ompl import util as ou
from pydantic import BaseModel, ConfigDict, Field

from planners.base import ReplanningPlanner
from planners.continuous import _kernels
from planners.continuous.workspace import Workspace, body_of
from planners.problem import SpaceTimeProblem, TimedPath
from scenarios.arm import FloatArray
from scenarios.world import SampledWorld

RATE_RESERVE = 0.01
"""Share of the arm's rates held back: the tip's speed within a step is known from three instants."""
GOAL_SHARE = 0.9
"""Share of the goal tolerance at which the tip is to arrive."""
LAST_RATE_RESERVE, LAST_GOAL_SHARE = 0.0005, 0.999
"""The same for ``clairvoyant`` where they may decide whether a scenario is possible; what then goes too fast fails."""
MARGIN_M = 5e-5
"""Clearance kept beyond the validator's: obstacles go straight between samples here, not in truth."""
PRESSING_S = 60.0
"""An arm that is safe for less than this, with no path to the goal, goes on searching in earnest."""
MARGIN_SHARES = (1.0, 0.5, 0.0, -0.5)
"""Of the whole margin, in the order in which an arm takes to them that found no way with the one before.

The last takes obstacles for smaller than they are, for an arm which errors of prediction have put into obstacles or
behind them: it would stand still where there often is a way.
"""
NEAR_S, FAR_S = 2.0, 4.0
"""Until when a motion is about to be executed, and from when on it will have been thought over."""
ROOM_S = 3.0
"""An arm has somewhere to go if it finds a path that is free for as long as this."""
IMMINENT_S = 5.0
"""A path that is free for longer than this is not given up for one with less margin, unless that leads to the goal."""
FADING = 0.8
"""Its budget from one failed search to the next: the tree has tried much of what there is, and things change."""


class SearchSettings(BaseModel):
    """Settings of a search."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    horizon_s: float = Field(default=120.0, gt=0, le=3600, description="latest arrival considered, from now")
    branches: int = Field(default=700, ge=1, le=10**7, description="budget of a search, in branches of the tree")
    refinements: int = Field(default=20, ge=0, le=10**7, description="branches after the goal was first reached")
    enough: float = Field(default=1.1, ge=1, description="no refining below this multiple of the straight way's time")
    bounces: int = Field(default=2, ge=0, le=1000, description="new postures a blocked branch tries")
    step_s: float = Field(default=0.5, gt=0.01, le=1, description="duration of a motion of the tree")
    nodes: int = Field(default=40000, ge=100, le=10**7, description="largest tree")


class ContinuousSettings(SearchSettings):
    """Settings of ``temporal-ct``."""

    retry_branches: int = Field(
        default=5, ge=1, le=10**7, description="the budget of an arm that is safe, but has no path to the goal"
    )
    margin: float = Field(default=2.0, ge=0, le=10, description="error bounds kept clear of, in standard deviations")


class ClairvoyantSettings(SearchSettings):
    """Settings of ``clairvoyant``."""

    branches: int = Field(default=4000, ge=1, le=10**7, description="budget of a search, in branches of the tree")
    refinements: int = Field(default=400, ge=0, le=10**7, description="branches after the goal was first reached")
    enough: float = Field(default=1.0, ge=1, description="no refining below this multiple of the straight way's time")
    bounces: int = Field(default=5, ge=0, le=1000, description="new postures a blocked branch tries")
    restarts: int = Field(
        default=20,
        ge=1,
        le=10**6,
        description="searches made until one reaches the goal, twice: at last as fast as the arm may go",
    )


class Found(NamedTuple):
    """What a search found."""

    path: TimedPath
    reaches: bool
    """Whether the path leads to the goal; otherwise it is the one that stays safe longest."""

    @property
    def lasts_s(self) -> float:
        """For how long the path is free [s]."""
        return float(self.path.times_s[-1] - self.path.times_s[0])

    def or_else(self, tried: "Found") -> "Found":
        """The better of this and what was ``tried`` with less margin: a way to the goal, or much more time in need."""
        in_need = not self.reaches and self.lasts_s < IMMINENT_S
        return tried if tried.reaches or (in_need and tried.lasts_s > self.lasts_s + IMMINENT_S) else self


class TreePlanner(ReplanningPlanner):
    """One search after another, the order being for the subclass; they share arrays, random numbers and counts."""

    def __init__(self, problem: SpaceTimeProblem, settings: SearchSettings) -> None:
        """Plan on ``problem``; random numbers derive from OMPL's seed."""
        super().__init__(problem, settings)
        arm = problem.query.arm
        self._settings, self._body, self._goal_share = settings, body_of(arm, RATE_RESERVE), GOAL_SHARE
        self._workspace = Workspace.of(arm, settings.nodes)
        self._rng = np.array([ou.RNG().uniformInt(0, 2**31 - 1)], np.uint64)

    def plant_tree(self, trunk: TimedPath, world: SampledWorld) -> None:
        """Start a tree from what of the path ``trunk`` is free of the obstacles of ``world``."""
        space = self._workspace
        _kernels.plant(
            space.tree, trunk.times_s, trunk.configurations_rad, MARGIN_M, self._body, world, space.step, space.stack
        )

    def grow_tree(self, world: SampledWorld, branches: int) -> Found:
        """Search on from the tree as it stands, all of which is free of the obstacles of ``world``."""
        query, settings, space = self.problem.query, self._settings, self._workspace
        tree, stop_m = space.tree, self._goal_share * query.goal_tolerance_m
        budget = _kernels.Budget(
            branches, settings.refinements, settings.bounces, settings.enough, settings.step_s, MARGIN_M
        )
        end_s = tree.times[0] + settings.horizon_s
        best, longest = _kernels.search(query.goal_m, stop_m, end_s, budget, self._rng, self._body, world, *space)
        self.state_checks += int(tree.counts[1])
        self.motion_checks += int(tree.counts[2])
        tree.counts[1:] = 0
        return Found(space.path_to(best if best >= 0 else longest), best >= 0)


class ContinuousPlanner(TreePlanner):
    """``temporal-ct``: replans from the free part of its last path; evades where no path to the goal is found."""

    name = "temporal-ct"
    settings_model = ContinuousSettings
    budget = ("branches", "refinements", "retry_branches", "nodes")
    summary = "space-time tree of steered runs, valid at every instant, repaired when the prediction changes"
    source = "this suite: docs/temporal-ct.md"

    def __init__(self, problem: SpaceTimeProblem, settings: ContinuousSettings) -> None:
        """Plan on ``problem`` with a budget for each solve."""
        super().__init__(problem, settings)
        self._branches, self._retry_branches = settings.branches, settings.retry_branches
        asked = problem.query.asked_margin
        self._margin = settings.margin if asked is None else asked
        self._last: Found | None = None
        self._failures = 0

    def search(self, q: FloatArray, now_s: float, stop: Callable[[], bool]) -> TimedPath | None:
        """A path to the goal with as wide a margin as can be had; else the one that stays safe longest."""
        trunk, branches = self._rest_of_last_path(q, now_s), self._budget(now_s)
        found = self._widest_way(trunk, branches, stop)
        self._last = found
        self._failures = 0 if found.reaches else self._failures + 1
        return found.path if len(found.path.times_s) > 1 else None

    def _widest_way(self, trunk: TimedPath, branches: int, stop: Callable[[], bool]) -> Found:
        """Search among the obstacles with one margin after another, until a way to the goal is found.

        What is about to be executed keeps the widest margin with which the arm had anywhere to go; only further ahead,
        where more will have been seen by then, is it the margin that is being tried. What is free among obstacles
        is free among smaller ones: there the tree is grown further.
        """
        found, near, before = list[Found](), None, -math.inf
        for share in self._shares():
            if found and stop():
                break
            world = self._world(share if near is None else near, share)
            if share > before:
                self.plant_tree(trunk, world)
            tried, before = self.grow_tree(world, branches), share
            found.append(tried)
            if share == MARGIN_SHARES[-1]:
                # A way among obstacles is one among smaller ones too: where the smallest leave none, no margin does.
                if not tried.reaches:
                    break
            elif tried.reaches:
                break
            elif near is None and tried.lasts_s >= ROOM_S:
                near = share
        return functools.reduce(Found.or_else, found)

    def _shares(self) -> tuple[float, ...]:
        """Shares of the margin to try: one where it makes no difference; the least second where none did before."""
        bounds = self.problem.query.prediction.bounds_m
        if self._margin * min(float(bounds.max(initial=0.0)), self.largest_bound_m) <= MARGIN_M:
            return MARGIN_SHARES[:1]
        widest, *others, least = MARGIN_SHARES
        return (widest, least, *others) if self._failures else MARGIN_SHARES

    def _world(self, near: float, far: float) -> SampledWorld:
        """The predicted obstacles with one share of the margin in the next seconds and another further ahead."""
        prediction = self.problem.query.prediction
        passed = np.clip((prediction.ahead_s - NEAR_S) / (FAR_S - NEAR_S), 0.0, 1.0)
        return prediction.world(self._margin * (near + (far - near) * passed), self.largest_bound_m)

    def _budget(self, now_s: float) -> int:
        """Branches of the next search: all of them at first, few while the arm is safe without a path to the goal."""
        if self._last is not None and not self._last.reaches and self._last.path.times_s[-1] >= now_s + PRESSING_S:
            return self._retry_branches
        return max(self._retry_branches, int(self._branches * FADING**self._failures))

    def _rest_of_last_path(self, q: FloatArray, now_s: float) -> TimedPath:
        """What is left of the last path, from the present state on; the present state alone when it is not on it."""
        here = TimedPath(np.array([now_s]), q[None])
        if self._last is None:
            return here
        times, path = self._last.path
        first = int(times.searchsorted(now_s + 1e-9, "right"))
        if not 0 < first < len(times):
            return here
        passed = (now_s - times[first - 1]) / (times[first] - times[first - 1])
        expected = path[first - 1] + passed * (path[first] - path[first - 1])
        if np.abs(expected - q).max() > 1e-9:
            return here
        return TimedPath(np.append(now_s, times[first:]), np.vstack([q, path[first:]]))


class ClairvoyantPlanner(TreePlanner):
    """``clairvoyant``: restarts a large search until one reaches the goal."""

    name = "clairvoyant"
    settings_model = ClairvoyantSettings
    budget = ("branches", "refinements", "nodes")
    summary = "the same search with the true motion, a large budget and restarts"
    source = "this suite: docs/temporal-ct.md"
    commitment = "path"
    prediction_margin = 0.0
    largest_bound_m = math.inf
    is_bound = True

    def __init__(self, problem: SpaceTimeProblem, settings: ClairvoyantSettings) -> None:
        """Plan on ``problem``, whose prediction is the truth."""
        super().__init__(problem, settings)
        self._restarts, self._branches = settings.restarts, settings.branches

    def search(self, q: FloatArray, now_s: float, stop: Callable[[], bool]) -> TimedPath | None:
        """The first path to the goal; else the one that stays safe longest."""
        here, world = TimedPath(np.array([now_s]), q[None]), self.problem.query.world
        found: Found | None = None
        for restart in range(2 * self._restarts):
            if found is not None and (found.reaches or stop()):
                break
            if restart == self._restarts:
                self._body, self._goal_share = body_of(self.problem.query.arm, LAST_RATE_RESERVE), LAST_GOAL_SHARE
            self.plant_tree(here, world)
            tried = self.grow_tree(world, self._branches)
            if found is None or tried.reaches or tried.path.times_s[-1] > found.path.times_s[-1]:
                found = tried
        return found.path if found is not None and len(found.path.times_s) > 1 else None
