import json
import shutil
import sqlite3
from pathlib import Path

import pytest
from fake_runs import contents, killed_run, run_with_fakes, snapshot

import suite
from suite.cli.main import main
from suite.errors import SuiteError
from suite.experiment.file import preset_fields


@pytest.fixture(autouse=True)
def _in_an_empty_folder(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)


def edit(folder: str, statement: str) -> None:
    db = sqlite3.connect(Path(folder, "run.db"))
    with db:
        db.execute(statement)
    db.close()


def test_planners_put_together_are_the_run_of_both() -> None:
    run_with_fakes(Path("one"), planners=("pf",))
    run_with_fakes(Path("two"), planners=("rrt",), trials=6)
    run_with_fakes(Path("both"), planners=("pf", "rrt"), trials=4)
    run_with_fakes(Path("both-6"), planners=("rrt",), trials=6)
    before = snapshot(Path("one")), snapshot(Path("two"))
    suite.merge(["one", "two"], "merged")
    assert (snapshot(Path("one")), snapshot(Path("two"))) == before
    merged = suite.load("merged")
    assert len(merged.trials) == 8 + 12
    run_with_fakes(Path("merged-again"), planners=("pf", "rrt"), trials=6)
    assert preset_fields("merged/manifest.json") == preset_fields("merged-again/manifest.json")
    assert run_with_fakes(Path("merged"), planners=("pf", "rrt"), trials=6) == ["pf"] * 4  # what is missing, no more
    assert contents(Path("merged")) == contents(Path("merged-again"))


def test_seeds_stay_apart_and_scenarios_come_along() -> None:
    for seed in (1, 2):
        run_with_fakes(Path(f"seed-{seed}"), seed=seed, trials=2)
    merged = suite.merge(["seed-1", "seed-2"], "merged")
    assert set(merged.trials["experiment_seed"]) == {1, 2}
    for name in merged.trials["scenario_id"].unique():
        assert merged.scenario(name).content_hash in set(merged.trials["scenario_hash"])
    manifest = json.loads(Path("merged", "manifest.json").read_text())
    assert manifest["experiment"]["seed"] == [1, 2]
    assert [part["experiment"]["seed"] for part in manifest["merged"]] == [1, 2]
    assert run_with_fakes(Path("merged"), seed=[1, 2], trials=2) == []  # nothing is missing
    assert len(merged.trajectory(merged.trials["scenario_id"][0], "pf").times_s) == 3


def test_runs_that_no_experiment_asks_for_have_none() -> None:
    run_with_fakes(Path("one"), seed=1, trials=1)
    run_with_fakes(Path("two"), seed=2, trials=1, noise_mm=3.0)
    suite.merge(["one", "two"], "merged")
    assert json.loads(Path("merged", "manifest.json").read_text())["experiment"] == {}
    assert len(suite.load("merged").table()) == 8


def test_the_same_run_from_two_machines_is_one(capfd) -> None:
    run_with_fakes(Path("here"))
    run_with_fakes(Path("there"), where=2)  # other timings, in another order
    suite.merge(["here", "there"], "merged")
    assert contents(Path("merged")) == contents(Path("here"))
    assert "there: found no trial that the runs named before do not have" in capfd.readouterr().err


def test_a_conflict_is_named_and_nothing_written(capfd) -> None:
    run_with_fakes(Path("here"), trials=2)
    run_with_fakes(Path("there"), trials=2)
    edit("there", "UPDATE trials SET arrival_time_s = 77 WHERE planner = 'rrt' AND scenario_id LIKE '%n1%0001'")
    assert main(["merge", "here", "there", "--out", "merged"]) == 2
    line = capfd.readouterr().err.splitlines()[-1]
    assert "found 1 trials with different rows by the same code: orbit-n1-s5-0001, rrt: here and there differ" in line
    assert sorted(path.name for path in Path().iterdir()) == ["here", "there"]
    assert main(["merge", "here", "there", "--out", "merged", "--keep-first"]) == 0
    assert contents(Path("merged")) == contents(Path("here"))
    assert main(["merge", "there", "here", "--out", "other", "--keep-first"]) == 0
    assert 77 in set(suite.load("other").trials["arrival_time_s"])


def test_code_differences_are_said_and_the_last_stands(capfd) -> None:
    run_with_fakes(Path("old"), sources="1" * 16, trials=3)
    run_with_fakes(Path("new"), trials=2)
    merged = suite.merge(["old", "new"], "merged")
    said = capfd.readouterr().err
    assert "pf: 2 of 6 trials were run by other code (the sources have changed)" in said
    assert "8 trials were run by several codes: the rows of the run named last stand" in said
    assert merged.trials.groupby("house_code").size().tolist() in ([4, 8], [8, 4])
    assert merged.table()["stale"].sum() == 4


def test_a_run_that_was_killed_is_merged_as_far_as_it_came() -> None:
    killed_run(Path("killed"), die_after=5)
    before = {name: data for name, (data, _) in snapshot(Path("killed")).items() if not name.endswith("-shm")}
    merged = suite.merge(["killed"], "merged")
    after = {name: data for name, (data, _) in snapshot(Path("killed")).items() if not name.endswith("-shm")}
    assert after == before
    assert len(merged.trials) == 5
    assert merged.scenario(merged.trials["scenario_id"][0]).family == "orbit"  # drawn anew: no file was written


def test_what_can_be_read_of_a_damaged_journal_is_saved(capfd) -> None:
    run_with_fakes(Path("run"), trials=40)
    whole = suite.load("run").trials.set_index(["scenario_id", "planner"])
    shutil.copytree("run", "broken")
    file = Path("broken", "run.db")
    data = bytearray(file.read_bytes())
    middle = len(data) // 2 // 4096 * 4096
    data[middle : middle + 4096] = b"\xff" * 4096
    file.write_bytes(data)
    with pytest.raises(SuiteError):
        suite.load("broken")
    saved = suite.merge(["broken"], "saved").trials.set_index(["scenario_id", "planner"])
    assert "damaged; " in capfd.readouterr().err
    assert 100 < len(saved) < len(whole) == 160
    assert saved["arrival_time_s"].equals(whole["arrival_time_s"].loc[saved.index])
    assert len(suite.merge(["broken", "run"], "healed").trials) == len(whole)


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        ("run nowhere --out new", "nowhere: found no run.db"),
        ("run run --out new", "run: found twice"),
        ("run --out run", "run: found something there"),
        ("run --out run/run.db", "run.db: found something there"),
        ("text --out new", "run.db: cannot be read: file is not a database"),
    ],
)
def test_a_mistake_is_one_line_and_nothing_made(arguments: str, named: str, capfd) -> None:
    run_with_fakes(Path("run"), trials=1)
    Path("text").mkdir()
    Path("text", "run.db").write_text("no journal")
    before = sorted(Path().rglob("*"))
    capfd.readouterr()
    assert main(["merge", *arguments.split()]) == 2
    out, err = capfd.readouterr()
    assert (out, err.count("\n")) == ("", 1)
    assert named in err
    assert sorted(Path().rglob("*")) == before
