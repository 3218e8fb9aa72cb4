import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest
from fakes import behave, behave_slowly, heavy_imports, make_parts, make_tasks, place_of, warm, warm_after_a_death

from planners.failure import Failure
from suite.backends import agenda, process
from suite.backends.job import Job, Part
from suite.backends.processes import Processes
from suite.trial.columns import TIMING_NAMES, Row

Rows = dict[tuple[str, str], Row]

THREE = place_of(r'ValueError("three\nlines")')


def rows_of(
    labels: list[str], trials: int = 1, workers: int = 2, hang_limit_s: float = 60.0, parts: list[Part] | None = None
) -> Rows:
    job = Job(behave, hang_limit_s, parts or [], warm_up_limit_s=hang_limit_s)
    return {task.key: result.row for task, result in Processes(workers).run(job, make_tasks(labels, trials))}


def outcomes_of(rows: Rows) -> dict[str, tuple[str, str | None]]:
    return {row["planner"]: (row["outcome"], row["message"]) for row in rows.values()}


def without_timings(rows: Rows) -> Rows:
    return {key: {k: v for k, v in row.items() if k not in TIMING_NAMES} for key, row in rows.items()}


def children() -> set[str]:
    """Process ids of this process's children."""
    return {
        pid for file in Path("/proc/self/task").glob("*/children") for pid in file.read_text(encoding="ascii").split()
    }


@pytest.fixture(autouse=True)
def no_orphans() -> Iterator[None]:
    before = children()
    yield
    assert children() <= before


def test_hangs_and_crashes_are_rows_and_the_rest_goes_on() -> None:
    rows = rows_of(["fine", "hang", "raise", "die", "quit", "leave"], hang_limit_s=0.5)
    found = outcomes_of(rows)
    assert found["hang"] == ("planner_hung", "killed after 0.5 s")
    assert found["raise"] == ("planner_error", "ValueError: two lines" + place_of(r'ValueError("two\nlines")'))
    assert found["die"] == ("worker_lost", "the process died: SIGKILL")
    assert found["quit"] == ("planner_error", "the process died: exit code 0")
    assert found["leave"] == ("planner_error", "SystemExit: 5" + place_of("SystemExit(5)"))
    assert found["fine"][0] in {"reached", "collided"}
    for row in rows.values():
        assert row["scenario_id"] == "fake-0000"
        if row["planner"] != "fine":
            assert {row["success_per_step"], row["success_swept"], row["success_executable"]} == {False}


def test_the_number_of_workers_changes_timings_only() -> None:
    one, two = (rows_of(["a", "b"], trials=10, workers=workers) for workers in (1, 2))
    assert len(one) == 20
    assert without_timings(one) == without_timings(two)


def test_a_hang_is_killed_with_one_worker_too_and_in_time() -> None:
    started_s = time.monotonic()
    rows = rows_of(["hang", "fine"], workers=1, hang_limit_s=0.5)
    assert [row["outcome"] == "planner_hung" for row in rows.values()] == [True, False]
    assert time.monotonic() - started_s < 60


@pytest.mark.parametrize("workers", [1, 2])
def test_a_planner_that_fails_in_its_warm_up_costs_its_own_rows_alone(workers: int) -> None:
    hows = {"raises": "raise", "hangs": "hang", "dies": "die", "quits": "quit", "leaves": "leave", "fine": ""}
    rows = rows_of(list(hows), trials=3, workers=workers, hang_limit_s=1.0, parts=make_parts(hows))
    assert len(rows) == 18
    found = outcomes_of(rows)
    assert found["raises"] == (
        "planner_error",
        f"in warm-up: ValueError: three lines{THREE}",
    )
    assert found["hangs"] == ("planner_hung", "in warm-up: killed after 1 s")
    assert found["dies"] == ("worker_lost", "in warm-up: the process died: SIGKILL")
    assert found["quits"] == ("planner_error", "in warm-up: the process died: exit code 7")
    assert found["leaves"] == ("planner_error", "in warm-up: SystemExit: 3" + place_of("SystemExit(3)"))
    for row in rows.values():
        assert (row["planner"] == "fine") == (row["outcome"] in {"reached", "collided"})
    alone = rows_of(["fine"], trials=3, workers=workers)
    assert without_timings(alone).items() <= without_timings(rows).items()


def test_nobody_waits_for_a_planner_that_hangs_in_its_warm_up() -> None:
    job = Job(behave, 60.0, make_parts({"hangs": "hang", "fine": ""}), warm_up_limit_s=60.0)
    started_s = time.monotonic()
    running = Processes(2).run(job, make_tasks(["hangs", "fine"], trials=4))
    assert [next(running)[0].spec.label for _ in range(4)] == ["fine"] * 4
    assert time.monotonic() - started_s < 60
    running.close()


def test_a_process_killed_in_a_warm_up_is_started_again(tmp_path: Path) -> None:
    part = Part("fine", partial(warm_after_a_death, str(tmp_path / "died")), 1.0, planner="fine")
    assert outcomes_of(rows_of(["fine"], workers=1, parts=[part]))["fine"][1] is None
    assert (tmp_path / "died").exists()


def test_what_every_trial_needs_and_cannot_have_is_in_every_row() -> None:
    found = outcomes_of(rows_of(["a", "b"], parts=[Part("audit", partial(warm, "raise"), 1.0)]))
    assert set(found.values()) == {("planner_error", f"in warm-up, audit: ValueError: three lines{THREE}")}


def test_a_part_that_only_saves_work_may_fail() -> None:
    part = Part("predictor", partial(warm, "raise"), 1.0, is_shared=False)
    assert outcomes_of(rows_of(["a"], parts=[part]))["a"][1] is None


def dies_at_first(tmp_path: Path, times: int) -> str:
    """A stand-in for Python that dies ``times`` times before it does what it is asked."""
    script = tmp_path / "python"
    count = tmp_path / "starts"
    script.write_text(
        f'#!/bin/sh\necho >> {count}\n[ $(wc -l < {count}) -le {times} ] && exit 7\nexec {sys.executable} "$@"\n'
    )
    script.chmod(0o755)
    return str(script)


def test_a_worker_that_dies_while_it_starts_is_started_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(process.sys, "executable", dies_at_first(tmp_path, 2))
    assert outcomes_of(rows_of(["fine"], workers=1))["fine"][1] is None


def test_workers_that_never_start_cost_trials_and_end(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(process.sys, "executable", dies_at_first(tmp_path, 4))
    rows = rows_of(["a", "b"], workers=1)
    assert outcomes_of(rows)["a"] == ("worker_lost", "no worker process could start: the process died: exit code 7")
    assert outcomes_of(rows)["b"][1] is None


def test_workers_that_never_start_cost_no_trial_beside_one_that_works(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with Processes(2) as processes:  # the first is on its way
        monkeypatch.setattr(process.sys, "executable", dies_at_first(tmp_path, 1000))
        rows = [result.row for _, result in processes.run(Job(behave_slowly, 60.0), make_tasks(["a"], trials=40))]
    assert 3 < len((tmp_path / "starts").read_text().splitlines()) <= 3 * (40 + 1) + 1
    assert {row["message"] for row in rows} == {None}


def test_what_cannot_be_sent_to_a_worker_is_a_row() -> None:
    class Local:
        pass

    tasks = make_tasks(["fine", "local"])
    tasks[1].__dict__["local"] = Local()
    found = {task.spec.label: result.row for task, result in Processes(1).run(Job(behave, 60.0), tasks)}
    assert "cannot be sent to a worker process" in found["local"]["message"]
    assert found["fine"]["message"] is None


def test_planners_that_cannot_be_imported_all_fail_with_nothing_else_to_do(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(agenda, "LOOK_AHEAD", 3)
    failure = Failure("planner_error", "in import: no")
    tasks = [replace(task, spec=task.spec._replace(failure=failure)) for task in make_tasks(["a"], trials=8)]
    results = [result.row["message"] for _, result in Processes(1).run(Job(behave, 60.0), tasks)]
    assert results == ["in import: no"] * 8


def test_no_tasks_need_no_workers() -> None:
    assert list(Processes(4).run(Job(behave, 60.0), [])) == []


def test_closing_early_leaves_no_process() -> None:
    before = children()
    running = Processes(2).run(Job(behave, 60.0), make_tasks(["fine", "hang"], trials=2))
    next(running)
    assert len(children() - before) == 2
    running.close()
    assert children() <= before


def test_a_process_started_ahead_is_used_or_ended() -> None:
    before = children()
    with Processes(1) as processes:
        (started,) = children() - before
        finished = processes.run(Job(behave, 60.0), make_tasks(["a", "b"]))
        next(finished)
        assert children() - before == {started}
    with Processes(1):
        pass


def test_workers_import_neither_tables_nor_terminals() -> None:
    ((_, result),) = Processes(1).run(Job(heavy_imports, 60.0), make_tasks(["any"]))
    assert result.row["message"] == ""


@pytest.mark.parametrize("way", ["script", "stdin"])
def test_workers_do_not_run_a_script_without_a_main_guard(way: str, tmp_path: Path) -> None:
    code = """
import sys
sys.path[:0] = {path}
from fakes import behave, make_tasks
from suite.backends.job import Job
from suite.backends.processes import Processes
print("once")
finished = Processes(2).run(Job(behave, 60.0), make_tasks(["a", "b"]))
print([result.row["message"] for _, result in finished])
"""
    code = code.format(path=[str(Path(__file__).parents[2]), str(Path(__file__).parents[3])])
    script = tmp_path / "script.py"
    script.write_text(code)
    command = [sys.executable, str(script)] if way == "script" else [sys.executable, "-"]
    said = subprocess.run(command, input=code, check=True, capture_output=True, text=True, timeout=120)
    assert said.stdout == "once\n[None, None]\n"
    assert said.stderr == ""
