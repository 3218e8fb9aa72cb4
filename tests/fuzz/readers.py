"""Everything that reads a file of a user's, with whole files to begin from."""

import json
import sqlite3
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
from fake_runs import run_with_fakes
from fakes import behave, make_tasks

from planners import label_of
from scenarios import generate, load_scenarios, save_scenarios
from suite.auditor.trajectory_file import read_trajectories
from suite.backends.answer import GarbledError, packed, unpacked
from suite.compare.published import published_file, read_published
from suite.compare.tables import summarize
from suite.errors import SuiteError
from suite.experiment.experiment import make_experiment
from suite.experiment.file import preset_fields
from suite.show.text import render
from suite.store.frames import read_table_csv, read_trials_csv, refuse_gaps
from suite.store.journal import Journal
from suite.store.run_folder import planner_order, present_codes, read_manifest


class Reader(NamedTuple):
    """What reads a file of this name, and whole files."""

    file: str
    read: Callable[[Path], object]
    seeds: list[bytes]
    share: int
    """Of the inputs, in parts."""


def readers(folder: Path) -> dict[str, Reader]:
    """All readers; the seeds are files of a run made in ``folder``."""
    run_with_fakes(folder / "run", planners=("pf", "rrt"), obstacles=(1,), trials=2)
    scenarios = generate("orbit", 1, 2, 0)
    for suffix in ("yaml", "json", "jsonl"):
        save_scenarios(folder / f"few.{suffix}", scenarios)
    known = load_scenarios(folder / "run" / "scenarios.jsonl")

    def seeds(*names: str) -> list[bytes]:
        return [(folder / name).read_bytes() for name in names]

    def trajectories(file: Path) -> object:
        return read_trajectories(file, known)

    result = behave(make_tasks(["fine"])[0])
    experiment = json.dumps({"planners": "pf,rrt[range=0.3]", "sweep": {"noise_mm": "0,5"}, "trials": 3}).encode()
    written = [published_file("published").read_bytes()]
    few_states = [b"\n".join(seeds("run/trajectories.csv")[0].split(b"\n")[:9])]
    specs = [b"temporal[horizon=3]", b"rrt[range=0.5,name=a]", b"ompl.KPIECE1[range=0.5]", b"pf"]
    return {
        "scenarios, YAML": Reader("in.yaml", load_scenarios, seeds("few.yaml"), 8),
        "scenarios, JSON": Reader("in.json", load_scenarios, seeds("few.json"), 16),
        "scenarios, JSON lines": Reader("in.jsonl", load_scenarios, seeds("few.jsonl"), 16),
        "experiments": Reader("in.json", _experiment, [*seeds("run/manifest.json"), experiment], 16),
        "manifests": Reader("manifest.json", _manifest, seeds("run/manifest.json"), 16),
        "trials": Reader("trials.csv", _trials, seeds("run/trials.csv"), 3),
        "tables": Reader("table.csv", _table, seeds("run/table.csv"), 4),
        "published": Reader("in.csv", read_published, written, 8),
        "trajectories": Reader("in.csv", trajectories, few_states, 16),
        "journals": Reader("run.db", _journal, seeds("run/run.db"), 6),
        "answers": Reader("in.bin", _answer, [packed(1, result), packed(1, None)], 40),
        "specs": Reader("in.txt", _spec, specs, 20),
    }  # fmt: skip


def _experiment(file: Path) -> None:
    make_experiment(**preset_fields(str(file)))


def _manifest(file: Path) -> None:
    present_codes(read_manifest(file.parent))
    planner_order(file.parent)


def _trials(file: Path) -> None:
    summary = summarize(refuse_gaps(read_trials_csv(file), file))
    render(summary, "markdown")


def _table(file: Path) -> None:
    render(read_table_csv(file), "markdown")


def _journal(file: Path) -> None:
    try:
        with Journal(file, read_only=True) as journal:
            journal.houses()
            list(journal.rows())
            for executed in journal.executed():
                np.isfinite(executed.times_s)
    except sqlite3.Error as error:  # what every verb makes a line of
        raise SuiteError(str(error)) from None


def _answer(file: Path) -> None:
    try:
        unpacked(1, file.read_bytes())
    except GarbledError as error:
        raise SuiteError(str(error)) from None


def _spec(file: Path) -> None:
    label_of(file.read_bytes().decode("utf-8", "surrogateescape"))
