"""Real schedulers and workers, as processes on loopback; some are killed."""

import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from unittest.mock import patch

import pytest
from distributed import Client
from fake_runs import contents, run_with_fakes
from fakes import behave_slowly, make_tasks, prepare_nothing

from suite.backends.cluster import head
from suite.backends.cluster.head import DaskCluster
from suite.backends.job import Job
from suite.backends.processes import Processes
from suite.cli.main import main
from suite.errors import SuiteError
from suite.experiment.code import house, source_hash
from suite.store.run_folder import read_trials
from suite.trial.columns import TIMING_NAMES

TESTS = Path(__file__).parents[3]
QUIET = {"DASK_LOGGING__DISTRIBUTED": "critical", "DASK_DISTRIBUTED__WORKER__PROFILE__ENABLED": "False"}
FAILURES = {"DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": "0"}


@contextmanager
def started(part: str, *options: str) -> Iterator[subprocess.Popen[str]]:
    """A scheduler or a worker, as ``dask scheduler`` and ``dask worker`` start it."""
    path = {"PYTHONPATH": f"{TESTS.parent}{os.pathsep}{TESTS}"}
    command = [sys.executable, "-m", f"distributed.cli.dask_{part}", *options]
    environment = os.environ | QUIET | FAILURES | path
    process = subprocess.Popen(command, env=environment, stderr=subprocess.DEVNULL, text=True, start_new_session=True)
    try:
        yield process
    finally:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()


@pytest.fixture(scope="module")
def scheduler(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """The address of a scheduler with two workers, each of which a nanny starts again when it dies."""
    file = tmp_path_factory.mktemp("cluster") / "scheduler.json"
    with ExitStack() as stack:
        stack.enter_context(started("scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard",
                                    "--scheduler-file", str(file)))  # fmt: skip
        while not (file.exists() and (found := re.search(r'"address": "(.*?)"', file.read_text()))):
            time.sleep(0.1)
        for _ in range(2):
            options = ("--nthreads", "1", "--memory-limit", "0", "--no-dashboard", "--death-timeout", "60")
            stack.enter_context(started("worker", found[1], *options))
        yield found[1]


def pids(scheduler: str) -> dict[str, int]:
    """Process ids of the workers, by address."""
    with Client(scheduler, set_as_default=False) as client:
        return client.run(os.getpid, on_error="ignore")


def rows_of(backend: object, job: Job, tasks: list) -> dict[str, dict[str, object]]:
    rows = {}
    for task, result in backend.run(job, tasks):
        assert task.key not in rows
        rows[task.key] = {k: v for k, v in result.row.items() if k not in TIMING_NAMES}
    return rows


def test_two_workers_give_the_rows_of_local_ones_also_when_one_is_killed_three_times(scheduler: str) -> None:
    tasks = make_tasks(["a", "raise", "b"], trials=25)
    job = Job(behave_slowly, 5.0)
    local = rows_of(Processes(2), job, tasks)
    rows, victims = {}, set[int]()
    for task, result in DaskCluster(scheduler, 0, prepare_nothing).run(job, tasks):
        assert task.key not in rows
        rows[task.key] = {k: v for k, v in result.row.items() if k not in TIMING_NAMES}
        if len(victims) < 3 and len(rows) > 10 * len(victims):
            while not (new := set(pids(scheduler).values()) - victims):
                time.sleep(0.1)
            victim = new.pop()
            os.kill(victim, signal.SIGKILL)
            victims.add(victim)
    assert len(victims) == 3
    assert rows == local


def head_process(folder: Path, scheduler: str) -> subprocess.Popen[bytes]:
    arguments = f"trials=40, sources={source_hash()!r}, where={scheduler!r}"
    call = f"from fake_runs import *; run_with_fakes(Path({str(folder)!r}), {arguments})"
    path = os.environ | {"PYTHONPATH": f"{TESTS.parent}{os.pathsep}{TESTS}"}
    return subprocess.Popen([sys.executable, "-c", call], env=path, stderr=subprocess.DEVNULL)


def test_a_head_that_is_killed_goes_on_where_it_was(scheduler: str, tmp_path: Path) -> None:
    first = head_process(tmp_path / "run", scheduler)
    while not ((tmp_path / "run" / "run.db").exists() and len(read_trials(tmp_path / "run", ["planner"])) > 3):
        assert first.poll() is None
        time.sleep(0.1)
    first.kill()
    first.wait()
    there = len(read_trials(tmp_path / "run", ["planner"]))
    assert 3 < there < 160
    again = run_with_fakes(tmp_path / "run", trials=40, sources=source_hash(), where=scheduler)
    assert len(again) == 160 - there
    run_with_fakes(tmp_path / "local", trials=40, sources=source_hash())
    assert contents(tmp_path / "run") == contents(tmp_path / "local")


def test_a_worker_with_another_version_of_the_suite_is_named(scheduler: str) -> None:
    other = house() | {"sources": "0" * 16}
    with (
        patch.object(head, "house", return_value=other),
        pytest.raises(SuiteError, match=r"worker tcp://[\d.:]+: found another version of the suite there: the so"),
    ):
        list(DaskCluster(scheduler, 0, prepare_nothing).run(Job(behave_slowly, 5.0), make_tasks(["a"])))


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:9", "nonsense://x", "127.0.0.1:99999999"])
def test_no_scheduler_is_one_line(address: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(head, "CONNECT_LIMIT_S", 0.5)
    with pytest.raises(SuiteError, match=f"scheduler: found none at '{address}' .*, allowed such as tcp://host:8786"):
        list(DaskCluster(address, 0, prepare_nothing).run(Job(behave_slowly, 5.0), make_tasks(["a"])))


def test_a_cluster_is_started_here_and_ended(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    options = ["--planners", "pf", "--obstacles", "0", "--trials", "2", "--seed", "1000"]
    command = ["run", *options, "--backend", "dask", "--workers", "1", "--out", str(tmp_path / "run")]
    assert main(command) == 0
    said = capfd.readouterr()
    assert "Traceback" not in said.err
    assert "2/2 trials" in said.err
    assert len(read_trials(tmp_path / "run")) == 2
    children = Path(f"/proc/{os.getpid()}/task/{os.getpid()}/children")
    commands = [Path(f"/proc/{child}/cmdline").read_bytes() for child in children.read_text().split()]
    assert not [command for command in commands if b"spawn_main" in command]


def test_without_dask_one_line_says_how_to_get_it(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    assert main(["run", "--planners", "pf", "--backend", "dask", "--out", str(tmp_path / "run")]) == 2
    line = "suite: error: backend: found no dask, allowed with it: pip install 'continuum-arm-suite[cluster]'\n"
    assert capfd.readouterr().err == line
    assert not (tmp_path / "run").exists()


@pytest.mark.parametrize(
    ("options", "line"),
    [
        (["--scheduler", "tcp://a:1"], "--scheduler: found beside --backend local, allowed with --backend dask"),
        (["--backend", "dask", "--scheduler", "tcp://a:1", "--workers", "2"], "--workers: found beside --scheduler"),
    ],
)
def test_options_that_do_not_go_together(options: list[str], line: str, capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "--planners", "pf", *options]) == 2
    assert line in capfd.readouterr().err
