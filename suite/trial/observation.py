"""What the planners' sensors report: true positions once per step, optionally noisy and with losses."""

import hashlib
from typing import Protocol

import numpy as np
import numpy.typing as npt

from planners import Observation
from scenarios import STEP_S, Scenario

FloatArray = npt.NDArray[np.float64]


class Sensing(Protocol):
    """What decides on observations; every ``TrialTask`` does."""

    @property
    def scenario(self) -> Scenario:
        """The scenario that is observed."""

    @property
    def seed(self) -> int:
        """Seed of the experiment."""

    @property
    def noise_mm(self) -> float:
        """Standard deviation of the noise on observed positions [mm]."""

    @property
    def dropout(self) -> float:
        """Probability that an observation is lost."""


class Observer:
    """Observes a scenario's obstacles from ``observation_s`` before t = 0 onwards.

    Noise and losses derive from the experiment's seed and the scenario, never from the planner: every planner of an
    experiment is told the same.
    """

    def __init__(self, task: Sensing) -> None:
        """Draw what will be observed in the whole trial."""
        scenario = task.scenario
        first, last = -round(scenario.observation_s / STEP_S), int(np.ceil(scenario.time_limit_s / STEP_S))
        self._times_s = STEP_S * np.arange(first, last + 1, dtype=np.float64)
        self._radii_m = np.array([obstacle.radius_m for obstacle in scenario.obstacles])
        self._positions_m = _positions(scenario, self._times_s)
        digest = hashlib.sha256(f"{task.seed}|{scenario.id}|observation".encode()).digest()
        rng = np.random.default_rng(int.from_bytes(digest[:8], "big"))
        self._positions_m += rng.normal(scale=task.noise_mm / 1000.0, size=self._positions_m.shape)
        lost = rng.uniform(size=self._positions_m.shape[:2]) < task.dropout
        for j, obstacle in enumerate(scenario.obstacles):
            lost[:, j] |= obstacle.unseen(self._times_s)
        lost[0] = False  # every obstacle is seen once, so that there is something to go by
        self._positions_m[lost] = np.nan

    def until(self, now_s: float) -> Observation:
        """Everything observed up to and including ``now_s``; NaN where an observation was lost."""
        seen = self._times_s.searchsorted(now_s, "right")
        return Observation(self._times_s[:seen], self._positions_m[:seen], self._radii_m)


def _positions(scenario: Scenario, times_s: FloatArray) -> FloatArray:
    """True centres (T, m, 3) [m]."""
    positions = np.empty((len(times_s), len(scenario.obstacles), 3))
    for j, obstacle in enumerate(scenario.obstacles):
        positions[:, j] = obstacle.position(times_s)
    return positions
