"""The audit of a motion that is given as backbone points, from any simulator, against the obstacles' true motion.

The body is a chain of capsules about the segments between neighbouring points, each point straight between its frames.
Spheres are taken exactly, other shapes as the spheres that hold them. Conservative advancement with bounded speeds
makes the swept verdict hold at every instant, as for bending vectors (docs/audit.md). Bends are not known, so nothing
is said of the executable verdict.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from scenarios import Scenario
from suite.auditor._kernels import CONTACT_M, KEPT_SHARE
from suite.auditor.verdicts import Kind, Verdict

MAX_LOOKS = 100_000
"""Beyond two a frame; what is not proven by then counts as contact."""

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True)
class PointsAudit:
    """What is found: two verdicts, and what else was measured on the way."""

    per_step: Verdict
    swept: Verdict
    arrival_time_s: float
    """First frame with the tip within the goal tolerance [s]; nan when there is none."""
    min_clearance_m: float
    """Smallest clearance until the first contact, or of the whole motion without one; inf without obstacles."""
    end_time_s: float
    """Where the audit ended [s]."""
    contact_obstacle: int | None = None
    """Which obstacle was touched first, counted from 1."""
    contact_segment: int | None = None
    """Which segment touched it, counted from 1 at the base."""


class _Balls:
    """The obstacles as spheres."""

    def __init__(self, scenario: Scenario) -> None:
        self._obstacles = scenario.obstacles
        covers = [obstacle.cover for obstacle in self._obstacles]
        self.owner = np.repeat(np.arange(len(covers)), [len(cover.radii_m) for cover in covers])
        self._offsets = np.concatenate([np.empty((0, 3)), *(cover.centers_m for cover in covers)])
        self.radii_m = np.concatenate([np.empty(0), *(cover.radii_m for cover in covers)])
        self.speeds_m_s = np.array([obstacle.motion.speed_bound_m_s for obstacle in self._obstacles])[self.owner]

    def at(self, time_s: float) -> FloatArray:
        """Centres (b, 3) [m]."""
        at = np.array([time_s])
        centers = np.array([obstacle.position(at)[0] for obstacle in self._obstacles]).reshape(-1, 3)
        return np.asarray(centers[self.owner] + self._offsets)


def audit_points(scenario: Scenario, times_s: FloatArray, points_m: FloatArray, radius_m: float) -> PointsAudit:
    """Judge a motion given as points along the backbone.

    Args:
        scenario: What the motion claims to solve; of its arm only the start's tip matters.
        times_s: Times of the frames from 0 on, shape (T,), [s].
        points_m: Points along the backbone, base first, shape (T, N, 3) with N >= 2, [m].
        radius_m: Radius of the body about the segments [m].
    """
    lie = _first_lie(scenario, times_s, points_m)
    if lie is not None and lie[0] == 0:
        failed = Verdict(False, 0.0, lie[1])
        return PointsAudit(failed, failed, math.nan, math.nan, 0.0)
    count = len(times_s) if lie is None else lie[0]
    times, points = times_s[:count], points_m[:count]
    there = np.linalg.norm(points[:, -1] - scenario.goal, axis=1) <= scenario.goal_tolerance_m
    in_time = there & (times <= scenario.time_limit_s)
    arrival = float(times[in_time.argmax()]) if in_time.any() else math.nan
    end = min(float(times[-1]), scenario.time_limit_s) if math.isnan(arrival) else arrival
    out_of_time = times[-1] >= scenario.time_limit_s
    short = Kind.TIME_LIMIT if out_of_time else lie[1] if lie else Kind.SHORT_OF_GOAL
    failure = Verdict(False, end, short) if math.isnan(arrival) else Verdict(success=True)
    balls = _Balls(scenario)
    per_step, swept, smallest, obstacle, segment = math.nan, math.nan, math.inf, None, None
    if len(balls.radii_m):
        looks = _Looks(times, points, radius_m, balls, end)
        swept, smallest, touched = looks.first_contact()
        per_step = looks.first_contact_at_whole_seconds()
        if not math.isnan(swept):
            obstacle, segment = int(balls.owner[touched[0]]) + 1, touched[1] + 1
    return PointsAudit(
        _with_contact(failure, per_step), _with_contact(failure, swept), arrival, smallest, end, obstacle, segment
    )


class _Looks:
    """Looks at one motion among the obstacles, from its first frame to ``end_s``."""

    def __init__(self, times_s: FloatArray, points_m: FloatArray, radius_m: float, balls: _Balls, end_s: float) -> None:
        self._times, self._points, self._radius, self._balls, self._end = times_s, points_m, radius_m, balls, end_s

    def gaps(self, time_s: float) -> FloatArray:
        """Clearance of every ball (b) from every segment (N - 1): (b, N - 1) [m]."""
        k = min(int(self._times.searchsorted(time_s, "right")) - 1, len(self._times) - 2)
        if k < 0:
            now = self._points[0]
        else:
            share = (time_s - self._times[k]) / (self._times[k + 1] - self._times[k])
            now = (1.0 - share) * self._points[k] + share * self._points[k + 1]
        apart = _to_segments(self._balls.at(time_s), now[:-1], now[1:])
        return np.asarray(apart - self._radius - self._balls.radii_m[:, None])

    def first_contact(self) -> tuple[float, float, tuple[int, int]]:
        """When, and by which ball and segment; nan when there is none. In between, the smallest clearance."""
        smallest, looks_left = math.inf, MAX_LOOKS + 2 * len(self._times)
        t = float(self._times[0])
        while True:
            gaps = self.gaps(t)
            smallest = min(smallest, float(gaps.min()))
            ahead = self._safe_until(t, gaps, smallest)
            looks_left -= 1
            if gaps.min() < CONTACT_M or (t < self._end and (ahead <= t or looks_left < 0)):
                ball, segment = np.unravel_index(gaps.argmin(), gaps.shape)
                return t, smallest, (int(ball), int(segment))
            if t >= self._end:
                return math.nan, smallest, (-1, -1)
            t = min(ahead, self._end)

    def _safe_until(self, t: float, gaps: FloatArray, smallest: float) -> float:
        """Until when no clearance falls to ``KEPT_SHARE`` of the smallest seen, within the present pair of frames."""
        k = min(int(self._times.searchsorted(t, "right")) - 1, len(self._times) - 2)
        if k < 0:
            return t
        duration = self._times[k + 1] - self._times[k]
        speeds = np.linalg.norm(self._points[k + 1] - self._points[k], axis=1) / duration
        closing = np.maximum(speeds[:-1], speeds[1:])[None] + self._balls.speeds_m_s[:, None]
        with np.errstate(divide="ignore"):
            spare = float(((gaps - KEPT_SHARE * smallest) / closing).min())
        return min(t + spare, float(self._times[k + 1]))

    def first_contact_at_whole_seconds(self) -> float:
        """The first whole second with a contact; nan when there is none."""
        for second in range(math.ceil(self._times[0]), math.floor(self._end) + 1):
            if self.gaps(float(second)).min() <= 0.0:
                return float(second)
        return math.nan


def _to_segments(centers: FloatArray, first: FloatArray, last: FloatArray) -> FloatArray:
    """Distances of points (b, 3) from segments (n, 3) to (n, 3): (b, n)."""
    along = last - first
    lengths = np.maximum((along * along).sum(axis=1), 1e-300)
    away = centers[:, None] - first[None]
    shares = np.clip((away * along).sum(axis=2) / lengths, 0.0, 1.0)
    return np.asarray(np.linalg.norm(away - shares[..., None] * along, axis=2))


def _first_lie(scenario: Scenario, times: FloatArray, points: FloatArray) -> tuple[int, Kind] | None:
    """The first frame that cannot be, and why."""
    finite = np.isfinite(times) & np.isfinite(points).all(axis=(1, 2))
    if not finite[0]:
        return 0, Kind.NOT_FINITE
    if times[0] != 0.0 or np.linalg.norm(points[0, -1] - scenario.arm.tip(scenario.start)) > scenario.goal_tolerance_m:
        return 0, Kind.WRONG_START
    backward = np.concatenate([[False], ~(np.diff(times) > 0.0)])
    wrong = (~finite | backward).nonzero()[0]
    if not len(wrong):
        return None
    return int(wrong[0]), Kind.BACKWARD_TIME if finite[wrong[0]] else Kind.NOT_FINITE


def _with_contact(failure: Verdict, contact_s: float) -> Verdict:
    """The earlier of a contact and of what failed otherwise."""
    if math.isnan(contact_s) or (not failure.success and failure.violation_time_s < contact_s):
        return failure
    return Verdict(False, contact_s, Kind.COLLISION)
