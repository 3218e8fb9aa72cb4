"""Recorded tracks as scenarios: who was where, an arm among them, and when a scenario begins."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import numpy.typing as npt
from pydantic import ValidationError

from scenarios import ContinuumArm, Obstacle, Scenario, Track
from suite.errors import SuiteError, one_line
from suite.exchange.layouts import MAX_BODIES, UNITS_M, Recording, Sample, read_recording

MAX_SCENARIOS = 10_000
GAP = 1.5
"""A step this many times a track's usual one is a gap."""

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Setting:
    """What a recording does not say: the arm among the bodies, and where it is to go."""

    arm: ContinuumArm = field(default_factory=ContinuumArm)
    start_rad: tuple[float, ...] | None = None
    """Start configuration; straight when None."""
    goal_m: tuple[float, float, float] | None = None
    """Goal point; where the tip is when every section bends by 0.5 rad along x, when None."""
    time_limit_s: float = 120.0
    observation_s: float = 5.0

    def scenario(self, name: str, obstacles: Sequence[Obstacle], source: str) -> Scenario:
        """A scenario of this setting.

        Raises:
            SuiteError: Something does not fit.
        """
        bent = np.array([0.5, 0.0] * self.arm.n_sections)
        goal = self.goal_m or tuple(self.arm.tip(np.minimum(bent, self.arm.max_bend_rad)).tolist())
        try:
            return Scenario(
                id=name,
                family=source,
                arm=self.arm,
                start_rad=self.start_rad or (0.0,) * self.arm.dof,
                goal_m=goal,
                obstacles=tuple(obstacles),
                time_limit_s=self.time_limit_s,
                observation_s=self.observation_s,
            )
        except ValidationError as error:
            raise SuiteError(one_line(error)) from None


@dataclass(frozen=True)
class Placing:
    """How a recording's numbers become metres in the arm's frame."""

    unit: str | None = None
    """``mm``, ``cm`` or ``m``; the file's own when None, metres if it names none."""
    up: str = "z"
    """Axis of the file that points upward: ``z``, or ``y`` as in Motive's default."""
    offset_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Added last."""
    radius_m: float = 0.03
    """Of bodies whose radius the file does not say."""
    gap_s: float | None = None
    """A step longer than this is a gap; ``GAP`` usual steps of the track when None."""


class Body:
    """One body of a recording, in metres and in the arm's frame."""

    def __init__(self, name: str, samples: Sequence[Sample], placing: Placing, unit_m: float) -> None:
        """Sort the samples in time and leave out those in which it was not seen.

        Raises:
            SuiteError: Two samples of one time, or radii that differ.
        """
        seen = sorted((s for s in samples if np.isfinite(s.point).all()), key=lambda sample: sample.time_s)
        self.times_s = np.array([sample.time_s for sample in seen])
        if not np.isfinite(self.times_s).all():
            raise SuiteError(f"{name}: found a sample without time, allowed a number [s]")
        points = unit_m * np.array([sample.point for sample in seen])
        if placing.up == "y":  # a quarter turn about x
            points = np.column_stack([points[:, 0], -points[:, 2], points[:, 1]])
        self.points_m = points + placing.offset_m
        steps = np.diff(self.times_s)
        if (steps <= 0.0).any():
            when = self.times_s[1:][steps <= 0.0][0]
            raise SuiteError(f"{name}: found two samples at t = {when:g} s, allowed one")
        longest = placing.gap_s or (GAP * float(np.median(steps)) if len(steps) else np.inf)
        self.gaps = np.column_stack([self.times_s[:-1], self.times_s[1:]])[steps > longest]
        radii = {sample.radius for sample in seen if np.isfinite(sample.radius)}
        if len(radii) > 1:
            raise SuiteError(f"{name}: found radii from {min(radii):g} to {max(radii):g}, allowed one for each body")
        self.radius_m = unit_m * radii.pop() if radii else placing.radius_m

    def obstacle(self, zero_s: float, first_s: float, last_s: float) -> Obstacle:
        """What it does from ``first_s`` to ``last_s`` of the recording, where ``zero_s`` is t = 0.

        Raises:
            SuiteError: A number out of range.
        """
        low = max(int(self.times_s.searchsorted(first_s, "right")) - 1, 0)
        high = min(int(self.times_s.searchsorted(last_s, "left")) + 1, len(self.times_s))
        low = min(low, high - 1)
        times = self.times_s[low:high]
        gaps = self.gaps[(self.gaps[:, 0] >= times[0]) & (self.gaps[:, 1] <= times[-1])] - zero_s
        try:
            track = Track(
                times_s=tuple((times - zero_s).tolist()),
                positions_m=tuple(map(tuple, self.points_m[low:high].tolist())),
                gaps_s=tuple(map(tuple, gaps.tolist())),
            )
            return Obstacle(radius_m=self.radius_m, motion=track)
        except ValidationError as error:
            raise SuiteError(one_line(error)) from None


def import_tracks(
    file: Path,
    setting: Setting,
    placing: Placing,
    *,
    layout: str = "auto",
    fps: float = 25.0,
    begin_s: float | None = None,
    every_s: float | None = None,
) -> Iterator[Scenario]:
    """Scenarios in which the bodies of a recording are obstacles.

    Args:
        file: The recording.
        setting: Arm, start, goal and times.
        placing: How its numbers become metres.
        layout: A key of ``LAYOUTS``, or ``auto``.
        fps: Frames per second of layouts that count frames.
        begin_s: Time in the file that is t = 0 of the first scenario; when None, the first at which there is as much
            to observe before as the setting asks for.
        every_s: A scenario begins every so many seconds until the recording ends; one scenario when None.

    Raises:
        SuiteError: The file or an option is wrong.
    """
    recording = read_recording(file, layout, fps)
    bodies = _bodies(file, recording, placing)
    first = min(float(body.times_s[0]) for body in bodies)
    last = max(float(body.times_s[-1]) for body in bodies)
    begin = first + setting.observation_s if begin_s is None else begin_s
    if every_s is not None and not every_s > 0:
        raise SuiteError(f"--every: found {every_s:g}, allowed above 0")
    count = 1 if every_s is None else max(1, int(np.floor((last - begin) / every_s)) + 1)
    if count > MAX_SCENARIOS:
        raise SuiteError(f"--every: found {every_s:g}, which makes {count} scenarios, allowed {MAX_SCENARIOS}")
    stem = re.sub(r"[^A-Za-z0-9._-]+", "-", file.stem)[:80] or "tracks"
    for k in range(count):
        zero = begin + k * (every_s or 0.0)
        window = zero - setting.observation_s, zero + setting.time_limit_s
        obstacles = [body.obstacle(zero, *window) for body in bodies if _overlaps(body, *window)]
        yield setting.scenario(f"{stem}-{k:04d}" if count > 1 else stem, obstacles, "tracks")


def _bodies(file: Path, recording: Recording, placing: Placing) -> list[Body]:
    """Those that were seen at all."""
    by_name: dict[str, list[Sample]] = {}
    for sample in recording.samples:
        by_name.setdefault(sample.body, []).append(sample)
    if len(by_name) > MAX_BODIES:
        raise SuiteError(f"{file}: found {len(by_name)} bodies, allowed {MAX_BODIES}")
    unit_m = UNITS_M[placing.unit or recording.unit or "m"]
    seen = {name: all_of for name, all_of in by_name.items() if any(np.isfinite(s.point).all() for s in all_of)}
    return [Body(f"{file}: {name}", all_of, placing, unit_m) for name, all_of in seen.items()]


def _overlaps(body: Body, first_s: float, last_s: float) -> bool:
    return bool(body.times_s[0] <= last_s and body.times_s[-1] >= first_s)
