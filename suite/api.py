"""The Python interface: run, load, plan, judge.

Everything works in a notebook, from standard input and in a script without a main guard: trials run in this process
unless ``processes`` asks for workers.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal, TypedDict, Unpack

import numpy as np
import numpy.typing as npt
import pandas as pd
from tabulate import tabulate

from planners import ArmPlanner, Plan, PlannerSpec, Session, parse_planner, plugins
from scenarios import Scenario, load_scenarios
from scenarios.spec import split_specs
from suite.auditor import Audit
from suite.auditor import audit as judge
from suite.auditor.certificate import certified_contacts
from suite.auditor.fcl_engine import sampled_contacts
from suite.backends.job import Limits
from suite.compare.conditions import telling_apart
from suite.compare.gate import Bar, Comparison, compare_runs
from suite.compare.possible import scenarios_frame
from suite.compare.tables import summarize
from suite.errors import SuiteError
from suite.experiment.experiment import make_experiment
from suite.experiment.file import preset_fields
from suite.merger import merge_runs
from suite.runner import run_experiment
from suite.show.text import cells
from suite.store.journal import Executed, Journal
from suite.store.run_folder import (
    JOURNAL,
    house_changes,
    planner_order,
    present_codes,
    read_manifest,
    read_trials,
)
from suite.trial import episode
from suite.trial.observation import Observer
from suite.trial.task import TrialResult, TrialTask

PlannerLike = str | type[ArmPlanner]
"""A planner's spec, such as ``"t3"`` or ``"mine.py:Mine[gain=2]"``, or a class; see ``planners.ArmPlanner``."""


class Run:
    """What a run has left in its folder; read anew at every question, so a run that goes on can be watched."""

    def __init__(self, folder: str | Path) -> None:
        """Read ``folder``.

        Raises:
            SuiteError: There is no run in it, or it cannot be read.
        """
        self.folder = Path(folder)
        self.trials  # noqa: B018  a folder without a run is refused here

    @property
    def trials(self) -> pd.DataFrame:
        """One row per trial; ``suite.trial.columns`` declares the columns with unit and meaning."""
        trials = read_trials(self.folder)
        if trials is None:
            raise SuiteError(f"{self.folder}: found no trials, allowed: the folder of a run")
        return trials

    def table(self) -> pd.DataFrame:
        """The comparison: one row per condition and planner, with 95 % Wilson intervals."""
        return summarize(self.trials, planner_order(self.folder), present_codes(read_manifest(self.folder)))

    def scenarios(self) -> pd.DataFrame:
        """One row per scenario: possible or not, who solved it, why nobody can; see ``suite.compare.possible``."""
        return scenarios_frame(self.trials)

    def compare(self, new: Run, **bar: Any) -> Comparison:
        """Judge another run against this one, as ``suite compare`` does.

        Args:
            new: What is held against this run.
            **bar: Fields of ``suite.compare.gate.Bar``: ``margin``, ``alpha``, ``cost_margin``, ``verdict``,
                ``across``.

        Raises:
            SuiteError: A number is out of range, or a condition unknown.
        """
        found = compare_runs(self.trials, new.trials, Bar(**bar))
        return replace(found, differing=(*found.differing, *house_changes(self.folder, new.folder)))

    def trajectory(self, scenario: str, planner: str, **conditions: Any) -> Executed:
        """What a planner executed in a scenario: times (k,) [s] and configurations (k, dof) [rad].

        Args:
            scenario: Its id.
            planner: Its label, as in the table.
            **conditions: Columns of the trial and their values, such as ``noise_mm=2.0``, where it ran under several.

        Raises:
            SuiteError: There is no such trial, or more than one.
        """
        with Journal(self.folder / JOURNAL, read_only=True) as journal:
            found = [
                executed
                for executed in journal.executed()
                if (executed.scenario_id, executed.planner) == (scenario, planner)
                and all(executed.conditions.get(name) == value for name, value in conditions.items())
            ]
        if len(found) == 1:
            return found[0]
        what = f"{planner!r} on {scenario!r}" + "".join(f", {name}={value!r}" for name, value in conditions.items())
        if not found:
            raise SuiteError(f"{self.folder}: found no trial of {what}")
        names = ", ".join(telling_apart(self.trials))
        raise SuiteError(f"{self.folder}: found {len(found)} trials of {what}, allowed one: say which by {names}")

    def scenario(self, scenario: str) -> Scenario:
        """A scenario of the run by its id.

        Raises:
            SuiteError: There is none of that id.
        """
        file = self.folder / "scenarios.jsonl"
        for candidate in load_scenarios(file):
            if candidate.id == scenario:
                return candidate
        raise SuiteError(f"{file}: found no scenario {scenario!r}")

    def __repr__(self) -> str:
        """Where it is, and how much there is."""
        return f"Run({str(self.folder)!r}, {len(self.trials)} trials)"

    def _repr_html_(self) -> str:
        """What a notebook shows."""
        titles, rows = cells(self.table())
        return tabulate(rows, titles, tablefmt="html", disable_numparse=True)


def run(  # noqa: PLR0913  the command line's options
    planners: str | type[ArmPlanner] | Iterable[PlannerLike] = (),
    *,
    out: str | Path | None = None,
    preset: str | None = None,
    processes: int = 0,
    hang_limit_s: float = 300.0,
    memory_limit_mb: float | None = None,
    fresh: bool = False,
    keep_stale: bool = False,
    **conditions: Any,
) -> Run:
    """Run planners on the same scenarios, or what is left of such a run; as ``suite run`` does.

    Args:
        planners: Specs (``"temporal,rrt"``) and classes; may be empty where a preset names some.
        out: Folder of the run; ``results/NAME`` when None.
        preset: Name of a preset, an experiment file, or the ``manifest.json`` of a run, whose fields are taken unless
            given here.
        processes: Worker processes; 0 runs every trial in this process, where a planner that hangs or crashes
            can't be stopped.
        hang_limit_s: In worker processes a trial that takes longer is killed [s].
        memory_limit_mb: In worker processes a trial that takes so much more than its process had is killed [MB].
        fresh: Start over what the folder holds.
        keep_stale: Use rows that other code has made as they are.
        **conditions: Fields of ``suite.experiment.experiment.Experiment``: ``family``, ``arm``, ``obstacles``,
            ``trials``, ``seed``, ``predictor``, ``margin``, ``limits``, ``noise_mm``, ``dropout``, ``scenario_files``;
            all but ``trials`` and the files may have several values, of which every combination is run.

    Raises:
        SuiteError, SpecError, ScenarioError: Something asked for is not allowed; one line.
        KeyboardInterrupt: Stopped by the user; what had finished is saved, and the same call goes on.
    """
    texts = _texts(planners, processes)
    given = conditions | ({"planners": texts} if texts else {})
    experiment = make_experiment(**(preset_fields(preset) if preset else {}) | given)
    folder = Path(out) if out is not None else Path("results") / experiment.name
    run_experiment(
        experiment,
        folder,
        workers=processes,
        limits=Limits(hang_limit_s, memory_limit_mb),
        fresh=fresh,
        keep_stale=keep_stale,
    )
    return Run(folder)


def load(folder: str | Path) -> Run:
    """The run in ``folder``, finished or not.

    Raises:
        SuiteError: There is none, or it cannot be read.
    """
    return Run(folder)


def merge(runs: Iterable[str | Path], out: str | Path, *, keep_first: bool = False) -> Run:
    """Put several runs together in a folder of their own, as ``suite merge`` does; they themselves are only read.

    Args:
        runs: Their folders.
        out: A new or an empty folder.
        keep_first: Where two have different rows for one trial by the same code, let that of the first stand.

    Raises:
        SuiteError: A run cannot be read, two are in conflict, or ``out`` holds something. Then nothing is written.
    """
    merge_runs([Path(run) for run in runs], Path(out), keep_first=keep_first)
    return Run(out)


class Conditions(TypedDict, total=False):
    """Under which conditions a planner works."""

    predictor: str | None
    """Predictor of obstacle motion; the planner's own when None."""
    margin: float | None
    """Standard deviations by which predicted obstacles are grown; the planner's own when None."""
    limits: bool
    """Whether the planner has to keep to the arm's motion limits."""
    seed: int
    """Seed of the experiment, 0 when left out; the trial's derives from it as in a run."""
    noise_mm: float
    """Standard deviation of the noise on observed positions [mm]."""
    dropout: float
    """Probability that an observation is lost."""


def plan(scenario: Scenario, planner: PlannerLike, **conditions: Unpack[Conditions]) -> Plan:
    """Ask a planner once, at the start of a scenario: obstacles observed up to t = 0, predicted, one solve.

    Args:
        scenario: The scenario.
        planner: The planner; what it raises goes through.
        **conditions: See ``Conditions``.

    Returns:
        Status, timed path (k,) [s] and (k, dof) [rad], solve time and checks.

    Raises:
        SpecError: Unknown planner, setting or predictor.
    """
    task = _task(scenario, planner, conditions)
    session = Session(
        task.spec,
        scenario,
        predictor=task.predictor,
        limits=task.limits,
        seed=task.trial_seed,
        margin=task.margin,
    )
    return session.plan(scenario.start, 0.0, Observer(task).until(0.0))


def run_trial(scenario: Scenario, planner: PlannerLike, **conditions: Unpack[Conditions]) -> TrialResult:
    """Run a planner through a scenario in this process and judge what was executed.

    Args:
        scenario: The scenario.
        planner: The planner; what it raises goes through.
        **conditions: See ``Conditions``.

    Returns:
        The row, and what was executed: times (k,) [s] and configurations (k, dof) [rad].

    Raises:
        SpecError: Unknown planner, setting or predictor.
    """
    return episode.run_trial(_task(scenario, planner, conditions))


def audit(
    scenario: Scenario,
    times_s: npt.ArrayLike,
    configurations_rad: npt.ArrayLike,
    engine: Literal["certificate", "fcl"] = "certificate",
) -> Audit:
    """Judge a motion from anywhere against the true motion of a scenario's obstacles.

    Args:
        scenario: The scenario.
        times_s: Times, shape (k,), [s].
        configurations_rad: Bending vectors (u1, v1, u2, ...), shape (k, dof), [rad]; linear between timed states.
        engine: Conservative advancement, which certifies, or FCL sampled densely.

    Returns:
        The three verdicts, arrival and smallest clearance.
    """
    contacts = certified_contacts if engine == "certificate" else sampled_contacts
    return judge(scenario, np.asarray(times_s, float), np.asarray(configurations_rad, float), contacts)


def _task(scenario: Scenario, planner: PlannerLike, conditions: Conditions) -> TrialTask:
    spec = _spec(planner)
    return TrialTask(
        scenario,
        spec,
        spec.predictor_for(conditions.get("predictor")),
        conditions.get("limits", False),
        conditions.get("seed", 0),
        conditions.get("noise_mm", 0.0),
        conditions.get("dropout", 0.0),
        conditions.get("margin"),
    )


def _spec(planner: PlannerLike) -> PlannerSpec:
    return parse_planner(planner if isinstance(planner, str) else plugins.offer(planner))


def _texts(planners: str | type[ArmPlanner] | Iterable[PlannerLike], processes: int) -> tuple[str, ...]:
    """Specs of planners given as specs and classes.

    Raises:
        SuiteError: A class is to run in other processes, which do not know it.
    """
    asked: Sequence[PlannerLike]
    if isinstance(planners, str):
        asked = split_specs(planners)
    else:
        asked = [planners] if isinstance(planners, type) else list(planners)
    classes = [planner for planner in asked if not isinstance(planner, str)]
    if classes and processes:
        name = classes[0].__name__
        raise SuiteError(f"planners: found the class {name}, allowed FILE.py:{name} when processes are asked for")
    return tuple(planner if isinstance(planner, str) else plugins.offer(planner) for planner in asked)
