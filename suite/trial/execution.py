"""What the arm does: it follows a planner's timed path step by step, and every state it passes is kept."""

import math

import numpy as np
import numpy.typing as npt

from scenarios import STEP_S, Scenario

FloatArray = npt.NDArray[np.float64]

SAME_START_RAD = 1e-6
"""A path may start this far from where the arm is: states pass through OMPL as doubles, unchanged."""


class PathError(ValueError):
    """A planner returned something that is not a path from where the arm is."""


def check_path(times_s: FloatArray, configurations_rad: FloatArray, now_s: float, q: FloatArray, dof: int) -> None:
    """Refuse what cannot be executed at all; whether it is safe and within limits is for the audit to say.

    Raises:
        PathError: Wrong shapes, numbers that are not finite, times that do not increase strictly from now, or a first
            state that is not the arm's present one.
    """
    if configurations_rad.shape != (len(times_s), dof):
        raise PathError(f"path: found shape {configurations_rad.shape}, allowed ({len(times_s)}, {dof})")
    if not (np.isfinite(times_s).all() and np.isfinite(configurations_rad).all()):
        raise PathError("path: found a number that is not finite, allowed finite states")
    if times_s[0] != now_s or (np.diff(times_s) <= 0).any():
        raise PathError(f"path: found times from {times_s[0]} that do not increase strictly from now, {now_s}")
    if np.abs(configurations_rad[0] - q).max() > SAME_START_RAD:
        raise PathError("path: found a start that is not the arm's present configuration")


class Execution:
    """The executed trajectory of one trial."""

    def __init__(self, scenario: Scenario) -> None:
        """Begin at the start configuration at t = 0."""
        self._arm, self._goal, self._tolerance_m = scenario.arm, scenario.goal, scenario.goal_tolerance_m
        self._times_s = [0.0]
        self._configurations = [scenario.start]
        self._path: tuple[FloatArray, FloatArray] | None = None
        self.has_arrived = bool(self._arrived(scenario.start[None]).any())

    @property
    def now_s(self) -> float:
        """Time of the last executed state [s]."""
        return self._times_s[-1]

    @property
    def q(self) -> FloatArray:
        """Last executed configuration, shape (dof,), [rad]."""
        return self._configurations[-1]

    @property
    def times_s(self) -> FloatArray:
        """Times of all executed states, shape (k,), [s]."""
        return np.array(self._times_s)

    @property
    def configurations_rad(self) -> FloatArray:
        """All executed configurations, shape (k, dof), [rad]."""
        return np.array(self._configurations)

    @property
    def rest(self) -> tuple[FloatArray, FloatArray] | None:
        """Times and configurations of the path still ahead, the present state first; None at its end."""
        if self._path is None:
            return None
        times, path = self._path
        first = times.searchsorted(self.now_s, "right")
        if first == len(times):
            return None
        return np.concatenate([[self.now_s], times[first:]]), np.concatenate([self.q[None], path[first:]])

    def take(self, times_s: FloatArray, configurations_rad: FloatArray) -> None:
        """Follow this path from now on; an empty one means holding still."""
        self._path = (times_s, configurations_rad) if len(times_s) else None

    def step(self) -> None:
        """Move on to the next whole step along the path, holding still where it has ended; stop on arrival."""
        end_s = (math.floor(self.now_s / STEP_S) + 1.0) * STEP_S
        rest = self.rest
        if rest is None:
            times, path = np.array([end_s]), self.q[None]
        else:
            last = rest[0].searchsorted(end_s, "right")
            times, path = rest[0][1:last], rest[1][1:last]
            if not len(times) or times[-1] < end_s:
                at_end = np.array([np.interp(end_s, rest[0], column) for column in rest[1].T])
                times, path = np.append(times, end_s), np.vstack([path, at_end])
        arrived = np.flatnonzero(self._arrived(path))
        self.has_arrived = len(arrived) > 0
        keep = arrived[0] + 1 if self.has_arrived else len(times)
        self._times_s.extend(times[:keep].tolist())
        self._configurations.extend(path[:keep])

    def held_still_for(self, seconds: float) -> bool:
        """Whether the arm has not moved over the last ``seconds``."""
        recent = self.times_s >= self.now_s - seconds
        return bool(np.ptp(self.configurations_rad[recent], axis=0).max() == 0.0)

    def _arrived(self, configurations: FloatArray) -> npt.NDArray[np.bool_]:
        distances = np.linalg.norm(self._arm.tips(configurations) - self._goal, axis=1)
        return np.asarray(distances <= self._tolerance_m)
