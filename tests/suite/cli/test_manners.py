"""How the command line behaves: short help, versions, widths, colours, completion, quiet, JSON."""

import json
import os
import pty
import re
import resource
import signal
import subprocess
import sys
from pathlib import Path
from unittest.mock import patch

import pandas as pd
import pytest
from fake_runs import run_with_fakes

from suite.cli.main import main
from suite.cli.options import complete_planners

ROOT = Path(__file__).resolve().parents[3]


@pytest.fixture(autouse=True)
def _signals() -> None:
    before = signal.getsignal(signal.SIGTERM)
    yield
    signal.signal(signal.SIGTERM, before)


@pytest.fixture(scope="module")
def run(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("runs") / "run"
    run_with_fakes(folder, noise_mm=(0, 1), planners=("pf", "rrt", "temporal[horizon=3]"))
    return folder


def on_a_terminal(*arguments: str, **environment: str) -> str:
    """What a command shows on a terminal."""
    ours, theirs = pty.openpty()
    env = {key: value for key, value in os.environ.items() if key not in {"COLUMNS", "NO_COLOR"}}
    env |= {"PYTHONPATH": str(ROOT), "TERM": "xterm-256color"} | environment
    with subprocess.Popen([sys.executable, "-m", "suite", *arguments], stdout=theirs, stderr=theirs, env=env) as shown:
        os.close(theirs)
        text = b""
        while True:
            try:
                piece = os.read(ours, 65536)
            except OSError:  # the other end is closed
                break
            if not piece:
                break
            text += piece
    os.close(ours)
    assert shown.returncode == 0
    return text.decode().replace("\r\n", "\n")


@pytest.mark.parametrize("arguments", [["-h"], ["run", "-h"], ["plot", "-h"]])
def test_short_help(arguments: list[str], capfd) -> None:
    assert main(arguments) == 0
    assert "Usage: suite" in capfd.readouterr().out


def test_version_is_one_line(capfd) -> None:
    assert main(["--version"]) == 0
    out = capfd.readouterr().out
    assert out.startswith("continuum-arm-suite ")
    assert out.count("\n") == 1


def test_help_answers_at_once() -> None:
    """In processor time: the machine may be busy."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([sys.executable, "-m", "suite", "--help"], cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    assert after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime < 0.4


def test_a_terminal_of_80_columns_and_one_that_says_none(run: Path) -> None:
    """As wide as it is, or 80 columns; what is left out is named, and no number is cut."""
    for columns in ("80", "0"):
        text = re.sub(r"\x1b\[[\d;]*m", "", on_a_terminal("table", str(run), "--reference", "pf", COLUMNS=columns))
        assert max(map(len, text.splitlines())) <= 80, text
        assert "swept %" in text
        assert "Not shown for lack of width: " in " ".join(text.split())
        assert "…" not in text
        assert "only planner" in text


def test_no_color_means_none(run: Path) -> None:
    assert "\x1b[1m" in on_a_terminal("table", str(run), COLUMNS="200")
    plain = on_a_terminal("table", str(run), COLUMNS="200", NO_COLOR="1")
    assert "\x1b[3" not in plain


def test_lists_fit_80_columns(capfd) -> None:
    assert main(["planners"]) == 0
    assert max(map(len, capfd.readouterr().out.splitlines())) <= 80


def test_json_wherever_a_table_is_printed(run: Path, capfd) -> None:
    def answer(*arguments: str):
        capfd.readouterr()
        assert main([*arguments, "--format", "json"]) == 0
        return json.loads(capfd.readouterr().out)

    table = answer("table", str(run), "--reference", "pf")
    assert len(table["table"]) == 12
    assert len(table["pairs"]) == 8
    pooled = answer("table", str(run), "--by", "n_obstacles")
    assert pooled["pooled"] == {"noise_mm": [0.0, 1.0]}
    assert pooled["table"][0]["noise_mm"] is None
    listed = answer("planners")
    assert listed["planners"]["rrt"]["budget"] == ["iterations"]
    assert listed["planners"]["rrt"]["settings"]["iterations"]["default"] == 1000
    measured = pd.DataFrame({"predictor": ["cubic"], "error_m": [float("nan")]})
    with patch("suite.compare.predictors.measure", return_value=measured):
        assert answer("predictors") == {"table": [{"predictor": "cubic", "error_m": None}]}


def test_planners_are_completed_in_a_list() -> None:
    assert complete_planners("temporal,rrtc") == ["temporal,rrtconnect"]
    assert set(complete_planners("t")) >= {"t2", "t3", "temporal", "temporal-ct", "temporal-best"}
    assert "pf,pf" not in complete_planners("pf,")
    assert "pf,ompl.KPIECE1" in complete_planners("pf,ompl.K")
    words = {"_SUITE_COMPLETE": "complete_bash", "COMP_WORDS": "suite run --planners t2,temporal-b", "COMP_CWORD": "3"}
    call = [sys.executable, "-m", "suite"]
    shown = subprocess.run(call, cwd=ROOT, env=os.environ | words, capture_output=True, text=True, check=False)
    assert shown.stdout.split() == ["t2,temporal-best"]


def test_quiet_says_nothing_on_the_way(tmp_path, capfd) -> None:
    run_one = ["run", "--planners", "pf", "--obstacles", "0", "--trials", "1", "--workers", "1"]
    assert main([*run_one, "--out", str(tmp_path / "q"), "--quiet", "--format", "json"]) == 0
    out, err = capfd.readouterr()
    assert err == ""
    assert json.loads(out)["table"][0]["planner"] == "pf"
