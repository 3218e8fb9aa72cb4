import json
import sqlite3
from collections import Counter
from pathlib import Path
from unittest.mock import patch

import pandas as pd
import pytest
from fake_runs import SOURCES, contents, killed_run, run_with_fakes, snapshot
from fakes import make_tasks
from hypothesis import given
from hypothesis import strategies as st

from suite.errors import SuiteError
from suite.store.growth import settle
from suite.store.run_folder import read_trials
from suite.trial.task import Code, TrialTask

EDITED = {"pf": "edited"}


def rows_ever(folder: Path) -> int:
    with sqlite3.connect(folder / "run.db") as db:
        (count,) = db.execute("SELECT count(*) FROM trials").fetchone()
    db.close()
    return int(count)


@pytest.mark.parametrize(
    ("changes", "new"),
    [
        ({"trials": 6}, 8),
        ({"planners": ("pf", "rrt", "t2")}, 8),
        ({"planners": ("rrt", "pf")}, 0),
        ({"obstacles": (0, 1, 2)}, 8),
        ({"obstacles": (2, 0), "trials": 5, "planners": ("t2", "rrt")}, 16),
        ({"noise_mm": (0, 2)}, 16),
        ({"family": "orbit,orbit[max_speed_m_s=0.01|0.03]", "limits": (False, True)}, 80),
        ({"arm": ("", "radius_m=0.01"), "seed": (5, 6)}, 48),
        ({"margin": (None, 2.0)}, 16),
    ],
)
def test_a_run_grows_by_what_is_new_and_ends_like_an_unbroken_one(tmp_path, changes: dict, new: int) -> None:
    run_with_fakes(tmp_path / "grown")
    index = ["scenario_id", "planner", "limits", "noise_mm", "prediction_margin"]
    before = read_trials(tmp_path / "grown").set_index(index)
    assert len(run_with_fakes(tmp_path / "grown", **changes)) == new
    run_with_fakes(tmp_path / "unbroken", **changes)
    assert contents(tmp_path / "grown") == contents(tmp_path / "unbroken")
    manifests = [json.loads((tmp_path / name / "manifest.json").read_text()) for name in ("grown", "unbroken")]
    assert manifests[0] == manifests[1]  # the effective configuration of the latest command
    after = read_trials(tmp_path / "grown").set_index(index)
    assert after.index.is_unique
    kept = before.index.intersection(after.index)
    assert len(kept) == len(after) - new
    pd.testing.assert_frame_equal(before.loc[kept], after.loc[kept])  # timings too
    assert rows_ever(tmp_path / "grown") == 16 + new


def test_what_is_no_longer_asked_for_is_kept_out_of_tables_and_not_lost(tmp_path) -> None:
    run_with_fakes(tmp_path)
    assert run_with_fakes(tmp_path, planners=("rrt",), trials=2) == []
    assert read_trials(tmp_path)["planner"].tolist() == ["rrt"] * 4
    assert run_with_fakes(tmp_path) == []
    assert len(read_trials(tmp_path)) == 16


@pytest.mark.parametrize("change", [{"seed": 6}, {"noise_mm": 2.0}, {"limits": True}, {"predictor": "arc"}])
def test_another_condition_is_another_row(tmp_path, change: dict[str, object]) -> None:
    run_with_fakes(tmp_path)
    assert len(run_with_fakes(tmp_path, **change)) == 16
    assert len(read_trials(tmp_path)) == 16
    assert run_with_fakes(tmp_path) == []
    assert rows_ever(tmp_path) == 32


def test_a_predictor_that_a_planner_has_anyway_is_no_other_condition(tmp_path) -> None:
    run_with_fakes(tmp_path, planners=("pf", "rrt"))
    assert run_with_fakes(tmp_path, predictor="cubic") == ["rrt"] * 8


def test_an_edited_planner_runs_again_alone_and_its_old_rows_stay(tmp_path, capfd) -> None:
    run_with_fakes(tmp_path / "edited")
    capfd.readouterr()
    assert run_with_fakes(tmp_path / "edited", codes=EDITED) == ["pf"] * 8
    note = "suite: pf: its code has changed; its 8 rows of before are stale and run again"
    assert note in capfd.readouterr().err.splitlines()
    assert rows_ever(tmp_path / "edited") == 24
    run_with_fakes(tmp_path / "unbroken", codes=EDITED)
    assert contents(tmp_path / "edited") == contents(tmp_path / "unbroken")
    trials = read_trials(tmp_path / "edited")
    assert Counter(zip(trials["planner"], trials["planner_code"] == "edited", strict=True)) == {
        ("pf", True): 8,
        ("rrt", False): 8,
    }
    assert run_with_fakes(tmp_path / "edited", codes=EDITED, trials=5) == ["pf"] * 2 + ["rrt"] * 2
    assert run_with_fakes(tmp_path / "edited") == []  # the edit undone: its rows of then are there


def test_an_interrupted_run_of_stale_rows_goes_on(tmp_path) -> None:
    run_with_fakes(tmp_path / "broken")
    killed_run(tmp_path / "broken", codes=EDITED, trials=6, die_after=3)
    trials = read_trials(tmp_path / "broken")
    assert set(trials[trials["planner"] == "pf"]["planner_code"]) <= {"edited"}  # no stale row among them
    assert len(run_with_fakes(tmp_path / "broken", codes=EDITED, trials=6)) == 12 + 4 - 3
    run_with_fakes(tmp_path / "unbroken", codes=EDITED, trials=6)
    assert contents(tmp_path / "broken") == contents(tmp_path / "unbroken")


def test_a_changed_house_is_for_the_user_to_decide_about(tmp_path, capfd) -> None:
    run_with_fakes(tmp_path)
    before = snapshot(tmp_path)
    with pytest.raises(SuiteError) as caught:
        run_with_fakes(tmp_path, sources="1" * 16, trials=5)
    assert str(caught.value) == (
        f"{tmp_path}: 16 of 20 trials were run by another version of the suite (the sources have changed);"
        " start over with --fresh, or use them as they are with --keep-stale"
    )
    assert snapshot(tmp_path) == before

    capfd.readouterr()
    assert len(run_with_fakes(tmp_path, sources="1" * 16, trials=5, keep_stale=True)) == 4
    assert "suite: 16 rows made by other code are used as they are" in capfd.readouterr().err
    table = pd.read_csv(tmp_path / "table.csv")
    assert table["stale"].tolist() == [4] * 4
    assert "| stale " in (tmp_path / "table.md").read_text()

    with pytest.raises(SuiteError, match="16 of 20 trials"):  # asked anew: it is not forgotten
        run_with_fakes(tmp_path, sources="1" * 16, trials=5)
    assert len(run_with_fakes(tmp_path, sources="1" * 16, fresh=True)) == 16
    assert pd.read_csv(tmp_path / "table.csv")["stale"].sum() == 0
    assert rows_ever(tmp_path) == 16


def test_another_version_of_a_library_is_another_house(tmp_path) -> None:
    run_with_fakes(tmp_path)
    with (
        patch("suite.experiment.code.versions", return_value={"numpy": "9.9"}),
        pytest.raises(SuiteError, match=r"\(numba [0-9.]+ there, None here; numpy [0-9.]+ there, 9\.9 here; ompl"),
    ):
        run_with_fakes(tmp_path)


def test_rows_of_an_edited_planner_can_be_kept_too(tmp_path) -> None:
    run_with_fakes(tmp_path)
    assert run_with_fakes(tmp_path, codes=EDITED, keep_stale=True) == []
    table = pd.read_csv(tmp_path / "table.csv").set_index("planner")
    assert table.loc["pf", "stale"].tolist() == [4, 4]
    assert table.loc["rrt", "stale"].tolist() == [0, 0]
    assert run_with_fakes(tmp_path, codes=EDITED) == ["pf"] * 8


def test_a_run_may_go_on_on_another_machine(tmp_path) -> None:
    run_with_fakes(tmp_path)
    with patch("os.cpu_count", return_value=4711):
        assert run_with_fakes(tmp_path, sources=SOURCES) == []


codes = st.builds(Code, st.sampled_from("AB"), st.sampled_from("xyz"))


@given(st.lists(st.lists(codes, unique=True, max_size=4), min_size=1, max_size=6), codes, st.booleans())
def test_every_trial_is_there_missing_stale_or_kept(made: list[list[Code]], present: Code, keep_stale: bool) -> None:
    named = make_tasks([f"p{k}" for k in range(len(made))])
    tasks = [TrialTask(t.scenario, t.spec, t.predictor, t.limits, t.seed, code=present) for t in named]
    standing = settle(tasks, dict(zip([t.key for t in tasks], made, strict=True)), keep_stale=keep_stale)
    assert list(standing.chosen) == [task.key for task in tasks]
    for task, codes in zip(tasks, made, strict=True):
        chosen = standing.chosen[task.key]
        if present in codes or not (codes and keep_stale):
            assert chosen == present
        else:
            assert chosen == codes[-1]
    ours = [codes for codes in made if present not in codes]
    others = [codes for codes in ours if codes]
    near = [codes for codes in others if present.house in {code.house for code in codes}]
    assert standing.there == len(made) - len(ours) + (len(others) if keep_stale else 0)
    assert standing.kept == (len(others) if keep_stale else 0)
    assert standing.stale.total() == (0 if keep_stale else len(near))
    assert standing.other_houses.total() == (0 if keep_stale else len(others) - len(near))
