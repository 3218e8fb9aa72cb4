"""Whole runs with ``behave`` in place of the episode."""

import os
import signal
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from unittest.mock import patch

import pandas as pd
from fakes import behave, behave_slowly, prepare_nothing

import suite.runner
from planners import PlannerSpec, describe
from suite.backends.cluster.head import DaskCluster
from suite.experiment.experiment import make_experiment
from suite.store.journal import Journal
from suite.trial.columns import TIMING_NAMES
from suite.trial.task import TrialResult, TrialTask

SOURCES = "0" * 16
"""The sources may be edited while tests run; runs of fakes are all made by these."""


def run_with_fakes(
    folder: Path,
    *,
    die_after: int | None = None,
    fresh: bool = False,
    keep_stale: bool = False,
    where: int | str = 0,
    sources: str = SOURCES,
    codes: Mapping[str, str] | None = None,
    **changes: object,
) -> list[str]:
    """Sixteen trials unless ``changes`` of the experiment say otherwise.

    They run ``where`` there are so many processes, 0 being this one, or at a scheduler's address, in some time.
    Takes its own process down after ``die_after`` trials. ``codes`` are hashes of planners' own code, by label.
    Returns the labels of the trials that were run, sorted.
    """
    fields = {"planners": ("pf", "rrt"), "obstacles": (0, 1), "trials": 4, "seed": 5} | changes
    experiment = make_experiment(**fields)
    ran: list[str] = []

    def add(journal: Journal, task: TrialTask, result: TrialResult) -> None:
        really_add(journal, task, result)
        ran.append(task.spec.label)
        if len(ran) == die_after:
            os.kill(os.getpid(), signal.SIGKILL)

    def described(text: str) -> PlannerSpec:
        spec = describe(text)
        return spec._replace(code=(codes or {}).get(spec.label, ""))

    really_add = Journal.add
    with (
        patch("suite.experiment.code.source_hash", return_value=sources),
        patch("suite.experiment.experiment.describe", described),
        patch.object(suite.runner, "run_trial", behave_slowly if isinstance(where, str) else behave),
        patch.object(suite.runner, "warm_up_parts", prepare_nothing),
        patch.object(Journal, "add", add),
    ):
        workers = DaskCluster(where, 0, prepare_nothing) if isinstance(where, str) else where
        suite.runner.run_experiment(experiment, folder, workers=workers, fresh=fresh, keep_stale=keep_stale)
    return sorted(ran)


def killed_run(folder: Path, **arguments: object) -> None:
    """``run_with_fakes`` in a process that kills itself."""
    call = f"from fake_runs import *; run_with_fakes(Path({str(folder)!r}), **{arguments!r})"
    tests = Path(__file__).parent  # its folders are named after the packages: those come first
    path = os.environ | {"PYTHONPATH": f"{tests.parent}{os.pathsep}{tests}"}
    killed = subprocess.run([sys.executable, "-c", call], env=path, check=False, stderr=subprocess.DEVNULL)
    assert killed.returncode == -signal.SIGKILL


def contents(folder: Path) -> dict[str, object]:
    """Everything in a run's files that may not differ between two runs of one experiment."""
    trials = pd.read_csv(folder / "trials.csv", dtype=str).drop(columns=list(TIMING_NAMES))
    table = pd.read_csv(folder / "table.csv", dtype=str)
    return {
        "trials": trials.to_csv(),
        "table": table[[name for name in table if "planning" not in name and "solve" not in name]].to_csv(),
        "scenarios": (folder / "scenarios.jsonl").read_bytes(),
        "trajectories": (folder / "trajectories.csv").read_bytes(),
    }


def snapshot(folder: Path) -> dict[str, tuple[bytes, int]]:
    """Every file's bytes and time of change."""
    return {file.name: (file.read_bytes(), file.stat().st_mtime_ns) for file in folder.iterdir()}
