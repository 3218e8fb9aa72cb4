from fakes import behave, make_parts, make_tasks

from planners.failure import Failure
from suite.backends.agenda import TRIES, Agenda
from suite.backends.job import Job

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
