from dataclasses import replace

import pytest
from fakes import behave, make_parts, make_tasks

from planners.failure import Failure
from suite.backends import agenda as agendas
from suite.backends.agenda import TRIES, Agenda
from suite.backends.job import Job
from suite.trial.task import failed_trial

FAILURE = Failure("planner_error", "in warm-up: it failed")


def labels(agenda: Agenda) -> list[str]:
    return [task.spec.label for task in iter(agenda.next_task, None)]


def test_tasks_wait_for_their_own_planner_only() -> None:
    agenda = Agenda(Job(behave, 60.0, make_parts({"a": "", "b": ""})), make_tasks(["a", "b", "c"], trials=2))
    a, b = agenda.next_part(), agenda.next_part()
    assert a is not None
    assert b is not None
    assert agenda.next_part() is None
    assert labels(agenda) == ["c", "c"]
    agenda.is_warm(b)
    assert labels(agenda) == ["b", "b"]
    agenda.failed(a, FAILURE)
    assert labels(agenda) == []
    results = list(agenda.results())
    assert [(task.spec.label, result.row["message"]) for task, result in results] == [("a", FAILURE.message)] * 2
    assert agenda.n_open == 4


def test_a_part_whose_process_dies_is_begun_again_a_few_times() -> None:
    agenda = Agenda(Job(behave, 60.0, make_parts({"a": ""})), make_tasks(["a"]))
    for _ in range(TRIES):
        part = agenda.next_part()
        assert part is not None
        assert labels(agenda) == []
        agenda.died(part, FAILURE)
    assert agenda.next_part() is None
    assert labels(agenda) == []
    assert agenda.n_open == 0


def test_deaths_in_a_warm_up_do_not_add_up_while_trials_of_its_planner_finish() -> None:
    agenda = Agenda(Job(behave, 60.0, make_parts({"a": ""})), make_tasks(["a"], trials=2 * TRIES))
    part = agenda.next_part()
    assert part is not None
    agenda.is_warm(part)
    for _ in range(2 * TRIES):
        agenda.died(part, FAILURE)
        task = agenda.next_task()
        assert task is not None
        agenda.finish(task, failed_trial(task, Failure("planner_error", "its own"), 0.0))
    assert {result.row["message"] for _, result in agenda.results()} == {"its own"}


def test_tasks_keep_their_order() -> None:
    agenda = Agenda(Job(behave, 60.0, make_parts({"a": ""})), tasks := make_tasks(["a"], trials=5))
    part = agenda.next_part()
    assert agenda.next_task() is None
    assert part is not None
    agenda.is_warm(part)
    first = agenda.next_task()
    assert first is not None
    agenda.put_back(first)
    assert list(iter(agenda.next_task, None)) == tasks


def test_giving_up_takes_waiting_tasks_too() -> None:
    agenda = Agenda(Job(behave, 60.0, make_parts({"a": ""})), make_tasks(["a"], trials=2))
    agenda.next_part()
    assert agenda.next_task() is None
    for _ in range(2):
        agenda.give_up_one(FAILURE)
    assert agenda.n_open == 0
    assert [result.row["message"] for _, result in agenda.results()] == [FAILURE.message] * 2


def test_tasks_are_taken_as_they_are_needed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(agendas, "LOOK_AHEAD", 3)
    taken: list[str] = []

    class Counted(list):
        def __iter__(self):
            for task in super().__iter__():
                taken.append(task.spec.label)
                yield task

    agenda = Agenda(Job(behave, 60.0, make_parts({"a": ""})), Counted(make_tasks(["a", "b"], trials=10)))
    part = agenda.next_part()
    assert labels(agenda) == ["b", "b"]  # three of a wait by now
    assert len(taken) == 5
    assert part is not None
    agenda.is_warm(part)
    assert sorted(labels(agenda)) == ["a"] * 10 + ["b"] * 8
    assert len(taken) == 20


def test_failures_are_stored_before_there_are_more(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(agendas, "LOOK_AHEAD", 3)
    tasks = make_tasks(["a"], trials=10)
    broken = [replace(task, spec=task.spec._replace(failure=FAILURE)) for task in tasks]
    agenda = Agenda(Job(behave, 60.0), broken)
    counts = []
    while agenda.n_open:
        assert agenda.next_task() is None
        counts.append([result.row["message"] for _, result in agenda.results()])
    assert counts == [[FAILURE.message] * 3] * 3 + [[FAILURE.message]]
