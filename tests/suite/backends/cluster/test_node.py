"""What a Dask worker does, without Dask."""

import os
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from fakes import behave, behave_and_tell, behave_slowly, make_tasks, prepare_nothing
from hypothesis import given
from hypothesis import strategies as st

from planners import describe
from suite.backends.answer import GarbledError, packed
from suite.backends.cluster import node
from suite.backends.cluster.node import Brief, end, results_in, run_chunk, wrapped
from suite.backends.cluster.shipping import Unpacked, sources_of
from suite.backends.worker import LENGTH_BYTES
from suite.errors import SuiteError
from suite.experiment.code import house
from suite.trial.columns import TIMING_NAMES
from suite.trial.task import TrialTask, checked_result

PLUGIN = """
from helper import GAIN
from planners import ArmPlanner

class Mine(ArmPlanner):
    summary = f"{GAIN}"
"""


def brief_for(run: object = behave, tasks: list[TrialTask] | None = None) -> Brief:
    specs = [task.spec for task in tasks or []]
    return Brief(house(), run, prepare_nothing, 2.0, 60.0, None, tuple(tasks or ()), sources_of(specs))


@pytest.fixture(autouse=True)
def no_slots_left() -> Iterator[None]:
    yield
    for run in ("one", "two"):
        end(run)
    assert node._SLOTS == {}
    node._OVER.clear()


def test_a_chunk_gives_the_rows_that_its_tasks_give_here() -> None:
    tasks = make_tasks(["a", "raise", "quit", "hang", "b"])
    answer = run_chunk("one", house(), wrapped(brief_for()), wrapped(tasks))
    results = {k: checked_result(tasks[k], result) for k, result in results_in(answer, len(tasks)).items()}
    assert sorted(results) == list(range(len(tasks)))
    for place, task in enumerate(tasks):
        row = results[place].row
        if task.spec.label in {"a", "b"}:
            here = behave(task)
            assert {k: v for k, v in row.items() if k not in TIMING_NAMES} == {
                k: v for k, v in here.row.items() if k not in TIMING_NAMES
            }
            assert (results[place].configurations_rad == here.configurations_rad).all()
        else:
            assert row["outcome"] == ("planner_hung" if task.spec.label == "hang" else "planner_error")
            assert row["planner"] == task.spec.label


def test_a_run_keeps_its_process_and_the_next_run_has_another() -> None:
    def pids(run: str) -> set[str]:
        answer = run_chunk(run, house(), wrapped(brief_for(behave_and_tell)), wrapped(make_tasks(["a"], trials=3)))
        return {result.row["message"] for result in results_in(answer, 3).values()}

    first, again, other = pids("one"), pids("one"), pids("two")
    assert len(first) == 1
    assert first == again != other
    assert str(os.getpid()) not in first | other
    assert not Path(f"/proc/{first.pop()}").exists()
    end("two")
    assert not Path(f"/proc/{other.pop()}").exists()


def test_a_long_chunk_comes_back_with_what_it_has(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(node, "MAX_BYTES", 10)
    answer = run_chunk("one", house(), wrapped(brief_for()), wrapped(make_tasks(["a"], trials=5)))
    assert list(results_in(answer, 5)) == [0]


def test_a_run_that_is_over_stops_after_the_trial_it_is_at() -> None:
    tasks = make_tasks(["a"], trials=200)
    with ThreadPoolExecutor(1) as pool:
        running = pool.submit(run_chunk, "one", house(), wrapped(brief_for(behave_slowly)), wrapped(tasks))
        while not node._SLOTS:
            time.sleep(0.01)
        time.sleep(0.5)
        end("one")
        answer = running.result()
    assert len(results_in(answer, 200)) < 200
    assert run_chunk("one", house(), wrapped(brief_for()), wrapped(tasks)) == b""  # those that wait are not begun


def test_another_version_of_the_suite_is_refused_and_nothing_of_it_read() -> None:
    theirs = {"sources": "0" * 16, "versions": house()["versions"] | {"numba": "0.1"}}
    answer = run_chunk("one", theirs, b"no brief", b"no tasks")
    line = "found another version of the suite there: the sources have changed; numba 0.1 there, [^ ]* here"
    with pytest.raises(SuiteError, match=line):
        results_in(answer, 3)


@given(st.binary(max_size=60), st.integers(0, 40))
def test_bytes_that_are_no_answer_are_refused(noise: bytes, cut: int) -> None:
    task = make_tasks(["a"])[0]
    good = (0).to_bytes(LENGTH_BYTES) + packed(0, behave(task))
    assert list(results_in(good, 1)) == [0]
    for answer in (noise, good[:cut], good + noise, noise + good, good[:cut] + noise + good[cut:]):
        if answer in {b"", good}:
            continue
        with pytest.raises((GarbledError, SuiteError)):
            results_in(answer, 1)
    with pytest.raises(GarbledError):
        results_in(good, 0)  # of a task that was never sent
    with pytest.raises(GarbledError):
        results_in({"place": 0}, 1)


@pytest.fixture
def plugin(tmp_path: Path) -> Path:
    folder = tmp_path / "mine"
    folder.mkdir()
    (folder / "plugin.py").write_text(PLUGIN)
    (folder / "helper.py").write_text("GAIN = 3\n")
    (folder / "unused.py").write_text("raise AssertionError\n")
    return folder / "plugin.py"


def plugin_task(plugin: Path) -> TrialTask:
    (task,) = make_tasks(["a"])
    return TrialTask(task.scenario, describe(f"{plugin}:Mine"), "cubic", False, 0)


def test_a_planners_file_travels_with_what_it_imports(plugin: Path, tmp_path: Path) -> None:
    task = plugin_task(plugin)
    sources = sources_of([task.spec, task.spec])
    assert {name: set(files) for name, files in sources.items()} == {str(plugin): {"plugin.py", "helper.py"}}
    there = Unpacked(sources, tmp_path / "there").here(task)
    assert there.spec.name.startswith(str(tmp_path / "there"))
    assert there.key == task.key
    assert describe(there.spec.name).code == task.spec.code


def test_other_code_of_a_planner_is_refused(plugin: Path, tmp_path: Path) -> None:
    task = plugin_task(plugin)
    (plugin.parent / "helper.py").write_text("GAIN = 4\n")
    with pytest.raises(SuiteError, match=r"Mine: found other code of it there \(\w{16}\), allowed the same as here"):
        Unpacked(sources_of([task.spec]), tmp_path / "there").here(task)


@pytest.mark.parametrize("name", ["../outside.py", "/tmp/outside.py"])
def test_nothing_is_written_outside_the_folder(name: str, tmp_path: Path) -> None:
    with pytest.raises(SuiteError, match="allowed paths below its folder"):
        Unpacked({"plugin.py": {name: b""}}, tmp_path / "there")
