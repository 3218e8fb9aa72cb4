"""Journals and tables from before rows said which conditions and which code made them."""

import io
import json
import re
import sqlite3
from pathlib import Path
from unittest.mock import patch

import pandas as pd
import pytest
from fake_runs import SOURCES, contents, run_with_fakes, snapshot

from scenarios import UserError
from suite.cli.main import main
from suite.compare.tables import summarize
from suite.errors import SuiteError
from suite.experiment.code import versions
from suite.store import schema
from suite.store.frames import read_table_csv, read_trials_csv
from suite.store.run_folder import read_manifest, read_trials
from suite.trial.columns import TIMING_NAMES

RESULTS = Path(__file__).parents[3] / "results"

OLD_COLUMNS = """
    "scenario_id" TEXT, "scenario_hash" TEXT, "family" TEXT, "n_obstacles" INTEGER, "planner" TEXT, "settings" TEXT,
    "predictor" TEXT, "limits" INTEGER, "noise_mm" REAL, "dropout" REAL, "experiment_seed" INTEGER,
    "trial_seed" INTEGER, "outcome" TEXT, "success_per_step" INTEGER, "success_swept" INTEGER,
    "success_executable" INTEGER, "violation_per_step_time_s" REAL, "violation_per_step_kind" TEXT,
    "violation_swept_time_s" REAL, "violation_swept_kind" TEXT, "violation_executable_time_s" REAL,
    "violation_executable_kind" TEXT, "arrival_time_s" REAL, "planning_time_s" REAL, "n_solves" INTEGER,
    "solve_p50_s" REAL, "solve_p95_s" REAL, "solve_max_s" REAL, "tip_path_length_m" REAL,
    "smoothness_paper_rad" REAL, "smoothness_bending_rad" REAL, "min_clearance_m" REAL, "state_checks" INTEGER,
    "motion_checks" INTEGER, "message" TEXT, "audit_time_s" REAL, "trial_wall_s" REAL, executed BLOB NOT NULL
"""
"""As they were written then: recorded, not made from the present ones."""


@pytest.fixture
def old_run(tmp_path) -> Path:
    """A run of fakes as the first version would have left it."""
    folder = tmp_path / "old"
    run_with_fakes(folder)
    with sqlite3.connect(folder / "run.db") as db:
        names = ", ".join(column.split()[0] for column in OLD_COLUMNS.split(","))
        db.execute(f"CREATE TABLE old ({OLD_COLUMNS}, PRIMARY KEY (scenario_hash, planner))")
        db.execute(f"INSERT INTO old SELECT {names} FROM shown")
        for drop in ("VIEW shown", "TABLE trials", "TABLE asked", "TABLE houses"):
            db.execute(f"DROP {drop}")
        db.execute("ALTER TABLE old RENAME TO trials")
        db.execute("PRAGMA user_version = 0")
        db.execute("PRAGMA application_id = 0")
    db.close()
    manifest = read_manifest(folder)
    for later in ("schema_version", "code"):
        del manifest[later]
    (folder / "manifest.json").write_text(json.dumps(manifest))
    for name in ("trials.csv", "table.csv", "table.md"):
        (folder / name).unlink()
    return folder


def test_an_old_journal_is_read_and_not_written_to(old_run, tmp_path, capfd) -> None:
    before = snapshot(old_run)
    trials = read_trials(old_run)
    assert main(["table", str(old_run)]) == 0
    assert "rrt" in capfd.readouterr().out
    assert snapshot(old_run) == before
    run_with_fakes(tmp_path / "new")
    new = read_trials(tmp_path / "new")
    same = [name for name in new if name in OLD_COLUMNS and not name.endswith("_s")]
    pd.testing.assert_frame_equal(trials[same], new[same])
    assert trials["prediction_margin"].tolist() == new["prediction_margin"].tolist()
    assert trials["arm"].isna().all()  # it does not say


def test_an_old_run_goes_on_where_nothing_has_changed(old_run, tmp_path) -> None:
    assert run_with_fakes(old_run) == []
    assert run_with_fakes(old_run, trials=5) == ["pf"] * 2 + ["rrt"] * 2
    trials = read_trials(old_run)
    assert trials["house_code"].unique().tolist() == [read_manifest(old_run)["code"]["house"]]
    assert trials["arm"].isna().sum() == 0  # filled in: the scenarios are known now


def test_an_old_run_grows_like_any_other(old_run, tmp_path) -> None:
    run_with_fakes(old_run, trials=5)
    run_with_fakes(tmp_path / "new", trials=5)
    grown, new = contents(old_run), contents(tmp_path / "new")
    assert grown == new


def test_an_old_run_of_another_house_is_kept_as_it_is_or_refused(old_run) -> None:
    before = snapshot(old_run)
    with pytest.raises(SuiteError, match=r"16 of 16 trials were run by another version of the suite \(the sources"):
        run_with_fakes(old_run, sources="1" * 16)
    assert snapshot(old_run) == before
    assert run_with_fakes(old_run, sources="1" * 16, keep_stale=True) == []
    assert pd.read_csv(old_run / "table.csv")["stale"].tolist() == [4] * 4


def test_old_rows_of_which_nothing_says_who_made_them_are_stale(old_run) -> None:
    (old_run / "manifest.json").unlink()
    with pytest.raises(SuiteError, match=r"another version of the suite \(nothing says which\)"):
        run_with_fakes(old_run)
    assert run_with_fakes(old_run, keep_stale=True) == []


def test_a_manifest_that_is_new_says_nothing_of_old_rows(old_run) -> None:
    """As after a kill between the two: the rows must not pass for ones of the present code."""
    manifest = read_manifest(old_run) | {"schema_version": 2}
    assert (manifest["sources"], manifest["versions"]) == (SOURCES, versions())
    (old_run / "manifest.json").write_text(json.dumps(manifest))
    with pytest.raises(SuiteError, match="nothing says which"):
        run_with_fakes(old_run)


def test_an_update_that_fails_leaves_the_old_journal(old_run) -> None:
    before = read_trials(old_run)
    with patch.object(schema, "remember_house", side_effect=RuntimeError), pytest.raises(RuntimeError):
        schema.open_to_write(old_run / "run.db", {"sources": "x", "versions": {}})
    pd.testing.assert_frame_equal(read_trials(old_run), before)
    assert run_with_fakes(old_run) == []


@pytest.fixture
def run_of_two(tmp_path) -> Path:
    """A run of fakes as the second version would have left it: before rows said what is impossible."""
    folder = tmp_path / "two"
    run_with_fakes(folder)
    later = ("impossible_reason", "impossible_from_s")
    dropped = [f'ALTER TABLE trials DROP COLUMN "{name}"' for name in later]
    change(folder / "run.db", "DROP VIEW shown", *dropped, schema._SHOWN, "PRAGMA user_version = 2")
    trials = pd.read_csv(folder / "trials.csv").drop(columns=list(later))
    trials.to_csv(folder / "trials.csv", index=False)
    (folder / ".finished.json").unlink()
    return folder


def test_a_run_of_the_second_version_is_read_unchanged_and_goes_on(run_of_two, tmp_path) -> None:
    before = snapshot(run_of_two)
    run_with_fakes(tmp_path / "new")
    new = read_trials(tmp_path / "new").drop(columns=list(TIMING_NAMES))
    for old in (read_trials(run_of_two), read_trials_csv(run_of_two / "trials.csv")):
        pd.testing.assert_frame_equal(old.drop(columns=list(TIMING_NAMES)), new)
    assert snapshot(run_of_two) == before
    assert run_with_fakes(run_of_two) == []
    assert run_with_fakes(run_of_two, trials=5) == ["pf"] * 2 + ["rrt"] * 2
    run_with_fakes(tmp_path / "new", trials=5)
    assert contents(run_of_two) == contents(tmp_path / "new")


def change(file: Path, *statements: str) -> None:
    with sqlite3.connect(file) as db:
        for statement in statements:
            db.execute(statement)
    db.close()


@pytest.mark.parametrize(
    ("statements", "line"),
    [
        (["PRAGMA user_version = 4"], "found a journal of version 4, allowed up to 3: update suite"),
        (["PRAGMA application_id = 7"], "found no journal of a run in it, allowed one of version 1 to 3"),
        (["DROP VIEW shown", "ALTER TABLE trials RENAME TO essays"], "found no journal of a run in it"),
        (["DROP VIEW shown", "ALTER TABLE trials DROP COLUMN outcome"], "found no journal of a run in it"),
    ],
)
def test_what_is_no_journal_or_a_newer_one_is_one_line_and_left_alone(tmp_path, statements, line: str, capfd) -> None:
    run_with_fakes(tmp_path)
    change(tmp_path / "run.db", *statements)
    before = snapshot(tmp_path)
    capfd.readouterr()
    assert main(["table", str(tmp_path)]) == 2
    err = capfd.readouterr().err
    assert err.count("\n") == 1
    assert line in err
    with pytest.raises(UserError, match=line):
        run_with_fakes(tmp_path)
    assert snapshot(tmp_path) == before


@pytest.mark.parametrize(
    "content", [b"a letter to my aunt, and by no means a short one" * 99, b"SQLite format 3\0" * 9]
)
def test_a_file_that_is_no_database_is_one_line_and_left_alone(tmp_path, content: bytes, capfd) -> None:
    run_with_fakes(tmp_path)
    (tmp_path / "run.db").write_bytes(content)
    before = snapshot(tmp_path)
    capfd.readouterr()
    assert main(["table", str(tmp_path)]) == 2
    assert capfd.readouterr().err.count("\n") == 1
    with pytest.raises(SuiteError):
        run_with_fakes(tmp_path)
    assert snapshot(tmp_path) == before
    assert len(run_with_fakes(tmp_path, fresh=True)) == 16


def test_trials_of_the_first_version_are_read() -> None:
    trials = read_trials_csv(Path(__file__).with_name("version_1") / "trials.csv")
    assert len(trials) == 200
    assert trials["arm"].isna().all()
    assert set(trials["prediction_margin"]) == {0.0}
    assert not trials["is_bound"].any()
    assert summarize(trials)["trials"].sum() == 200


def test_committed_trials_sum_up_to_their_table() -> None:
    trials = read_trials_csv(RESULTS / "table1" / "trials.csv")
    assert len(trials) == 2400
    order = read_manifest(RESULTS / "table1")["experiment"]["planners"]
    table = read_table_csv(RESULTS / "table1" / "table.csv")
    pd.testing.assert_frame_equal(summarize(trials, order), table, check_exact=False, rtol=1e-8)


@pytest.mark.parametrize("format", ["terminal", "markdown", "csv", "latex"])
@pytest.mark.parametrize("name", ["orbit", "crossing", "wander"])
def test_a_committed_run_without_trials_prints_its_table(name: str, format: str, capfd) -> None:
    before = snapshot(RESULTS / name)
    assert main(["table", str(RESULTS / name), "--format", format]) == 0
    out, err = capfd.readouterr()
    assert err == ""
    assert len(re.findall(r"temporal-ct(?: *[&|]|,\S|  )", out)) == 4  # cells; the note above names it as well
    if format == "markdown":
        page = (RESULTS / name / "table.md").read_text().splitlines()
        assert len(set(out.splitlines()) - set(page)) <= 1  # a half that is rounded a second time
    if format == "csv":
        written = pd.read_csv(RESULTS / name / "table.csv")
        pd.testing.assert_frame_equal(pd.read_csv(io.StringIO(out))[list(written)], written)
    assert main(["table", str(RESULTS / name), "--reference", "t3"]) == 2
    assert "found no trials" in capfd.readouterr().err
    assert snapshot(RESULTS / name) == before


@pytest.mark.parametrize("name", ["scenario_hash", "n_obstacles", "planner", "outcome"])
def test_a_trial_that_does_not_say_which_it_is_is_one_line(tmp_path, name: str, capfd) -> None:
    run_with_fakes(tmp_path)
    change(tmp_path / "run.db", f"UPDATE trials SET {name} = NULL WHERE number = 3")
    trials = pd.read_csv(tmp_path / "trials.csv", dtype=object)
    trials.loc[2, name] = None
    trials.to_csv(tmp_path / "trials.csv", index=False)
    for _ in ("the journal", "trials.csv"):
        capfd.readouterr()
        assert main(["table", str(tmp_path)]) == 2
        err = capfd.readouterr().err
        assert f"found a trial without {name}" in err
        assert err.count("\n") == 1
        (tmp_path / "run.db").unlink(missing_ok=True)


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("", "cannot be read"),
        ("family\nx\n", "found no column n_obstacles"),
        ("family,n_obstacles,planner,trials\norbit,many,pf,3\n", "cannot be read"),
    ],
)
def test_a_broken_table_is_one_line(tmp_path, text: str, line: str, capfd) -> None:
    (tmp_path / "table.csv").write_text(text)
    assert main(["table", str(tmp_path)]) == 2
    err = capfd.readouterr().err
    assert line in err
    assert err.count("\n") == 1
