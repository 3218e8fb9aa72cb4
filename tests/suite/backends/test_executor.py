import multiprocessing
import time
from pathlib import Path

import fakes
import pytest
from fakes import behave, cannot_prepare, make_tasks, prepare

from suite.backends.local import Job, WorkerStartError, run_tasks
from suite.trial.columns import TIMING_NAMES, Row

LINE_THAT_RAISES = 1 + next(
    number for number, line in enumerate(Path(fakes.__file__).read_text().splitlines()) if "raise ValueError" in line
)


def rows_of(labels: list[str], trials: int, workers: int, hang_limit_s: float = 60.0) -> dict[tuple[str, str], Row]:
    job = Job(behave, prepare, hang_limit_s)
    return {task.key: result.row for task, result in run_tasks(job, make_tasks(labels, trials), workers)}


def without_timings(rows: dict[tuple[str, str], Row]) -> dict[tuple[str, str], Row]:
    return {key: {k: v for k, v in row.items() if k not in TIMING_NAMES} for key, row in rows.items()}


def test_hangs_and_crashes_are_rows_and_the_rest_goes_on() -> None:
    rows = rows_of(["fine", "hang", "raise", "die", "quit"], trials=1, workers=2, hang_limit_s=0.5)
    found = {row["planner"]: (row["outcome"], row["message"]) for row in rows.values()}
    assert found["hang"] == ("planner_hung", "killed after 0.5 s")
    assert found["raise"] == ("planner_error", f"ValueError: two (fakes.py:{LINE_THAT_RAISES})")
    assert found["die"] == ("planner_error", "the process died: SIGKILL")
    assert found["quit"] == ("planner_error", "the process died: exit code 0")
    assert found["fine"][0] in {"reached", "collided"}
    for row in rows.values():
        assert row["scenario_id"] == "fake-0000"
        if row["planner"] != "fine":
            assert {row["success_per_step"], row["success_swept"], row["success_executable"]} == {False}


def test_the_number_of_workers_changes_timings_only() -> None:
    one = rows_of(["a", "b"], trials=10, workers=1)
    two = rows_of(["a", "b"], trials=10, workers=2)
    assert len(one) == 20
    assert without_timings(one) == without_timings(two)


def test_a_hang_is_killed_with_one_worker_too_and_in_time() -> None:
    started_s = time.monotonic()
    rows = rows_of(["hang", "fine"], trials=1, workers=1, hang_limit_s=0.5)
    assert [row["outcome"] == "planner_hung" for row in rows.values()] == [True, False]
    assert time.monotonic() - started_s < 30


def test_a_worker_that_cannot_start_is_nobodys_failure() -> None:
    with pytest.raises(WorkerStartError, match="exit code 7"):
        list(run_tasks(Job(behave, cannot_prepare, 60.0), make_tasks(["fine"]), workers=1))


def test_no_tasks_need_no_workers() -> None:
    assert list(run_tasks(Job(behave, prepare, 60.0), [], workers=4)) == []


def test_closing_early_leaves_no_process() -> None:
    running = run_tasks(Job(behave, prepare, 60.0), make_tasks(["fine", "hang"], trials=2), workers=2)
    next(running)
    running.close()
    assert multiprocessing.active_children() == []
