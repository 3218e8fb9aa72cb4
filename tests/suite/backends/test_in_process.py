import os

import pytest
from fakes import behave, make_parts, make_tasks, place_of
from test_processes import outcomes_of, rows_of, without_timings

from suite.backends.job import Job, Part
from suite.backends.local import InProcess
from suite.trial.task import TrialResult, TrialTask

THREE = place_of(r'ValueError("three\nlines")')


def test_rows_are_those_of_worker_processes() -> None:
    hows = {"raises": "raise", "leaves": "leave", "fine": "", "raise": "", "leave": ""}
    tasks, parts = make_tasks(list(hows), trials=3), make_parts(hows)
    here = {task.key: result.row for task, result in InProcess().run(Job(behave, 60.0, parts), tasks)}
    assert without_timings(here) == without_timings(rows_of(list(hows), trials=3, parts=parts))
    found = outcomes_of(here)
    assert found["raises"] == (
        "planner_error",
        f"in warm-up: ValueError: three lines{THREE}",
    )
    assert found["leaves"] == ("planner_error", "in warm-up: SystemExit: 3" + place_of("SystemExit(3)"))
    assert found["raise"] == ("planner_error", "ValueError: two lines" + place_of(r'ValueError("two\nlines")'))
    assert found["leave"] == ("planner_error", "SystemExit: 5" + place_of("SystemExit(5)"))


def test_a_planner_is_warmed_up_once_and_right_before_its_first_trial() -> None:
    done: list[str] = []

    def run(task: TrialTask) -> TrialResult:
        assert os.getpid() == ours
        done.append(f"trial of {task.spec.label}")
        return behave(task)

    ours, names = os.getpid(), ["audit", "a", "b"]
    parts = [Part(name, lambda name=name: done.append(name), 1.0, None if name == "audit" else name) for name in names]
    list(InProcess().run(Job(run, 60.0, parts), make_tasks(["a", "b"], trials=2)))
    assert done == ["audit", "a", "trial of a", "b", "trial of b", "trial of a", "trial of b"]


def test_ctrl_c_is_not_a_planners_failure() -> None:
    def interrupted(task: TrialTask) -> TrialResult:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        list(InProcess().run(Job(interrupted, 60.0), make_tasks(["a"])))
