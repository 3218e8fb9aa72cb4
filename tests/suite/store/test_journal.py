import sqlite3
from pathlib import Path

import numpy as np
import pytest
from fake_runs import contents, killed_run, run_with_fakes
from fakes import behave, fake_spec, make_scenario, make_tasks

from planners import Failure
from suite.errors import SuiteError
from suite.store.journal import Journal
from suite.trial.columns import Row
from suite.trial.task import Code, TrialTask, failed_trial

HOUSE = {"sources": "abc", "versions": {"ompl": "2.0.1"}}


def rows_of(folder: Path) -> dict[int, Row]:
    with Journal(folder / "run.db", read_only=True) as journal:
        return {row["trial_seed"]: row for row in journal.rows()}


def ask(journal: Journal, tasks: list[TrialTask]) -> None:
    journal.ask({task.key: task.code for task in tasks}, HOUSE)


def test_what_is_added_comes_back(tmp_path) -> None:
    tasks = make_tasks(["a", "b"], trials=3)
    results = {task.key: behave(task) for task in tasks}
    with Journal(tmp_path / "run.db") as journal:
        ask(journal, tasks)
        for task in reversed(tasks):
            journal.add(task, results[task.key])
    for read_only in (False, True):
        with Journal(tmp_path / "run.db", read_only=read_only) as journal:
            assert journal.finished() == set(results)
            assert journal.made() == {task.key: [task.code] for task in tasks}
            assert journal.houses().popitem()[1] == HOUSE
            found = {(row["scenario_id"], row["planner"]): row for row in journal.rows()}
            assert found == {(task.scenario.id, task.spec.label): results[task.key].row for task in tasks}
            executed = list(journal.executed())
    assert [(trial.scenario_id, trial.planner) for trial in executed] == sorted(
        (task.scenario.id, task.spec.label) for task in tasks
    )
    first = results[tasks[0].key]
    np.testing.assert_array_equal(executed[0].times_s, first.times_s)
    np.testing.assert_array_equal(executed[0].configurations_rad, first.configurations_rad)


def test_only_what_is_asked_for_is_shown(tmp_path) -> None:
    tasks = make_tasks(["a", "b"], trials=2)
    with Journal(tmp_path / "run.db") as journal:
        ask(journal, tasks)
        for task in tasks:
            journal.add(task, behave(task))
        ask(journal, tasks[:1])
        assert journal.finished() == {tasks[0].key}
        assert [row["planner"] for row in journal.rows()] == ["a"]
        assert len(list(journal.executed())) == 1
        assert len(journal.made()) == 4
        ask(journal, tasks[::-1])
        assert journal.finished() == {task.key for task in tasks}


def test_a_trial_that_executed_nothing_has_an_empty_trajectory(tmp_path) -> None:
    (task,) = make_tasks(["a"])
    with Journal(tmp_path / "run.db") as journal:
        ask(journal, [task])
        journal.add(task, failed_trial(task, Failure("planner_hung", "killed"), 1.0))
        (executed,) = journal.executed()
    assert executed.configurations_rad.shape == (0, 6)


def with_code(task: TrialTask, code: Code) -> TrialTask:
    return TrialTask(task.scenario, task.spec, task.predictor, task.limits, task.seed, code=code)


def test_a_trial_cannot_be_stored_twice_but_by_other_code(tmp_path) -> None:
    (task,) = make_tasks(["a"])
    edited = with_code(task, Code("house", "edited"))
    assert edited.key == task.key
    with Journal(tmp_path / "run.db") as journal:
        journal.add(task, behave(task))
        with pytest.raises(sqlite3.IntegrityError):
            journal.add(task, behave(task))
        journal.add(edited, behave(edited))
        assert journal.made() == {task.key: [task.code, edited.code]}
        ask(journal, [edited])
        assert [row["planner_code"] for row in journal.rows()] == ["edited"]
        ask(journal, [task])
        assert [row["planner_code"] for row in journal.rows()] == [task.code.planner]


def test_a_row_of_another_trial_is_not_taken(tmp_path) -> None:
    one, other = make_tasks(["a"], trials=2)
    with Journal(tmp_path / "run.db") as journal, pytest.raises(AssertionError):
        journal.add(one, behave(other))


def test_every_condition_makes_another_trial() -> None:
    base = {"scenario": make_scenario(1), "spec": fake_spec("a"), "predictor": "cubic", "limits": False, "seed": 0}
    changes = [
        {},
        {"scenario": make_scenario(2)},
        {"scenario": make_scenario(1).model_copy(update={"id": "renamed"})},  # its seed hangs on its name
        {"spec": fake_spec("b")},
        {"spec": fake_spec("a", settings=fake_spec("a").settings.model_copy(update={"gain": 0.6}))},
        {"predictor": "arc"},
        {"limits": True},
        {"seed": 1},
        {"noise_mm": 1.0},
        {"dropout": 0.1},
    ]
    assert len({TrialTask(**(base | change)).key for change in changes}) == len(changes)
    assert TrialTask(**base, code=Code("x", "y")).key == TrialTask(**base).key


def test_the_whole_traceback_is_kept(tmp_path) -> None:
    (task,) = make_tasks(["a"])
    with Journal(tmp_path / "run.db") as journal:
        journal.add(task, failed_trial(task, Failure("planner_error", "ValueError", "Traceback: all of it"), 1.0))
    with sqlite3.connect(tmp_path / "run.db") as db:
        assert db.execute("SELECT traceback FROM trials").fetchall() == [("Traceback: all of it",)]
    db.close()


@pytest.mark.parametrize(
    ("statement", "line"),
    [
        ("UPDATE trials SET min_clearance_m = 'wide'", "run.db: found a row with a value that fits no trial"),
        ("UPDATE trials SET executed = x'00ff'", "run.db: fake-0000 a: found no trajectory in it"),
        ("UPDATE trials SET executed = 7", "run.db: fake-0000 a: found no trajectory in it"),
    ],
)
def test_values_that_fit_no_trial_are_one_line(tmp_path, statement: str, line: str) -> None:
    (task,) = make_tasks(["a"])
    with Journal(tmp_path / "run.db") as journal:
        ask(journal, [task])
        journal.add(task, behave(task))
    with sqlite3.connect(tmp_path / "run.db") as db:
        db.execute(statement)
    db.close()
    with Journal(tmp_path / "run.db", read_only=True) as journal, pytest.raises(SuiteError, match=line):
        list(journal.rows()), list(journal.executed())


def test_a_killed_run_goes_on_and_ends_like_an_unbroken_one(tmp_path) -> None:
    killed_run(tmp_path / "broken", die_after=5, where=2)
    assert not (tmp_path / "broken" / "trials.csv").exists()
    before = rows_of(tmp_path / "broken")
    assert len(before) == 5

    assert len(run_with_fakes(tmp_path / "broken", where=2)) == 11
    run_with_fakes(tmp_path / "unbroken")
    assert contents(tmp_path / "broken") == contents(tmp_path / "unbroken")
    after = rows_of(tmp_path / "broken")
    assert len(after) == 16
    assert before.items() <= after.items()  # finished trials were not run again: even their timings stand


def test_a_finished_run_runs_nothing_and_writes_the_same_bytes(tmp_path) -> None:
    run_with_fakes(tmp_path)
    first = {file.name: file.read_bytes() for file in tmp_path.iterdir()}
    assert run_with_fakes(tmp_path) == []
    second = {file.name: file.read_bytes() for file in tmp_path.iterdir()}
    assert first.keys() == second.keys()
    assert {name for name in first if first[name] != second[name]} <= {"run.db"}
