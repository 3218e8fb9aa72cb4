"""What planners may do to the process they run in, and what comes out of it."""

import contextlib
import time
from pathlib import Path

import numpy as np
import pytest
from fakes import behave, make_tasks
from hypothesis import given
from hypothesis import strategies as st

from planners.failure import Failure
from suite.backends.answer import GarbledError, frame_length, packed, unpacked
from suite.backends.job import Job
from suite.backends.local import InProcess
from suite.backends.processes import Processes
from suite.backends.worker import Unreadable
from suite.trial.task import TrialResult

ONE = "the process died: it closed its channel"
MISCHIEF = {
    "garbage": ("planner_error", "its process answered with something else: found an answer of"),
    "half": ("planner_hung", "killed after 3 s"),
    "forge": ("planner_error", "its process answered with something else"),
    "close": ("planner_error", ONE),
    "memory": ("planner_memory", "killed for taking more than 300 MB"),
    "ask too much": ("planner_memory", "Unable to allocate"),
    "surrogate": ("planner_error", r"message: found 'bad \udc80 name', allowed at most 1000 characters"),
    "nul": ("planner_error", "message: found "),
    "long": ("planner_error", "message: found "),
    "count": ("planner_error", "state_checks: found 1180591620717411303424, allowed a whole number"),
    "negative": ("planner_error", "motion_checks: found -5, allowed a whole number"),
    "outcome": ("planner_error", "outcome: found 'won', allowed reached, "),
}


def test_mischief_costs_its_own_trial_alone(capfd: pytest.CaptureFixture[str]) -> None:
    tasks = make_tasks([*MISCHIEF, "another", "print", "child", "fine"])
    fine = InProcess().run(Job(behave, 60.0), [tasks[-1]])
    alone = next(fine)[1].row
    job = Job(behave, 3.0, memory_limit_mb=300.0)
    found = {task.spec.label: result for task, result in Processes(2).run(job, tasks)}
    for label, (outcome, message) in MISCHIEF.items():
        assert found[label].row["outcome"] == outcome, label
        assert message in found[label].row["message"], label
    assert found["another"].row["scenario_id"] == "fake-0000"
    assert found["print"].traceback.removeprefix("\n--- printed in the trial ---\n").startswith(r"said \xff said")
    assert len(found["print"].traceback) < 20_000
    assert found["fine"].row | {"planning_time_s": 0} == alone | {"planning_time_s": 0}
    assert capfd.readouterr() == ("", "")
    assert not sleepers()


def sleepers() -> list[str]:
    """Processes that the planner ``child`` has left."""
    lines = [file.read_bytes() for file in Path("/proc").glob("[0-9]*/cmdline") if file.exists()]
    return [line.decode() for line in lines if line == b"sleep\x00777\x00"]


@pytest.mark.parametrize("workers", [1, 2])
def test_who_spoils_a_process_spoils_it_for_nobody_else(workers: int) -> None:
    tasks = make_tasks(["spoil", "fine", "another"], trials=4, outside={"spoil", "another"})
    found = {task.key: result.row for task, result in Processes(workers).run(Job(behave, 60.0), tasks)}
    alone = {task.key: result.row for task, result in InProcess().run(Job(behave, 60.0), tasks[1::3])}
    assert len(found) == 12
    for key, row in alone.items():
        assert found[key] | {"planning_time_s": 0} == row | {"planning_time_s": 0}
    assert {row["outcome"] for row in found.values() if row["planner"] == "another"} <= {"reached", "collided"}


def test_what_cannot_be_stored_ends_no_run_in_this_process_either() -> None:
    tasks = make_tasks(["surrogate", "count", "another"])
    keys = [task.key for task in tasks]
    found = list(InProcess().run(Job(behave, 60.0), tasks))
    assert [task.key for task, _ in found] == keys
    assert [result.row["outcome"] == "planner_error" for _, result in found] == [True, True, False]


def test_a_trial_whose_process_is_killed_from_outside_runs_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("DEATHS", str(tmp_path / "deaths"))
    found = {task.spec.label: result for task, result in Processes(1).run(Job(behave, 60.0), make_tasks(["die twice"]))}
    assert found["die twice"].row["outcome"] in {"reached", "collided"}
    assert (tmp_path / "deaths").read_text() == "xxx"


RESULT = TrialResult(
    next(InProcess().run(Job(behave, 60.0), make_tasks(["fine"])))[1].row, np.arange(3.0), np.ones((3, 6)), "said"
)


@pytest.mark.parametrize("answer", [None, Failure("planner_error", "m", "t"), Unreadable("m")])
def test_answers_come_back_as_they_were(answer: object) -> None:
    frame = packed(7, answer)
    assert frame_length(frame) == len(frame)
    assert unpacked(7, frame) == answer
    with pytest.raises(GarbledError, match="something else"):
        unpacked(8, frame)


def test_a_result_comes_back_without_its_identity() -> None:
    back = unpacked(1, packed(1, RESULT))
    assert isinstance(back, TrialResult)
    assert back.row.items() <= RESULT.row.items()
    assert "scenario_id" not in back.row
    np.testing.assert_array_equal(back.times_s, RESULT.times_s)
    np.testing.assert_array_equal(back.configurations_rad, RESULT.configurations_rad)


@given(st.data())
def test_any_bytes_are_an_answer_or_refused(data: st.DataObject) -> None:
    frame = bytearray(packed(1, RESULT))
    for _ in range(data.draw(st.integers(1, 4))):
        place = data.draw(st.integers(0, len(frame) - 1))
        frame[place : place + data.draw(st.integers(0, 9))] = data.draw(st.binary(max_size=9))
    started_s = time.monotonic()
    with contextlib.suppress(GarbledError):
        unpacked(1, bytes(frame))
    assert time.monotonic() - started_s < 2
