import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
import yaml
from fake_runs import run_with_fakes

import suite
from suite.cli.main import main

ROOT = Path(__file__).parents[3]
WORKFLOW = ROOT / "docs" / "examples" / ".github" / "workflows" / "planner.yml"


@pytest.fixture(autouse=True)
def _in_an_empty_folder(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)


def edit_trials(folder: str, **columns: object) -> None:
    """Make a committed run of a folder, with only trials.csv, and with columns as said."""
    file = Path(folder, "trials.csv")
    suite.load(folder).trials.assign(**columns).to_csv(file, index=False)
    Path(folder, "run.db").unlink()


def test_a_run_and_the_same_committed_are_unchanged(tmp_path, capfd) -> None:
    run_with_fakes(tmp_path / "base")
    run_with_fakes(tmp_path / "new")
    edit_trials("new")
    assert main(["compare", "base", "new", "--verdict", "swept", "--strict"]) == 0
    out, _ = capfd.readouterr()
    assert out.endswith("No regression.\n")


def test_exit_codes(tmp_path, capfd) -> None:
    run_with_fakes(tmp_path / "base", trials=40)
    run_with_fakes(tmp_path / "new", trials=40)
    run_with_fakes(tmp_path / "other", trials=2, seed=9)
    capfd.readouterr()
    verdict = ["--verdict", "per_step"]
    assert main(["compare", "base", "other", *verdict]) == 3
    out, err = capfd.readouterr()
    assert out == ""
    assert "not in NEW" in err
    assert "found no pair of trials" in err.splitlines()[-1]
    edit_trials("new", success_per_step=False)
    assert main(["compare", "base", "new", *verdict, "--format", "json"]) == 1
    said = json.loads(capfd.readouterr().out)
    assert said["counts"]["regression"] == 2
    assert said["bar"] == {"margin": 5.0, "alpha": 0.05, "cost_margin": 10.0, "verdict": "per_step", "across": []}
    assert main(["compare", "new", "base", *verdict]) == 0
    run_with_fakes(tmp_path / "few")
    edit_trials("few", message="differs")
    assert main(["compare", "base", "few", *verdict]) == 0
    assert main(["compare", "base", "few", *verdict, "--strict"]) == 4


@pytest.mark.parametrize(
    "arguments", ["base nowhere", "base base --margin 0", "base base --alpha 0.9", "base base --across colour", "base"]
)
def test_a_mistake_is_one_line_and_exit_2(arguments: str, tmp_path, capfd) -> None:
    run_with_fakes(tmp_path / "base", trials=1)
    capfd.readouterr()
    assert main(["compare", *arguments.split()]) == 2
    out, err = capfd.readouterr()
    assert (out, err.count("\n")) == ("", 1)


def test_python_says_the_same(tmp_path) -> None:
    run_with_fakes(tmp_path / "run")
    run = suite.load("run")
    assert set(run.compare(run, verdict="swept").frame["judgement"]) == {"unchanged", "not judged"}


def test_every_step_of_the_workflow_runs(tmp_path) -> None:
    workflow = yaml.safe_load(WORKFLOW.read_text(encoding="utf-8"))
    steps = [step for step in workflow["jobs"]["compare"]["steps"] if "run" in step and step["name"] != "Install"]
    assert [step["name"] for step in steps] == ["Run the planner as it was", "Run the planner as it is", "Compare"]
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin" / "suite").write_text(f'#!/bin/sh\nexec {sys.executable} -P -m suite "$@"\n')
    (tmp_path / "bin" / "suite").chmod(0o755)
    places = {"PATH": f"{tmp_path / 'bin'}:{os.environ['PATH']}", "PYTHONPATH": str(ROOT)}
    given = {
        "PLANNER": workflow["env"]["PLANNER"],
        "CONDITIONS": workflow["env"]["CONDITIONS"].replace("1,3,5,6", "0").replace("100", "2") + " --workers 1",
        "BASE_REF": "main",
        "RUNS": str(tmp_path / "runs"),
        "GITHUB_STEP_SUMMARY": str(tmp_path / "summary.md"),
    }
    environment = os.environ | places | given
    mine = tmp_path / "repository"
    mine.mkdir()

    def bash(code: str) -> None:
        done = subprocess.run(
            ["bash", "-eo", "pipefail", "-c", code],
            cwd=mine,
            env=environment,
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stdout + done.stderr

    commit = "git add . && git -c user.name=me -c user.email=me@here commit --quiet -m"
    bash(f"git init --quiet -b main && suite new-planner mine && {commit} one && git checkout --quiet -b change")
    bash(f"echo '# another line' >> mine.py && {commit} two")
    for step in steps:
        bash(step["run"])
    assert "No regression" in (tmp_path / "summary.md").read_text()
