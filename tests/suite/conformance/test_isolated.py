"""Checks in a process of their own: whatever a planner does there, the others run and the line is one line."""

import json
import signal
from pathlib import Path

import pytest

from scenarios import SpecError
from suite.cli.main import main
from suite.conformance import CHECKS, Finding, run_checks

BROKEN_FILES = {
    "raises.py": ("import numpy\n\n1 / 0\n", "ZeroDivisionError: division by zero (raises.py:3)"),
    "syntax.py": ("x = 1\ndef\n", "SyntaxError: invalid syntax (syntax.py:2)"),
    "quits.py": ("import sys\nsys.exit('bye')\n", "SystemExit: bye (quits.py:2)"),
    "dies.py": ("import os\nos._exit(7)\n", "the process died: exit code 7"),
    "hangs.py": ("while True:\n    pass\n", "killed after 3 s"),
    "mute.py": (
        "class E(Exception):\n    def __str__(self):\n        raise E\n\nraise E\n",
        "E: <exception str() failed> (mute.py:5)",
    ),
}


@pytest.fixture(autouse=True)
def _in_an_empty_folder(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    signals = signal.getsignal(signal.SIGTERM)
    yield
    signal.signal(signal.SIGTERM, signals)


@pytest.mark.parametrize("file", BROKEN_FILES)
def test_a_planner_that_cannot_be_imported_is_one_line(file: str, tmp_path, capfd) -> None:
    text, line = BROKEN_FILES[file]
    (tmp_path / file).write_text(text)
    assert main(["check-planner", f"{file}:Mine", "--hang-limit-s", "3"]) == 1
    out, err = capfd.readouterr()
    first, found, last = out.splitlines()
    assert (first, last) == (f"{file}:Mine: conformance 1", "0 of 1 passed")
    assert found.startswith("  FAIL  import: ")
    assert found.endswith(line)
    assert "Traceback" not in err


@pytest.mark.parametrize(
    ("planner", "named"),
    [
        ("nope", "'nope'"),
        ("nope.py:Mine", "'nope.py'"),
        ("pf[gain", "'pf[gain'"),
        ("pf[gain=1]", "'gain'"),
        ("empty.py:Mine", "no class 'Mine'"),
        ("empty.py:list", "no class 'list'"),
        ("pf --hang-limit-s 0", "--hang-limit-s"),
    ],
)
def test_a_mistake_is_one_line_and_exit_2(planner: str, named: str, tmp_path, capfd) -> None:
    (tmp_path / "empty.py").write_text("")
    assert main(["check-planner", *planner.split()]) == 2
    out, err = capfd.readouterr()
    assert (out, err.count("\n")) == ("", 1)
    assert named in err


def hostile(folder: Path, **settings: bool) -> str:
    (folder / "mine.py").write_text("import offenders\n\n\nclass Mine(offenders.Hostile):\n    pass\n")
    return f"mine.py:Mine[{','.join(f'{key}={value}' for key, value in settings.items())}]"


def test_a_planner_that_dies_or_hangs_in_a_check_fails_that_check(tmp_path) -> None:
    findings = {finding.check: finding for finding in run_checks(hostile(tmp_path, die=True, hang=True), 20.0)}
    died = findings.pop("check_stops_when_its_budget_is_spent")
    hung = findings.pop("check_no_path_is_a_status")
    assert died == Finding(died.check, "died", "the process died: exit code 3")
    assert hung == Finding(hung.check, "hung", "killed after 20 s")
    assert len(findings) >= len(CHECKS) - 2
    assert {finding.outcome for finding in findings.values()} == {"ok"}


def test_findings_as_json_whatever_the_planner_prints(tmp_path, capfd) -> None:
    (tmp_path / "mine.py").write_text(
        "import offenders\n\n\n"
        "class Mine(offenders.Hostile):\n"
        "    def search(self, q, now_s, stop):\n"
        "        if not len(self.goal.configurations):\n"
        "            raise ValueError('no goal\\nanywhere')\n"
        "        return super().search(q, now_s, stop)\n"
    )
    assert main(["check-planner", "mine.py:Mine", "--format", "json"]) == 1
    report = json.loads(capfd.readouterr().out)
    assert (report["planner"], report["conformance"]) == ("mine.py:Mine", 1)
    assert [check["outcome"] for check in report["checks"]].count("failed") == 1
    assert {
        "check": "check_no_path_is_a_status",
        "outcome": "failed",
        "message": "ValueError: no goal anywhere (mine.py:7)",
    } in report["checks"]


def test_a_spec_is_read_before_a_process_starts() -> None:
    with pytest.raises(SpecError):
        next(run_checks("nope", 1.0))
