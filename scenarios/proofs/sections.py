"""Sections 1 and 2 together: which pairs of bends can still be had at a time.

The same tube as in ``section``, now in four dimensions. The cells are five times as coarse as those of a tube of
section 1 that runs beside it: of a cell of section 1 only those fine ones are looked at which that tube still holds.
"""

import numpy as np
import numpy.typing as npt

from scenarios.proofs import _kernels
from scenarios.proofs.allowance import ARRIVAL_SLACK_M, Allowance
from scenarios.proofs.bound import Bound, Reason
from scenarios.proofs.cells import arc_points, cells_of, end_frames
from scenarios.proofs.hulls import Hulls
from scenarios.proofs.section import SectionTube, follow
from scenarios.scenario import Scenario
from scenarios.world import positions

PER_RADIUS = 32
"""Cells to the largest bend, of either section."""
PARTS = 5
"""Fine cells of section 1 along an edge of a coarse one."""
SPREAD = 2.0
"""Edges of a cell that a section bends by in a step."""
FINE_STEPS = 2
"""Steps of the fine tube in one of this."""
MAX_STEPS = 1_000


class SectionsTube:
    """The pairs of cells of sections 1 and 2 that are left at ``time_s``, step after step."""

    def __init__(self, scenario: Scenario, hulls: Hulls, bound: Bound) -> None:
        """Start with what ``bound`` says of arrivals."""
        arm, allowance = scenario.arm, Allowance.of(scenario.arm)
        length_m, max_bend = arm.section_length_m, arm.max_bend_rad
        coarse, fine = cells_of(length_m, max_bend, PER_RADIUS), cells_of(length_m, max_bend, PARTS * PER_RADIUS)
        self.step_s = SPREAD * coarse.edge_rad / allowance.rate_rad_s
        self.first = SectionTube(scenario, hulls, bound, fine, self.step_s / FINE_STEPS)
        self.latest_s = self.first.latest_s
        self._scenario, self._hulls, self._allowance = scenario, hulls, allowance
        self._places = np.argwhere(coarse.allowed)
        self._neighbours = _neighbours(coarse.allowed, coarse.offsets(allowance.rate_rad_s * self.step_s))
        self._parts = _parts(self._places, len(coarse.middles_rad), len(fine.middles_rad))
        bends = fine.middles_rad[self._parts].reshape(-1, 2)
        shape = self._parts.shape[:2]
        self._frames = end_frames(bends).reshape(*shape, 3, 3)
        self._ends_m = np.ascontiguousarray(length_m * arc_points(bends).reshape(*shape, 3))
        self._points_m = np.ascontiguousarray(coarse.points_m[coarse.allowed])
        # A point at share s of section 2 moves by 1/2 + s of a length per radian of section 1: docs/audit.md.
        by_first, by_second = length_m * (0.5 + coarse.shares), 0.5 * length_m * coarse.shares**2
        self._shifts_m = by_first * fine.half_rad + by_second * coarse.half_rad
        per_rad = by_first[-1] + by_second[-1]
        self._rest_m = (arm.n_sections - 2) * length_m + per_rad * coarse.half_rad + allowance.stray_m
        self._turned_m = per_rad * allowance.rate_rad_s * self.step_s
        bent = [coarse.around(scenario.start[k : k + 2])[coarse.allowed] for k in (0, 2)]
        self.alive: npt.NDArray[np.bool_] = np.outer(*bent)
        self._until_s = np.full(self.alive.shape, -1.0, dtype=np.float32)
        self._culprits = np.zeros(self.alive.shape, dtype=np.int16)
        self._strike()

    @property
    def time_s(self) -> float:
        """The time that ``alive`` is about [s]."""
        return self.first.time_s

    def advance(self) -> None:
        """Go on to the next step."""
        for _ in range(FINE_STEPS):
            self.first.advance()
        spread = np.empty_like(self.alive)
        _kernels.spread_pairs(self.alive, self._held().any(axis=1), self._neighbours, spread)
        self.alive = spread
        self._strike()

    def pairs_of(self, bends_rad: npt.ArrayLike) -> npt.NDArray[np.intp]:
        """Rows and columns of ``alive`` (2,) of the cells about the bends (u1, v1, u2, v2) [rad]."""
        coarse = cells_of(self._scenario.arm.section_length_m, self._scenario.arm.max_bend_rad, PER_RADIUS)
        middles = coarse.middles_rad[self._places]
        return np.array([np.abs(middles - bend).max(axis=1).argmin() for bend in np.reshape(bends_rad, (2, 2))])

    def _held(self) -> npt.NDArray[np.bool_]:
        """Parts of the cells of section 1 that its own tube holds, shape (K, PARTS^2)."""
        return np.ascontiguousarray(self.first.alive[self._parts[..., 0], self._parts[..., 1]])

    def _strike(self) -> None:
        scenario, speed = self._scenario, self._allowance.tip_speed_m_s
        arrival_m = scenario.goal_tolerance_m + ARRIVAL_SLACK_M + self._rest_m
        to_go_m = speed * max(0.0, self.latest_s - self.time_s)
        far = np.array([self._rest_m + speed * self.time_s, arrival_m + to_go_m, arrival_m + self._turned_m])
        self.left, self.may_arrive = _kernels.strike_pairs(
            self.alive,
            self._until_s,
            self._culprits,
            self.time_s,
            self._held(),
            self._frames,
            self._ends_m,
            self._points_m,
            scenario.arm.section_length_m / self._points_m.shape[1],
            self._shifts_m,
            positions(scenario.obstacles, np.array([self.time_s]))[0],
            self._hulls,
            scenario.arm.tip(scenario.start),
            scenario.goal,
            far,
        )
        # Section 1 can be nowhere where section 2 has nowhere to go.
        lost = self._parts[~self.alive.any(axis=1)].reshape(-1, 2)
        self.first.alive[lost[:, 0], lost[:, 1]] = False


def tighten_by_sections(scenario: Scenario, hulls: Hulls, bound: Bound) -> Bound:
    """What sections 1 and 2 add to ``bound``; nothing where the arm has one, or would take too many steps."""
    steps = 0.5 * scenario.arm.max_bend_rate_rad_s * scenario.time_limit_s * PER_RADIUS / scenario.arm.max_bend_rad
    if scenario.arm.n_sections < 2 or steps > MAX_STEPS:
        return bound
    return follow(SectionsTube(scenario, hulls, bound), bound.earliest_s).tighten(bound, Reason.SECTIONS)


def _neighbours(allowed: npt.NDArray[np.bool_], offsets: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
    """For each allowed cell those at ``offsets`` (M, 2) from it, by their numbers, -1 behind the last: (K, M)."""
    numbers = np.full(np.array(allowed.shape) + 2 * np.abs(offsets).max(), -1)
    margin = int(np.abs(offsets).max())
    numbers[margin:-margin, margin:-margin][allowed] = np.arange(np.count_nonzero(allowed))
    places = np.argwhere(allowed)[:, None] + margin + offsets
    found = numbers[places[..., 0], places[..., 1]]
    return np.ascontiguousarray(np.take_along_axis(found, np.argsort(found < 0, axis=1, kind="stable"), axis=1))


def _parts(places: npt.NDArray[np.intp], coarse: int, fine: int) -> npt.NDArray[np.intp]:
    """Fine cells, by row and column, of which coarse ones at ``places`` (K, 2) consist: (K, PARTS^2, 2).

    Both grids have a cell about (0, 0). At the rim, where a fine one is missing, another stands in for it.
    """
    steps = np.arange(PARTS) - PARTS // 2
    parts = np.stack(np.meshgrid(steps, steps, indexing="ij"), axis=-1).reshape(-1, 2)
    of_middle = (places - coarse // 2)[:, None] * PARTS + parts + fine // 2
    return np.asarray(np.clip(of_middle, 0, fine - 1))
