import json
import sqlite3
from contextlib import suppress
from pathlib import Path
from shutil import copytree
from unittest.mock import patch

import pytest
from fake_runs import contents, killed_run, run_with_fakes, snapshot

from scenarios import UserError
from suite.cli.main import main
from suite.errors import SuiteError
from suite.store.run_folder import open_run, read_trials

MANIFEST = {"schema_version": 2, "experiment": {"planners": ["pf"]}, "sources": "abc", "versions": {"ompl": "2.0.1"}}


@pytest.mark.parametrize("fresh", [False, True])
def test_a_folder_of_other_things_is_left_alone(tmp_path, fresh: bool) -> None:
    (tmp_path / "thesis.tex").write_text("years of work")
    with (
        pytest.raises(SuiteError, match=r"found thesis\.tex and no manifest\.json"),
        open_run(tmp_path, MANIFEST, [], fresh=fresh),
    ):
        pass
    assert [file.name for file in tmp_path.iterdir()] == ["thesis.tex"]


def test_fresh_starts_over_and_deletes_only_files_of_the_run(tmp_path) -> None:
    run_with_fakes(tmp_path)
    before = read_trials(tmp_path)
    (tmp_path / "notes.txt").write_text("mine")
    assert len(run_with_fakes(tmp_path, fresh=True)) == 16
    after = read_trials(tmp_path)
    assert before["trial_seed"].tolist() == after["trial_seed"].tolist()
    assert before["planning_time_s"].tolist() != after["planning_time_s"].tolist()
    assert (tmp_path / "notes.txt").read_text() == "mine"


@pytest.mark.parametrize("fresh", [False, True])
def test_a_run_whose_manifest_alone_is_missing_goes_on_or_starts_over(tmp_path, fresh: bool) -> None:
    run_with_fakes(tmp_path / "run")
    whole = contents(tmp_path / "run")
    (tmp_path / "run" / "manifest.json").unlink()
    assert len(run_with_fakes(tmp_path / "run", fresh=fresh)) == (16 if fresh else 0)
    assert contents(tmp_path / "run") == whole
    assert json.loads((tmp_path / "run" / "manifest.json").read_text())["experiment"]["trials"] == 4


class Killed(BaseException):
    pass


@pytest.fixture(scope="module")
def killed(tmp_path_factory) -> Path:
    """A run that was killed when it had grown by a trial: there is a log beside its journal."""
    folder = tmp_path_factory.mktemp("killed")
    run_with_fakes(folder)
    (folder / "notes.txt").write_text("mine")  # without a manifest or a journal, this would be no folder of a run
    killed_run(folder, trials=5, die_after=1)
    assert (folder / "run.db-wal").stat().st_size > 0
    return folder


@pytest.mark.parametrize("has_manifest", [True, False])
@pytest.mark.parametrize("deleted", range(8))
def test_fresh_can_be_cut_short_anywhere(tmp_path, killed, deleted: int, has_manifest: bool) -> None:
    whole, folder = contents(killed), tmp_path / "run"
    copytree(killed, folder)
    if not has_manifest:
        (folder / "manifest.json").unlink()
    left = iter(range(deleted))
    really_unlink = Path.unlink

    def unlink(file: Path, *, missing_ok: bool = False) -> None:
        if file.parent == folder and not file.name.startswith(".") and next(left, None) is None:
            raise Killed
        really_unlink(file, missing_ok=missing_ok)

    with patch.object(Path, "unlink", unlink), suppress(Killed):
        run_with_fakes(folder, fresh=True)
    run_with_fakes(folder)
    assert contents(folder) == whole


def test_a_log_without_its_journal_is_not_taken_for_rows(tmp_path) -> None:
    killed_run(tmp_path / "run", die_after=5)
    assert (tmp_path / "run" / "run.db-wal").stat().st_size > 0
    (tmp_path / "run" / "run.db").unlink()
    assert len(run_with_fakes(tmp_path / "run")) == 16


@pytest.mark.parametrize("stage", ["nothing in it", "no tables yet"])
def test_a_run_that_was_killed_at_once_goes_on(tmp_path, stage: str) -> None:
    (tmp_path / "run").mkdir()
    file = tmp_path / "run" / "run.db"
    file.touch()
    if stage == "no tables yet":
        with sqlite3.connect(file) as db:
            db.execute("PRAGMA journal_mode = WAL")
        db.close()
    assert len(run_with_fakes(tmp_path / "run")) == 16


def test_one_process_at_a_time(tmp_path) -> None:
    with (
        open_run(tmp_path, MANIFEST, []),
        pytest.raises(SuiteError, match="another process is running in it"),
        open_run(tmp_path, MANIFEST, [], fresh=True),
    ):
        pass


def test_a_broken_manifest_is_one_line(tmp_path) -> None:
    (tmp_path / "manifest.json").write_text('{"experiment": ')
    with pytest.raises(UserError, match=r"manifest\.json: not valid JSON"), open_run(tmp_path, MANIFEST, []):
        pass
    with open_run(tmp_path, MANIFEST, [], fresh=True):
        pass
    assert json.loads((tmp_path / "manifest.json").read_text()) == MANIFEST


@pytest.mark.parametrize("finished", [True, False])
def test_reading_writes_nothing(tmp_path, finished: bool, capfd) -> None:
    if finished:
        run_with_fakes(tmp_path)
    else:
        killed_run(tmp_path, die_after=5)
    before = snapshot(tmp_path)
    assert ("run.db-wal" in before) != finished
    for format in ("terminal", "markdown", "csv", "latex"):
        assert main(["table", str(tmp_path), "--format", format]) == 0
    after = snapshot(tmp_path)
    if not finished:  # through it processes tell each other what they read: no data of the run
        del before["run.db-shm"], after["run.db-shm"]
    assert after == before
    capfd.readouterr()
