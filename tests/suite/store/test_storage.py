"""Disks that are full, folders that go away, journals that are none, and who else is there."""

import shutil
import sqlite3
import subprocess
import sys
from pathlib import Path

import pytest
from fake_runs import killed_run, run_with_fakes, snapshot
from fakes import behave, make_tasks

from scenarios import UserError
from suite.errors import SuiteError
from suite.store.journal import Journal
from suite.store.run_folder import read_trials
from suite.store.volume import file_system, held, is_held

MOUNTS = """\
21 1 0:20 / / rw,relatime - ext4 /dev/sda1 rw
22 21 0:21 / /home rw - nfs4 server:/home rw
23 22 0:22 / /home/me/fast\\040disk rw shared:3 - xfs /dev/sdb rw
"""


@pytest.mark.parametrize(
    ("folder", "kind"),
    [("/tmp/run", "ext4"), ("/home/me/run", "nfs4"), ("/home/me/fast disk/run", "xfs"), ("/homes", "ext4")],
)
def test_the_file_system_is_that_of_the_nearest_mount(folder: str, kind: str) -> None:
    assert file_system(Path(folder), MOUNTS) == kind


def test_where_machines_share_a_folder_there_is_no_shared_log(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("suite.store.schema.is_remote", lambda folder: True)
    (task,) = make_tasks(["fine"])
    with Journal(tmp_path / "run.db") as journal:
        journal.add(task, behave(task))
        assert not (tmp_path / "run.db-wal").exists()
        with sqlite3.connect(tmp_path / "run.db") as other:
            assert other.execute("PRAGMA journal_mode").fetchone() == ("delete",)


def test_a_killed_run_is_read_without_a_trace(tmp_path: Path) -> None:
    killed_run(tmp_path / "run", die_after=5)
    assert (tmp_path / "run" / "run.db-wal").stat().st_size > 0
    before = snapshot(tmp_path / "run")
    trials = read_trials(tmp_path / "run")
    assert trials is not None
    assert len(trials) == 5
    assert snapshot(tmp_path / "run") == before


def test_a_run_whose_folder_is_deleted_stops_with_one_line(tmp_path: Path) -> None:
    first, second = make_tasks(["a", "b"])
    with Journal(tmp_path / "run.db") as journal:
        journal.add(first, behave(first))
        shutil.rmtree(tmp_path)
        with pytest.raises(SuiteError, match=r"run\.db: found it deleted"):
            journal.add(second, behave(second))


def test_a_full_disk_is_one_line_and_the_same_command_goes_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    really_add, added = Journal.add, []

    def add(journal, task, result) -> None:
        if len(added) == 3:
            raise sqlite3.OperationalError("database or disk is full")
        added.append(task)
        really_add(journal, task, result)

    with monkeypatch.context() as patch:
        patch.setattr(Journal, "add", add)
        with pytest.raises(SuiteError, match="stopped: database or disk is full; what had finished is saved"):
            run_with_fakes(tmp_path / "run")
    assert len(run_with_fakes(tmp_path / "run")) == 16 - 3


@pytest.mark.parametrize("how", ["text", "other tables", "cut", "folder", "fifo"])
def test_what_is_no_journal_is_one_line_and_stays_as_it_is(tmp_path: Path, how: str) -> None:
    file = tmp_path / "run.db"
    match how:
        case "text":
            file.write_text("no database" * 100)
        case "other tables":
            with sqlite3.connect(file) as db:
                db.execute("CREATE TABLE trials (key TEXT, outcome TEXT)")
        case "cut":
            run_with_fakes(tmp_path / "run")
            file.write_bytes((tmp_path / "run" / "run.db").read_bytes()[:6000])
        case "folder":
            file.mkdir()
        case "fifo":
            subprocess.run(["mkfifo", file], check=True)
    before = file.read_bytes() if file.is_file() else None
    with pytest.raises(UserError, match=r"run\.db: ") as caught:
        read_trials(tmp_path)
    assert len(str(caught.value)) <= 320
    assert before is None or file.read_bytes() == before


def test_who_holds_a_folder_is_seen_and_lets_go(tmp_path: Path) -> None:
    assert not is_held(tmp_path)
    with held(tmp_path):
        code = (
            f"from pathlib import Path; from suite.store.volume import is_held; print(is_held(Path({str(tmp_path)!r})))"
        )
        said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
        assert said.stdout == "True\n"
    assert not is_held(tmp_path)
