"""What ``suite run --dry-run`` says."""

from pathlib import Path
from unittest.mock import patch

import pytest
from fake_runs import SOURCES, run_with_fakes, snapshot

from suite.cli.main import main
from suite.experiment.experiment import make_experiment
from suite.foresight import DEFAULT_TRIAL_S, Foresight, foresee
from suite.store.run_folder import read_trials

FIELDS = {"planners": ("pf", "rrt"), "obstacles": (0, 1), "trials": 4, "seed": 5}


def look(folder: Path, **changes: object) -> Foresight:
    with patch("suite.experiment.code.source_hash", return_value=SOURCES):
        return foresee(make_experiment(**FIELDS | changes), folder, 2, fresh=False, keep_stale=False)


def test_an_empty_folder_is_guessed_at_and_not_made(tmp_path) -> None:
    found = look(tmp_path / "run")
    assert (found.trials, found.there, found.guessed) == (16, 0, 16)
    assert found.seconds == 16 * DEFAULT_TRIAL_S / 2
    assert found.lines(2)[-1] == "about 16 s with 2 workers, from 2 s a trial: none has run here yet"
    assert not (tmp_path / "run").exists()


@pytest.mark.parametrize(
    "changes", [{}, {"trials": 6}, {"noise_mm": (0, 1)}, {"planners": ("pf", "pf[repulsion=0]", "t2")}]
)
def test_it_says_what_a_run_then_does(tmp_path, changes: dict[str, object]) -> None:
    run_with_fakes(tmp_path)
    before = snapshot(tmp_path)
    found = look(tmp_path, **changes)
    assert snapshot(tmp_path) == before
    ran = run_with_fakes(tmp_path, **changes)
    assert found.trials == len(read_trials(tmp_path))
    assert found.trials - found.there == len(ran)


def test_time_is_what_such_trials_took(tmp_path) -> None:
    run_with_fakes(tmp_path)
    trials = read_trials(tmp_path)
    trials["trial_wall_s"] = trials["planner"].map({"pf": 3.0, "rrt": 10.0})
    with patch("suite.foresight.read_trials", return_value=trials):
        found = look(tmp_path, trials=6, planners=("pf", "rrt[range=1]", "t2"))
    assert found.seconds == (4 * 3.0 + 12 * 10.0 + 12 * DEFAULT_TRIAL_S) / 2
    assert found.guessed == 12
    assert "12 of them at 2 s each" in found.lines(2)[-1]


def test_the_command_line_makes_nothing(tmp_path, monkeypatch, capfd) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["run", "--planners", "pf", "--obstacles", "1..10", "--noise-mm", "0,1,2,5", "--dry-run"]) == 0
    out, err = capfd.readouterr()
    assert "400 trials, 0 of them there already, 400 to run" in out.splitlines()
    assert err == ""
    assert list(tmp_path.iterdir()) == []
