"""The planner to start from: what is written, what is refused, and that it plans."""

import signal
import subprocess
import sys

import pytest

from planners import PlannerSpec, parse_planner
from planners.conformance.scenes import observe, problem_of, scenes, session_of
from scenarios import ContinuumArm, generate
from suite.cli.main import main
from suite.conformance import Check, parametrize_with_checks
from suite.scaffold import class_name
from suite.scaffold.new_planner import NewPlanner
from suite.trial.episode import run_trial
from suite.trial.task import TrialTask


@pytest.fixture
def _in_an_empty_folder(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", list(sys.path))  # planners from files add their folders
    signals = signal.getsignal(signal.SIGTERM)
    yield
    signal.signal(signal.SIGTERM, signals)


@parametrize_with_checks([NewPlanner])
def test_conformance(planner: PlannerSpec, check: Check) -> None:
    check(planner)


ARMS = {"three sections": ContinuumArm(), "two sections": ContinuumArm(n_sections=2, section_length_m=0.2)}


@pytest.mark.parametrize("arm", ARMS)
def test_it_reaches_every_goal_among_no_obstacles(arm: str) -> None:
    spec = parse_planner("suite.scaffold.new_planner:NewPlanner")
    for scenario in generate("orbit", 0, 20, 0, ARMS[arm]):
        row = run_trial(TrialTask(scenario, spec, predictor=spec.predictor, limits=False, seed=0)).row
        assert row["outcome"] == "reached", scenario.id
        assert row["success_executable"], scenario.id


def test_where_no_way_is_free_it_takes_what_is_free_of_one() -> None:
    spec, scenario = parse_planner("suite.scaffold.new_planner:NewPlanner"), scenes()["moving obstacles"]
    plan = session_of(spec, scenario).plan(scenario.start, 0.0, observe(scenario))
    assert plan.status == "Approximate solution"
    check = problem_of(spec, scenario, False).validator.check
    path, times = plan.configurations_rad, plan.times_s
    assert all(check(path[k], times[k], path[k + 1], times[k + 1]) for k in range(len(times) - 1))


@pytest.mark.usefixtures("_in_an_empty_folder")
@pytest.mark.parametrize(("name", "written"), [("mine", "Mine"), ("my_2nd_planner", "My2ndPlanner")])
def test_a_planner_and_its_test_are_written(name: str, written: str, tmp_path, capfd) -> None:
    assert class_name(name) == written
    assert main(["new-planner", name]) == 0
    out = capfd.readouterr().out
    assert f"suite check-planner ./{name}.py:{written}\n" in out
    assert f"suite run --planners ./{name}.py:{written},rrt" in out
    assert sorted(file.name for file in tmp_path.iterdir()) == sorted([f"{name}.py", f"test_{name}.py"])
    text = (tmp_path / f"{name}.py").read_text() + (tmp_path / f"test_{name}.py").read_text()
    assert "new_planner" not in text
    assert "NewPlanner" not in text
    assert f"from {name} import {written}\n" in text
    spec = parse_planner(f"{name}.py:{written}[speed=0.5]")
    assert (spec.label, spec.settings.speed) == (f"{written}[speed=0.5]", 0.5)
    before = text
    assert main(["new-planner", name]) == 2
    assert f"{name}.py: found a file there" in capfd.readouterr().err
    assert (tmp_path / f"{name}.py").read_text() + (tmp_path / f"test_{name}.py").read_text() == before


@pytest.mark.usefixtures("_in_an_empty_folder")
def test_the_test_that_is_written_runs(tmp_path) -> None:
    assert main(["new-planner", "mine"]) == 0
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-k", "settings or finite or process"]
    done = subprocess.run([*command, "test_mine.py"], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert "3 passed" in done.stdout, done.stdout


BAD_NAMES = ["Mine", "1st", "my-planner", "mine.py", "a/b", "", "class", "_", "__init__", "ü", "a" * 41, "x\n", "x_"]


@pytest.mark.usefixtures("_in_an_empty_folder")
@pytest.mark.parametrize("name", [*BAD_NAMES, "numpy", "planners", "random", "suite"])
def test_other_names_are_refused_in_a_line(name: str, tmp_path, capfd) -> None:
    assert main(["new-planner", "--", name]) == 2
    out, err = capfd.readouterr()
    assert (out, err.count("\n")) == ("", 1)
    assert "name: found" in err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.usefixtures("_in_an_empty_folder")
def test_a_test_that_is_there_is_kept(tmp_path, capfd) -> None:
    (tmp_path / "test_mine.py").write_text("mine")
    assert main(["new-planner", "mine"]) == 2
    assert "test_mine.py: found a file there" in capfd.readouterr().err
    assert [file.name for file in tmp_path.iterdir()] == ["test_mine.py"]


@pytest.mark.usefixtures("_in_an_empty_folder")
def test_a_folder_that_cannot_be_written_to_is_one_line(tmp_path, monkeypatch, capfd) -> None:
    monkeypatch.chdir("/proc")
    assert main(["new-planner", "mine"]) == 2
    assert capfd.readouterr().err.count("\n") == 1
