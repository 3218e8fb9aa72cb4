"""Section 1 by itself: which of its bends can still be had at a time, by an arm that has touched nothing so far.

A cell of bends is dropped only when every bend in it is hit at one instant. From one instant to the next the cells that
are left spread as far as the section can bend meanwhile; obstacles are not looked at in between. So at each instant the
cells hold the bend of every arm that is still under way: they are a tube about all trajectories.
"""

from typing import NamedTuple, Protocol

import numpy as np
import numpy.typing as npt

from scenarios.proofs import _kernels
from scenarios.proofs.allowance import ARRIVAL_SLACK_M, LATE_S, Allowance
from scenarios.proofs.bound import Bound, Reason
from scenarios.proofs.cells import Cells, cells_of
from scenarios.proofs.hulls import Hulls
from scenarios.scenario import Scenario
from scenarios.world import positions

COARSE, FINE = 80, 120
"""Cells to the largest bend; the fine ones are tried where the coarse ones leave little."""
SPREAD = 4.0
"""Edges of a cell that the section bends by in a step."""
MAX_STEPS, MAX_SPREAD = 4_000, 16.0
"""A time limit that takes more steps makes them longer; cells that spread further spread everywhere."""
LITTLE, LEFT_START = 200, 4
"""Few cells, and steps after which more than that would be left among no obstacles."""


class Tube(Protocol):
    """What it takes to follow a tube."""

    latest_s: float
    step_s: float

    @property
    def time_s(self) -> float:
        """The time that it is about [s]."""

    @property
    def left(self) -> int:
        """Number of cells that are left."""

    @property
    def may_arrive(self) -> bool:
        """Whether one of them may arrive before the next step."""

    def advance(self) -> None:
        """Go on to the next step."""


class SectionTube:
    """The cells of section 1 that are left at ``time_s``, step after step."""

    def __init__(self, scenario: Scenario, hulls: Hulls, bound: Bound, cells: Cells, step_s: float) -> None:
        """Start with what ``bound`` says of arrivals; ``step_s`` is the time from one look to the next."""
        arm, allowance = scenario.arm, Allowance.of(scenario.arm)
        self._hulls, self._speed_m_s = hulls, allowance.tip_speed_m_s
        self.cells, self.step_s, self._steps = cells, step_s, 0
        self.latest_s = min(bound.latest_s, scenario.time_limit_s + LATE_S)
        looks = int(self.latest_s / step_s) + 2
        self._centers_m = positions(scenario.obstacles, step_s * np.arange(looks, dtype=np.float64))
        turn = allowance.rate_rad_s * step_s
        self._offsets = cells.offsets(turn) if turn <= MAX_SPREAD * cells.edge_rad else None
        # A point at share s of the section moves by s^2 / 2 of its length per radian at most: docs/audit.md.
        per_rad = 0.5 * arm.section_length_m * cells.shares**2
        self._spacing_m = arm.section_length_m / len(cells.shares)
        self._shifts_m = per_rad * cells.half_rad
        # From the end of the section to the tip, and how far either is from where it is taken to be.
        self._rest_m = (arm.n_sections - 1) * arm.section_length_m + self._shifts_m[-1] + allowance.stray_m
        self._turned_m = per_rad[-1] * turn
        ends = cells.points_m[:, :, -1]
        self._from_start_m = np.linalg.norm(ends - arm.tip(scenario.start), axis=-1)
        self._from_goal_m = np.linalg.norm(ends - scenario.goal, axis=-1) - scenario.goal_tolerance_m - ARRIVAL_SLACK_M
        self._until_s, self._culprits = (
            np.full(cells.allowed.shape, -1.0),
            np.zeros(cells.allowed.shape, dtype=np.int16),
        )
        self.alive: npt.NDArray[np.bool_] = cells.around(scenario.start[:2]) & cells.allowed
        self._drop()

    @property
    def time_s(self) -> float:
        """The time that ``alive`` is about [s]."""
        return self._steps * self.step_s

    @property
    def left(self) -> int:
        """Number of cells that are left."""
        return int(np.count_nonzero(self.alive))

    @property
    def may_arrive(self) -> bool:
        """Whether an arm may arrive between now and the next step, as far as its section 1 is concerned."""
        return bool((self._from_goal_m[self.alive] <= self._rest_m + self._turned_m).any())

    def advance(self) -> None:
        """Go on to the next step."""
        self._steps += 1
        if self._offsets is None:
            self.alive = self.cells.allowed.copy()
        else:
            spread = np.empty_like(self.alive)
            _kernels.spread(self.alive, self.cells.allowed, self._offsets, spread)
            self.alive = spread
        self._drop()

    def _drop(self) -> None:
        """Drop the cells from which the tip cannot be where it is to be now, and those that are hit."""
        come_m = self._speed_m_s * self.time_s
        to_go_m = self._speed_m_s * max(0.0, self.latest_s - self.time_s)
        self.alive &= self._from_start_m <= self._rest_m + come_m
        self.alive &= self._from_goal_m <= self._rest_m + to_go_m
        centers, points = self._centers_m[self._steps], self.cells.points_m
        _kernels.strike(
            self.alive,
            self._until_s,
            self._culprits,
            self.time_s,
            points,
            self._spacing_m,
            self._shifts_m,
            centers,
            self._hulls,
        )


class Passage(NamedTuple):
    """What became of a tube."""

    first_s: float
    """Nobody arrives before [s]; inf: at all."""
    last_s: float
    """Nobody arrives at or after this [s]; inf when nothing is known of it."""
    narrow_s: float = -np.inf
    """Last time at which there was little left of the tube [s]; -inf: there never was."""

    def tighten(self, bound: Bound, reason: Reason) -> Bound:
        """Add it to ``bound``."""
        return bound.tightened(reason, self.first_s, self.last_s)


def tighten_by_section(scenario: Scenario, hulls: Hulls, bound: Bound) -> Bound:
    """What section 1 by itself adds to ``bound``."""
    passage = follow(_tube(scenario, hulls, bound, COARSE), bound.earliest_s)
    bound = passage.tighten(bound, Reason.SECTION)
    if bound.outcome != "impossible" and passage.narrow_s > 0.0:
        fine = _tube(scenario, hulls, bound, FINE)
        until_s = passage.narrow_s + LEFT_START * fine.step_s
        bound = follow(fine, bound.earliest_s, until_s).tighten(bound, Reason.SECTION)
    return bound


def _tube(scenario: Scenario, hulls: Hulls, bound: Bound, per_radius: int) -> SectionTube:
    arm = scenario.arm
    cells = cells_of(arm.section_length_m, arm.max_bend_rad, per_radius)
    step_s = SPREAD * cells.edge_rad / Allowance.of(arm).rate_rad_s
    return SectionTube(scenario, hulls, bound, cells, max(step_s, scenario.time_limit_s / MAX_STEPS))


def follow(tube: Tube, earliest_s: float, until_s: float = np.inf) -> Passage:
    """Follow a tube to its end, or up to ``until_s`` [s]; nobody is known to arrive before ``earliest_s`` [s]."""
    first, last, narrow = np.inf, -np.inf, -np.inf
    while tube.left:
        next_s = tube.time_s + tube.step_s
        if next_s >= earliest_s and tube.may_arrive:
            first, last = min(first, tube.time_s), next_s
        if tube.time_s >= LEFT_START * tube.step_s and tube.left < LITTLE:
            narrow = tube.time_s
        if next_s > tube.latest_s:
            break
        if next_s > until_s:
            return Passage(min(first, next_s), np.inf, narrow)
        tube.advance()
    return Passage(first, last if last <= tube.latest_s else np.inf, narrow)
