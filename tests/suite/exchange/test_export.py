import sqlite3
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import yaml
from fake_runs import run_with_fakes

import suite
from scenarios import ContinuumArm
from suite.cli.main import main

# The columns with which Planner Arena and OMPL's own statistics expect each table to begin.
FIRST = {
    "experiments": [
        *("id", "name", "totaltime", "timelimit", "memorylimit", "runcount", "version", "hostname", "cpuinfo", "date"),
        *("seed", "setup", "n_obstacles"),
    ],
    "plannerConfigs": ["id", "name", "settings"],
    "enums": ["name", "value", "description"],
    "runs": ["id", "experimentid", "plannerid", "time", "status", "solved", "simplification_time"],
    "progress": ["runid", "time"],
}


@pytest.fixture(autouse=True)
def _a_run(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    run_with_fakes(Path("run"), planners=("pf", "rrt[range=3]"))


def export(*arguments: str) -> Path:
    assert main(["export", "run", *arguments]) == 0
    return Path(arguments[1])


def test_a_database_of_ompls_benchmarks_has_every_trial() -> None:
    db = sqlite3.connect(export("planner-arena", "arena.db"))
    for table, names in FIRST.items():
        found = [name for _, name, *_ in db.execute(f"PRAGMA table_info({table})")]
        assert found[: len(names)] == names
    trials = suite.load("run").trials
    runs = pd.read_sql_query(
        "SELECT e.name AS family, n_obstacles, p.name AS planner, r.* FROM runs r"
        " JOIN experiments e ON e.id = experimentid JOIN plannerConfigs p ON p.id = plannerid",
        db,
    )
    assert len(runs) == len(trials) == 16
    for column in ("arrival_time_s", "n_solves", "planning_time_s"):
        by = ["planner", "n_obstacles", column]
        found, expected = (frame.sort_values(by)[column].to_numpy(float, na_value=-1) for frame in (runs, trials))
        assert found == pytest.approx(expected)
    assert runs["solved"].sum() == (trials["outcome"] == "reached").sum()
    (settings,) = db.execute("SELECT settings FROM plannerConfigs WHERE name = 'rrt[range=3]'").fetchone()
    assert "range = 3.0\n;" in settings
    versions = {version for (version,) in db.execute("SELECT version FROM experiments")}
    assert all(version.startswith("suite ") for version in versions)
    db.close()


@pytest.mark.skipif(find_spec("plannerarena") is None, reason="plannerarena is not installed")
def test_planner_arenas_own_loader_opens_it() -> None:
    from plannerarena.database import load_database

    loaded = load_database(export("planner-arena", "arena.db"))
    assert loaded["problem_names"] == ["orbit"]
    assert loaded["parameters"] == ["n obstacles", "noise mm", "dropout", "limits"]
    assert loaded["runs"].shape[0] == 16
    assert loaded["attributes"][:4] == ["time", "status", "solved", "simplification time"]
    assert set(loaded["runs"]["planner"].unique().to_list()) == {"pf", "rrt[range=3]"}


ONE = ("--scenario", "orbit-n1-s5-0002", "--planner", "pf")


@pytest.mark.parametrize("joints", ["lengths", "bending"])
def test_a_motion_for_ros_holds_what_was_executed(joints: str) -> None:
    motion = suite.load("run").trajectory("orbit-n1-s5-0002", "pf")
    message = yaml.safe_load(export("ros", "motion.yaml", *ONE, "--joints", joints).read_text())
    assert set(message) == {"header", "joint_names", "points"}
    assert len(message["joint_names"]) == (9 if joints == "lengths" else 6)
    for k, point in enumerate(message["points"]):
        assert set(point) == {"positions", "velocities", "accelerations", "effort", "time_from_start"}
        assert point["time_from_start"] == {"sec": k, "nanosec": 0}
        q = point["positions"]
        if joints == "lengths":
            q = ContinuumArm().bending_from_lengths(np.array(q).reshape(3, 3))
        assert q == pytest.approx(motion.configurations_rad[k], abs=1e-9)


def test_points_are_the_backbone() -> None:
    motion = suite.load("run").trajectory("orbit-n1-s5-0002", "pf")
    with np.load(export("points", "motion.npz", *ONE), allow_pickle=False) as found:
        assert found["time_s"].tolist() == motion.times_s.tolist()
        assert found["points_m"].shape == (3, 61, 3)
        assert found["points_m"][:, -1] == pytest.approx(ContinuumArm().tips(motion.configurations_rad))
        assert found["radius_m"] == 0.018


def test_parquet_is_written_where_a_library_can(capfd) -> None:
    if find_spec("pyarrow") or find_spec("fastparquet"):
        assert len(pd.read_parquet(export("parquet", "trials.parquet"))) == 16
    else:
        assert main(["export", "run", "parquet", "trials.parquet"]) == 2
        assert "pip install pyarrow" in capfd.readouterr().err


@pytest.mark.parametrize(
    "arguments",
    [
        "nowhere planner-arena a.db",
        "run planner-arena no/such/a.db",
        "run planner-arena run/trials.csv",
        "run ros a.yaml",
        "run ros a.yaml --scenario orbit-n1-s5-0002",
        "run ros a.yaml --scenario orbit-n9 --planner pf",
        "run ros a.yaml --scenario orbit-n1-s5-0002 --planner t9",
        "run html a.html",
    ],
)
def test_a_mistake_is_one_line_and_nothing_written(arguments: str, capfd) -> None:
    capfd.readouterr()
    before = sorted(Path().rglob("*"))
    assert main(["export", *arguments.split()]) == 2
    out, err = capfd.readouterr()
    assert (out, err.count("\n")) == ("", 1)
    assert sorted(Path().rglob("*")) == before
