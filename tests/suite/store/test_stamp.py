"""A finished run is left alone, without a look at its trials; whatever has changed is noticed."""

import json
import sqlite3
from contextlib import closing
from pathlib import Path
from unittest.mock import patch

import pytest
from fake_runs import contents, run_with_fakes, snapshot

from scenarios import save_scenarios
from suite.experiment.experiment import Experiment
from suite.store.run_folder import DERIVED, STAMP


def no_scenarios(experiment: Experiment) -> None:
    raise AssertionError("scenarios were drawn")


@pytest.fixture
def finished(tmp_path: Path) -> Path:
    run_with_fakes(tmp_path / "run")
    return tmp_path / "run"


def test_a_finished_run_is_left_alone(finished: Path) -> None:
    before = snapshot(finished)
    with patch.object(Experiment, "scenarios", no_scenarios):
        assert run_with_fakes(finished) == []
    assert snapshot(finished) == before


@pytest.mark.parametrize("name", [*DERIVED, "manifest.json"])
def test_a_file_that_was_touched_is_made_again(finished: Path, name: str) -> None:
    whole = contents(finished)
    text = (finished / name).read_text()
    (finished / name).write_text(text.replace("1", "2", 1) if name in DERIVED else '{"experiment": {}}')
    assert run_with_fakes(finished) == []
    assert contents(finished) == whole
    assert (finished / name).read_text() == text


def test_files_that_were_deleted_are_made_again(finished: Path) -> None:
    whole, names = contents(finished), snapshot(finished).keys()
    for name in (*DERIVED, "manifest.json", STAMP):
        (finished / name).unlink()
    assert run_with_fakes(finished) == []
    assert contents(finished) == whole
    assert snapshot(finished).keys() == names
    with patch.object(Experiment, "scenarios", no_scenarios):
        assert run_with_fakes(finished) == []


@pytest.mark.parametrize("text", ["", "[" * 9_000, "9" * 20_000])
def test_a_stamp_of_anything_else_is_no_stamp(finished: Path, text: str) -> None:
    (finished / STAMP).write_text(text)
    assert run_with_fakes(finished) == []
    assert json.loads((finished / STAMP).read_text())["asked"]


def test_a_row_that_is_gone_is_run_again(finished: Path) -> None:
    with closing(sqlite3.connect(finished / "run.db", isolation_level=None)) as db:
        db.execute("DELETE FROM trials WHERE number = 3")
    assert len(run_with_fakes(finished)) == 1


def test_a_journal_that_is_gone_is_made_again(finished: Path) -> None:
    (finished / "run.db").unlink()
    assert len(run_with_fakes(finished)) == 16


@pytest.mark.parametrize("change", [{"seed": 6}, {"trials": 3}, {"planners": ("rrt", "pf")}, {"dropout": 0.1}])
def test_another_experiment_is_not_taken_for_finished(finished: Path, change: dict[str, object]) -> None:
    run_with_fakes(finished, **change)
    (finished.parent / "alone").mkdir()
    run_with_fakes(finished.parent / "alone" / "run", **change)
    assert contents(finished) == contents(finished.parent / "alone" / "run")


def test_other_code_is_not_taken_for_finished(finished: Path) -> None:
    assert run_with_fakes(finished, codes={"pf": "edited"}) == ["pf"] * 8


def test_an_edited_scenario_file_is_read_again(tmp_path: Path) -> None:
    from fakes import make_scenario

    file = tmp_path / "mine.json"
    fields = {"scenario_files": (str(file),), "planners": ("pf",)}
    save_scenarios(file, [make_scenario(1)])
    assert len(run_with_fakes(tmp_path / "run", **fields)) == 1
    save_scenarios(file, [make_scenario(1), make_scenario(2)])
    assert len(run_with_fakes(tmp_path / "run", **fields)) == 1
