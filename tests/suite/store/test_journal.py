import json
import os
import signal
import sqlite3
import subprocess
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from fake_runs import run_with_fakes
from fakes import behave, make_tasks

from suite.errors import SuiteError
from suite.store.journal import Journal
from suite.store.run_folder import open_run
from suite.trial.columns import TIMING_NAMES
from suite.trial.task import failed_trial

MANIFEST = {
    "experiment": {"planners": ["pf"], "trials": 3},
    "versions": {"ompl": "2.0.1"},
    "scenarios": {"count": 3, "hash": "a"},
    "sources": "abc",
    "machine": {"cores": 2},
}


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


def test_what_is_added_comes_back(tmp_path) -> None:
    tasks = make_tasks(["a", "b"], trials=3)
    results = {task.key: behave(task) for task in tasks}
    with Journal(tmp_path / "run.db") as journal:
        for task in reversed(tasks):
            journal.add(task, results[task.key])
    with Journal(tmp_path / "run.db") as journal:
        assert journal.finished() == set(results)
        assert {(row["scenario_hash"], row["planner"]): row for row in journal.rows()} == {
            key: result.row for key, result in results.items()
        }
        executed = list(journal.executed())
    assert [(trial.scenario_id, trial.planner) for trial in executed] == sorted(
        (task.scenario.id, task.spec.label) for task in tasks
    )
    first = results[tasks[0].key]
    np.testing.assert_array_equal(executed[0].times_s, first.times_s)
    np.testing.assert_array_equal(executed[0].configurations_rad, first.configurations_rad)


def test_a_trial_that_executed_nothing_has_an_empty_trajectory(tmp_path) -> None:
    (task,) = make_tasks(["a"])
    with Journal(tmp_path / "run.db") as journal:
        journal.add(task, failed_trial(task, "planner_hung", "killed", 1.0))
        (executed,) = journal.executed()
    assert executed.configurations_rad.shape == (0, 6)


def test_a_trial_cannot_be_stored_twice(tmp_path) -> None:
    (task,) = make_tasks(["a"])
    with Journal(tmp_path / "run.db") as journal:
        journal.add(task, behave(task))
        with pytest.raises(sqlite3.IntegrityError):
            journal.add(task, behave(task))


def test_a_killed_run_goes_on_and_ends_like_an_unbroken_one(tmp_path) -> None:
    call = f"from fake_runs import *; run_with_fakes(Path({str(tmp_path / 'broken')!r}), die_after=5)"
    tests = Path(__file__).parents[2]  # its folders are named after the packages: those come first
    path = os.environ | {"PYTHONPATH": f"{tests.parent}{os.pathsep}{tests}"}
    killed = subprocess.run([sys.executable, "-c", call], env=path, check=False)
    assert killed.returncode == -signal.SIGKILL
    assert not (tmp_path / "broken" / "trials.csv").exists()
    with Journal(tmp_path / "broken" / "run.db") as journal:
        before = {(row["scenario_hash"], row["planner"]): row for row in journal.rows()}
    assert len(before) == 5

    run_with_fakes(tmp_path / "broken")
    run_with_fakes(tmp_path / "unbroken")
    assert contents(tmp_path / "broken") == contents(tmp_path / "unbroken")
    with Journal(tmp_path / "broken" / "run.db") as journal:
        after = {(row["scenario_hash"], row["planner"]): row for row in journal.rows()}
    assert len(after) == 16
    assert before.items() <= after.items()  # finished trials were not run again: even their timings stand


def test_a_finished_run_runs_nothing_and_writes_the_same_bytes(tmp_path) -> None:
    run_with_fakes(tmp_path)
    first = {file.name: file.read_bytes() for file in tmp_path.iterdir()}
    run_with_fakes(tmp_path)
    second = {file.name: file.read_bytes() for file in tmp_path.iterdir()}
    assert first.keys() == second.keys()
    assert {name for name in first if first[name] != second[name]} <= {"run.db"}


def test_fresh_starts_over(tmp_path) -> None:
    run_with_fakes(tmp_path)
    with Journal(tmp_path / "run.db") as journal:
        before = {row["trial_seed"]: row["planning_time_s"] for row in journal.rows()}
    run_with_fakes(tmp_path, fresh=True)
    with Journal(tmp_path / "run.db") as journal:
        after = {row["trial_seed"]: row["planning_time_s"] for row in journal.rows()}
    assert before.keys() == after.keys()
    assert before != after


@pytest.mark.parametrize(
    ("part", "other", "line"),
    [
        ("experiment", {"planners": ["pf"], "trials": 4}, "trials: 3 there, 4 here"),
        ("versions", {"ompl": "2.1"}, 'ompl: "2.0.1" there, "2.1" here'),
        ("scenarios", {"count": 3, "hash": "b"}, "other scenarios"),
        ("sources", "def", "the sources have changed since"),
    ],
)
def test_another_run_is_refused_untouched(tmp_path, part: str, other: object, line: str) -> None:
    with open_run(tmp_path, MANIFEST, fresh=False):
        pass
    before = (tmp_path / "manifest.json").read_bytes()
    with pytest.raises(SuiteError) as caught, open_run(tmp_path, MANIFEST | {part: other}, fresh=False):
        pass
    assert str(caught.value) == (
        f"{tmp_path}: holds another run ({line}); start it over with --fresh, or choose another folder with --out"
    )
    assert (tmp_path / "manifest.json").read_bytes() == before
    with open_run(tmp_path, MANIFEST | {part: other}, fresh=True):
        pass
    assert json.loads((tmp_path / "manifest.json").read_text())[part] == other


def test_a_run_may_go_on_on_another_machine(tmp_path) -> None:
    with open_run(tmp_path, MANIFEST, fresh=False):
        pass
    with open_run(tmp_path, MANIFEST | {"machine": {"cores": 64}}, fresh=False):
        pass


@pytest.mark.parametrize("fresh", [False, True])
def test_a_folder_of_other_things_is_left_alone(tmp_path, fresh: bool) -> None:
    (tmp_path / "thesis.tex").write_text("years of work")
    with (
        pytest.raises(SuiteError, match=r"found thesis\.tex and no manifest\.json"),
        open_run(tmp_path, MANIFEST, fresh=fresh),
    ):
        pass
    assert [file.name for file in tmp_path.iterdir()] == ["thesis.tex"]


def test_fresh_deletes_only_files_of_the_run(tmp_path) -> None:
    with open_run(tmp_path, MANIFEST, fresh=False):
        pass
    (tmp_path / "notes.txt").write_text("mine")
    with open_run(tmp_path, MANIFEST, fresh=True):
        pass
    assert (tmp_path / "notes.txt").read_text() == "mine"


def test_one_process_at_a_time(tmp_path) -> None:
    with (
        open_run(tmp_path, MANIFEST, fresh=False),
        pytest.raises(SuiteError, match="another process is running in it"),
        open_run(tmp_path, MANIFEST, fresh=True),
    ):
        pass


def test_a_broken_manifest_is_one_line(tmp_path) -> None:
    (tmp_path / "manifest.json").write_text('{"experiment": ')
    with (
        pytest.raises(SuiteError, match=r"manifest\.json: cannot be read: "),
        open_run(tmp_path, MANIFEST, fresh=False),
    ):
        pass
