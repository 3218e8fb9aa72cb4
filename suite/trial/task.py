"""A trial's task and result: what goes into a worker process and what comes out."""

from __future__ import annotations

import functools
import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from suite.auditor.verdicts import VERDICTS
from suite.trial.columns import Row, complete_row

if TYPE_CHECKING:
    from planners import PlannerSpec
    from scenarios.scenario import Scenario


@dataclass(frozen=True)
class TrialTask:
    """One planner on one scenario."""

    scenario: Scenario
    spec: PlannerSpec
    predictor: str
    limits: bool
    """Whether the planner has to keep to the arm's motion limits."""
    seed: int
    """Seed of the experiment."""
    noise_mm: float = 0.0
    """Standard deviation of the noise on observed positions [mm]."""
    dropout: float = 0.0
    """Probability that an observation is lost."""

    @functools.cached_property  # it goes with the task into the worker
    def key(self) -> tuple[str, str]:
        """Scenario hash and planner label, which name a trial within a run."""
        return self.scenario.content_hash, self.spec.label

    @property
    def trial_seed(self) -> int:
        """Seed of this trial, in [1, 2**31): derived from names, so that order and company do not matter.

        Zero is left out because OMPL's generator ignores it.
        """
        name = f"{self.seed}|{self.scenario.id}|{self.spec.label}"
        digest = hashlib.sha256(name.encode()).digest()
        return 1 + int.from_bytes(digest[:8], "big") % (2**31 - 1)


class TrialResult(NamedTuple):
    """One finished trial."""

    row: Row
    times_s: NDArray[np.float64]
    """Times of the executed states [s], shape (k,)."""
    configurations_rad: NDArray[np.float64]
    """Executed bending vectors [rad], shape (k, dof)."""


def trial_row(task: TrialTask, measured: Mapping[str, Any]) -> Row:
    """The row of ``task``: who ran what, and what was ``measured``; what is missing becomes None."""
    scenario_hash, planner = task.key
    identity = {
        "scenario_id": task.scenario.id,
        "scenario_hash": scenario_hash,
        "family": task.scenario.family,
        "n_obstacles": len(task.scenario.obstacles),
        "planner": planner,
        "settings": task.spec.settings.model_dump_json(),
        "predictor": task.predictor,
        "limits": task.limits,
        "noise_mm": task.noise_mm,
        "dropout": task.dropout,
        "experiment_seed": task.seed,
        "trial_seed": task.trial_seed,
    }
    return complete_row(identity | dict(measured))


def failed_trial(task: TrialTask, outcome: str, message: str, trial_wall_s: float) -> TrialResult:
    """The result of a trial that ended outside the episode: the planner raised, hung or took its process down.

    It counts as a failure under every verdict, and nothing was executed.
    """
    verdicts = {f"success_{verdict}": False for verdict in VERDICTS}
    measured = {"outcome": outcome, "message": message, "trial_wall_s": trial_wall_s, **verdicts}
    return TrialResult(trial_row(task, measured), np.empty(0), np.empty((0, len(task.scenario.start_rad))))
