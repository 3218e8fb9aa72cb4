"""``import suite``: the rows of the command line, in a notebook, from stdin and in a script without a main guard."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import suite
from planners import ArmPlanner, TimedPath
from scenarios import generate
from suite.errors import SuiteError
from suite.trial.columns import TIMING_NAMES

ROOT = Path(__file__).resolve().parents[2]


class Still(ArmPlanner):
    """Stands still."""

    def search(self, q, now_s, stop):
        return TimedPath(np.array([now_s, now_s + 1.0]), np.stack([q, q]))


def python(arguments: list[str], folder: Path, stdin: str | None = None) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, *arguments],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        input=stdin,
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )


def untimed(row: dict[str, object]) -> dict[str, object]:
    return {name: value for name, value in row.items() if name not in TIMING_NAMES}


@pytest.fixture(scope="module")
def small_run(tmp_path_factory) -> suite.Run:
    folder = tmp_path_factory.mktemp("api") / "run"
    return suite.run("pf,t2", obstacles=(0, 1), trials=2, seed=1001, out=folder)


def test_a_run_is_read_from_python(small_run) -> None:
    assert len(small_run.trials) == 8
    assert list(small_run.table()["planner"]) == ["pf", "t2", "pf", "t2"]
    assert "pf" in small_run._repr_html_()
    assert "8 trials" in repr(small_run)
    assert suite.load(small_run.folder).trials.equals(small_run.trials)


def test_limits_hold_in_worker_processes(tmp_path) -> None:
    file = tmp_path / "hog.py"
    file.write_text(
        "import time, numpy as np\n"
        "from planners import ArmPlanner, TimedPath\n"
        "class Hog(ArmPlanner):\n"
        '    """Fills a gigabyte."""\n'
        "    def search(self, q, now_s, stop):\n"
        "        self.held = np.ones(2**27)\n"
        "        time.sleep(2)\n"
        "        return TimedPath(np.array([now_s, now_s + 1.0]), np.stack([q, q]))\n"
    )
    made = suite.run(
        f"{file}:Hog", obstacles=(0,), trials=1, seed=1001, out=tmp_path / "run", processes=1, memory_limit_mb=200.0
    )
    assert list(made.trials["outcome"]) == ["planner_memory"]


def test_a_trajectory_of_a_run_is_judged_as_in_its_row(small_run) -> None:
    for row in small_run.trials.to_dict("records"):
        scenario = small_run.scenario(row["scenario_id"])
        executed = small_run.trajectory(row["scenario_id"], row["planner"])
        for engine in ("certificate", "fcl"):
            judged = suite.audit(scenario, executed.times_s, executed.configurations_rad, engine)
            assert judged.swept.success == row["success_swept"]


def test_a_trial_alone_is_the_trial_of_the_run(small_run) -> None:
    row = small_run.trials.iloc[-1]
    result = suite.run_trial(small_run.scenario(row["scenario_id"]), row["planner"], seed=1001)
    for name in ("outcome", "trial_seed", "n_solves", "success_swept"):
        assert result.row[name] == row[name], name
    assert result.row["arrival_time_s"] == pytest.approx(row["arrival_time_s"])


def test_what_is_not_there_is_one_line(small_run, tmp_path) -> None:
    for ask in (
        lambda: small_run.scenario("nothing"),
        lambda: small_run.trajectory("nothing", "pf"),
        lambda: suite.load(tmp_path),
        lambda: suite.run("pf", trials=0, out=tmp_path / "run"),
        lambda: suite.run((), out=tmp_path / "run"),
        lambda: suite.run([Still], processes=2, out=tmp_path / "run"),
    ):
        with pytest.raises(SuiteError) as caught:
            ask()
        assert len(str(caught.value).splitlines()) == 1
    assert not (tmp_path / "run").exists()


def test_one_solve(small_run) -> None:
    scenario = generate("orbit", 1, 1, 1001)[0]
    plan = suite.plan(scenario, "rrt[iterations=300]")
    again = suite.plan(scenario, "rrt[iterations=300]")
    np.testing.assert_array_equal(plan.configurations_rad, again.configurations_rad)
    assert plan.times_s[0] == 0.0


def test_a_class_is_a_planner(tmp_path) -> None:
    scenario = generate("orbit", 0, 1, 1001)[0]
    assert suite.run_trial(scenario, Still).row["outcome"] == "stuck"
    run = suite.run([Still, "pf"], obstacles=(0,), trials=1, seed=1001, out=tmp_path / "run")
    assert list(run.trials["planner"]) == ["Still", "pf"]
    assert list(run.trials["outcome"]) == ["stuck", "reached"]


SCRIPT = """
import suite
run = suite.run("pf,t2", obstacles=(0,), trials=2, seed=1001, out="run", processes={processes})
print(len(run.trials), "rows,", list(run.table()["planner"]))
"""


@pytest.mark.parametrize("processes", [0, 2])
def test_a_script_without_a_main_guard(tmp_path, processes: int) -> None:
    (tmp_path / "script.py").write_text(SCRIPT.format(processes=processes))
    done = python(["script.py"], tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines() == ["4 rows, ['pf', 't2']"]


@pytest.mark.parametrize("processes", [0, 2])
def test_from_standard_input(tmp_path, processes: int) -> None:
    done = python(["-"], tmp_path, SCRIPT.format(processes=processes))
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines() == ["4 rows, ['pf', 't2']"]


@pytest.mark.parametrize("package", ["planners", "scenarios"])
@pytest.mark.parametrize("shadow", ["{}.py", "{}/__init__.py"])
def test_a_folder_that_hides_a_package_is_named_in_one_line(tmp_path, package: str, shadow: str) -> None:
    file = tmp_path / shadow.format(package)
    file.parent.mkdir(exist_ok=True)
    file.write_text("")
    done = python(["-c", "import suite"], tmp_path)
    assert done.stderr.splitlines()[-1].startswith(f"ImportError: package '{package}': found ")
    assert str(file) in done.stderr.splitlines()[-1]
    done = python(["-m", "suite", "version"], tmp_path)
    assert done.returncode == 1
    (line,) = done.stderr.splitlines()
    assert line.startswith(f"suite: error: package '{package}': found ")


def test_importing_suite_imports_nothing_heavy(tmp_path) -> None:
    check = (
        "import suite, sys; print([m for m in ('numba', 'pandas', 'ompl', 'scipy', 'pydantic') if m in sys.modules])"
    )
    assert python(["-c", check], tmp_path).stdout.strip() == "[]"
    assert "run" in dir(suite)
