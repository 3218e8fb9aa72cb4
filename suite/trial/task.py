"""A trial's task and result: what goes into a worker process and what comes out."""

from __future__ import annotations

import functools
import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from scenarios.families import FAMILIES
from suite.auditor.verdicts import VERDICTS
from suite.trial.columns import MEASURED, Row, checked_measurements, complete_row, trial_key

if TYPE_CHECKING:
    from planners import Failure, PlannerSpec
    from scenarios import ContinuumArm, Scenario


UNKNOWN = "unknown"
"""In place of a hash, where nobody has said what code it is."""


class Code(NamedTuple):
    """What made a row: equal tasks run by equal code give equal rows."""

    house: str = UNKNOWN
    """Hash of the suite's sources and of the libraries that can change a row."""
    planner: str = UNKNOWN
    """Hash of the planner's own code; that of the house for its own planners."""


NOBODYS = Code()


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
    margin: float | None = None
    """Standard deviations by which predicted obstacles are to be grown; the planner's own when None."""
    code: Code = NOBODYS
    """What is about to run it."""

    @functools.cached_property  # it goes with the task into the worker
    def identity(self) -> Row:
        """The columns of its row that say who runs what, and under which conditions."""
        scenario = self.scenario
        return {
            "scenario_id": scenario.id,
            "scenario_hash": scenario.content_hash,
            "family": scenario.family,
            "family_parameters": _parameters_text(scenario),
            "n_obstacles": len(scenario.obstacles),
            "arm": _arm_text(scenario.arm),
            "planner": self.spec.label,
            "settings": self.spec.settings.model_dump_json(),
            "predictor": self.predictor,
            "prediction_margin": self.spec.margin_for(self.margin),
            "limits": self.limits,
            "noise_mm": self.noise_mm,
            "dropout": self.dropout,
            "experiment_seed": self.seed,
            "trial_seed": self.trial_seed,
            "house_code": self.code.house,
            "planner_code": self.code.planner,
            "is_bound": self.spec.is_bound,
        }

    @functools.cached_property
    def key(self) -> str:
        """What names this trial in every run, whatever code runs it."""
        return trial_key(self.identity)

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
    traceback: str = ""
    """Where the planner raised, when it did."""


def trial_row(task: TrialTask, measured: Mapping[str, Any]) -> Row:
    """The row of ``task``: who ran what, and what was ``measured``; what is missing becomes None."""
    return complete_row(task.identity | dict(measured))


def failed_trial(task: TrialTask, failure: Failure, trial_wall_s: float) -> TrialResult:
    """The result of a trial that ended outside the episode: the planner raised, hung or took its process down.

    It counts as a failure under every verdict, and nothing was executed.
    """
    verdicts = {f"success_{verdict}": False for verdict in VERDICTS}
    measured = {"outcome": failure.outcome, "message": failure.message, "trial_wall_s": trial_wall_s, **verdicts}
    nothing = np.empty(0), np.empty((0, len(task.scenario.start_rad)))
    return TrialResult(trial_row(task, measured), *nothing, failure.traceback)


class RowError(ValueError):
    """A result that cannot be stored; the message says why."""


def checked_result(task: TrialTask, result: TrialResult) -> TrialResult:
    """The result with ``task``'s own identity, if what was measured and executed is what its columns hold.

    A planner shares the process in which both were made.

    Raises:
        RowError: It is not.
    """
    measured = {column.name: result.row.get(column.name) for column in MEASURED}
    try:
        row = complete_row(task.identity | checked_measurements(measured))
        times, configurations = (np.asarray(a, np.float64) for a in (result.times_s, result.configurations_rad))
    except (ValueError, TypeError) as error:
        raise RowError(str(error)) from None
    allowed = (len(times), len(task.scenario.start_rad))
    if times.ndim != 1 or (configurations.shape != allowed and len(times)):
        raise RowError(f"executed: found shape {configurations.shape}, allowed {allowed}")
    if not (np.isfinite(times).all() and np.isfinite(configurations).all()):
        raise RowError("executed: found a number that is not finite, allowed finite states")
    return TrialResult(row, times, configurations.reshape(allowed), result.traceback)


def _arm_text(arm: ContinuumArm) -> str:
    """What ``--arm`` takes to make this arm, or ``default``."""
    default = type(arm)()
    values = {name: getattr(arm, name) for name in type(arm).model_fields}
    return _spec_text({name: value for name, value in values.items() if value != getattr(default, name)}) or "default"


def _parameters_text(scenario: Scenario) -> str | None:
    """What stands in the brackets of ``--family``, or ``default``; everything there is of a family from elsewhere.

    The number of obstacles has a column of its own.
    """
    values = {name: value for name, value in scenario.parameters.items() if name != "n_obstacles"}
    if scenario.family not in FAMILIES:
        return _spec_text(values) or None
    fields = FAMILIES[scenario.family].model_fields
    changed = {name: value for name, value in values.items() if name not in fields or value != fields[name].default}
    return _spec_text(changed) or "default"


def _spec_text(values: Mapping[str, object]) -> str:
    return ",".join(f"{name}={value!r}" for name, value in values.items())
