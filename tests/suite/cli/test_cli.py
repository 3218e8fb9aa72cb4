import json
import os
import signal
import sqlite3
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import pytest
from fake_runs import run_with_fakes

from scenarios import generate, load_scenarios, save_scenarios
from suite.cli import main as cli
from suite.cli.main import main

CALLS_HOME = os.environ | {"PYTHONPATH": str(Path(__file__).parents[3])}


@pytest.fixture(autouse=True)
def _in_an_empty_folder(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    signals = signal.getsignal(signal.SIGTERM)
    yield
    signal.signal(signal.SIGTERM, signals)


def scenario_text(**changes: object) -> str:
    (scenario,) = generate("orbit", 1, 1, 0)
    return json.dumps(scenario.model_dump(mode="json") | changes)


BAD_FILES = {
    "wrong_field.json": scenario_text(colour="red"),
    "truncated.json": scenario_text()[:200],
    "not_a_number.json": scenario_text(goal_m=[float("nan"), 0, 0]),
    "empty.jsonl": "",
    "binary.yaml": "\x00\x01",
    "list.toml": "",
}

BAD_RUNS = [
    ("--planners nope", "'nope'"),
    ("--planners temporal[depth=3]", "'depth'"),
    ("--planners temporal[horizon=soon]", "'soon'"),
    ("--planners temporal[horizon=3", "'temporal[horizon=3'"),
    ("--planners pf,,rrt", "empty entry"),
    ("--planners pf,pf", "pf 2 times"),
    ("", "--planners"),
    ("--planners pf --obstacles -1", "-1"),
    ("--planners pf --obstacles many", "'many'"),
    ("--planners pf --obstacles 1,,3", "'1,,3'"),
    ("--planners pf --obstacles 1000000000", "1000000000"),
    ("--planners pf --trials 0", "trials: found 0"),
    ("--planners pf --trials x", "--trials"),
    ("--planners pf --trials 1000000000", "1000000000"),
    ("--planners pf --seed -3", "-3"),
    ("--planners pf --family spiral", "'spiral'"),
    ("--planners pf --predictor crystal", "'crystal'"),
    ("--planners pf --noise-mm nan", "nan"),
    ("--planners pf --dropout 2", "2.0"),
    ("--planners pf --workers 0", "0"),
    ("--planners pf --hang-limit-s 0", "0"),
    ("--planners pf --hang-limit-s nan", "nan"),
    ("--planners pf --colour red", "--colour"),
    ("--planners pf --fresh --keep-stale", "--keep-stale: found beside --fresh"),
    ("--preset table9", "'table9'"),
    ("--preset missing.json", "missing.json"),
    ("--planners pf --scenarios missing.yaml", "missing.yaml"),
    ("--planners pf --scenarios a.yaml --trials 3", "--trials"),
    *((f"--planners pf --scenarios {name}", name) for name in BAD_FILES),
]


@pytest.mark.parametrize(("options", "named"), BAD_RUNS)
def test_a_mistake_is_one_line_exit_2_and_nothing_made(options: str, named: str, tmp_path, capfd) -> None:
    for name, text in BAD_FILES.items():
        (tmp_path / name).write_text(text)
    before = sorted(tmp_path.rglob("*"))
    assert main(["run", *options.split(), "--out", "made/here"]) == 2
    out, err = capfd.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    assert err.startswith("suite: error: ")
    assert named in err
    assert sorted(tmp_path.rglob("*")) == before


@pytest.mark.parametrize("out", ["file.txt", "file.txt/below", "/proc/suite-run", "full", "\0"])
def test_an_out_that_cannot_be_used_is_one_line(out: str, tmp_path, capfd) -> None:
    (tmp_path / "file.txt").write_text("mine")
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "thesis.tex").write_text("mine")
    before = sorted(tmp_path.rglob("*"))
    assert main(["run", "--planners", "pf", "--obstacles", "0", "--trials", "1", "--out", out]) == 2
    _, err = capfd.readouterr()
    assert err.count("\n") == 1
    assert sorted(tmp_path.rglob("*")) == before


@pytest.mark.parametrize(
    "arguments",
    [
        "table nowhere",
        "table . --format html",
        "generate scenes.toml",
        "generate scenes.json --obstacles -2",
        "generate scenes.json --trials 0",
        "generate scenes.json --family spiral",
        "generate no/such/folder/scenes.json --trials 1",
        "check missing.json",
        "frobnicate",
        "--colour",
    ],
)
def test_other_commands_too(arguments: str, tmp_path, capfd) -> None:
    assert main(arguments.split()) == 2
    out, err = capfd.readouterr()
    assert (out, err.count("\n")) == ("", 1)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("arguments", [["--help"], [], ["run", "--help"], ["table", "--help"]])
def test_help(arguments: list[str], capfd) -> None:
    assert main(arguments) == 0
    assert "Usage: suite" in capfd.readouterr().out


def test_help_imports_nothing_heavy() -> None:
    code = (
        "import sys; from suite.cli.main import main; main(['--help']); main(['run', '--help']);"
        "heavy = {'numpy', 'ompl', 'numba', 'pandas', 'scipy', 'dask', 'distributed', 'scenarios', 'planners'};"
        "heavy &= set(sys.modules);"
        "sys.exit(str(heavy) if heavy else 0)"
    )
    subprocess.run([sys.executable, "-c", code], check=True, stdout=subprocess.DEVNULL)


def test_generate_then_check(tmp_path, capfd) -> None:
    call = ["generate", "scenes.yaml", "--family", "orbit", "--obstacles", "1,3", "--trials", "2", "--seed", "7"]
    assert main(call) == 0
    scenarios = load_scenarios(tmp_path / "scenes.yaml")
    assert scenarios == generate("orbit", 1, 2, 7) + generate("orbit", 3, 2, 7)
    assert main(["check", "scenes.yaml"]) == 0
    assert "4 scenarios" in capfd.readouterr().out
    assert main(call) == 2  # the file is there now
    assert main([*call, "--overwrite"]) == 0


def test_check_finds_a_start_that_is_hit(tmp_path, capfd) -> None:
    (scenario,) = generate("orbit", 1, 1, 0)
    obstacle = scenario.obstacles[0].model_copy(update={"radius_m": 0.5})
    save_scenarios(tmp_path / "hit.json", [scenario.model_copy(update={"obstacles": (obstacle,)})])
    assert main(["check", "hit.json"]) == 2
    assert "hit.json" in capfd.readouterr().err


def test_a_name_that_the_terminal_cannot_show_is_escaped(tmp_path) -> None:
    save_scenarios(tmp_path / "ř中.json", generate("orbit", 0, 1, 0))
    call = [sys.executable, "-m", "suite", "check", "ř中.json"]
    checked = subprocess.run(call, env=CALLS_HOME | {"PYTHONIOENCODING": "cp1252"}, capture_output=True, check=True)
    assert checked.stdout.decode("cp1252").startswith("\\u0159\\u4e2d.json: 1 scenarios")


def test_planners_lists_every_setting(capfd) -> None:
    from planners import PLANNERS, PREDICTORS

    assert main(["planners"]) == 0
    out = capfd.readouterr().out
    for name, entry in PLANNERS.items():
        assert f"  {name}: " in out
        for setting, field in entry.settings_model.model_fields.items():
            assert f"{setting}: " in out
            assert field.description, f"{name}[{setting}] says nothing"
    assert all(f"  {name}: " in out for name in PREDICTORS)


def test_version(capfd) -> None:
    assert main(["version"]) == 0
    assert "ompl 2" in capfd.readouterr().out


def test_table_of_a_run_in_every_format(tmp_path, capfd) -> None:
    run_with_fakes(tmp_path / "run")
    capfd.readouterr()
    texts = {}
    for format in ("terminal", "markdown", "csv", "latex"):
        assert main(["table", "run", "--format", format, "--against", "published", "--reference", "pf"]) == 0
        texts[format] = capfd.readouterr().out
    assert all("rrt" in text for text in texts.values())
    (tmp_path / "run" / "run.db").unlink()  # as in a folder that was committed
    assert main(["table", "run", "--format", "csv", "--against", "published", "--reference", "pf"]) == 0
    assert capfd.readouterr().out == texts["csv"]
    assert main(["table", "run", "--reference", "t9"]) == 2


def test_nothing_to_compare_is_exit_3(tmp_path, capfd) -> None:
    run_with_fakes(tmp_path / "run")
    with sqlite3.connect(tmp_path / "run" / "run.db") as db:
        db.execute("DELETE FROM trials")
    db.close()
    assert main(["table", "run"]) == 3


def start(arguments: str) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-m", "suite", *arguments.split()],
        env=CALLS_HOME,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )


def test_a_real_run_from_the_command_line(tmp_path) -> None:
    run = start("run --planners pf,t2 --obstacles 0,1 --trials 1 --seed 7 --workers 2 --out run")
    out, err = run.communicate(timeout=600)
    assert run.returncode == 0, err
    assert out.splitlines()[-3:] == ["run/table.md", "run/table.csv", "run/trials.csv"]
    names = {file.name for file in (tmp_path / "run").iterdir()}
    derived = {"trials.csv", "table.csv", "table.md", "scenarios.jsonl", "trajectories.csv"}
    assert names == derived | {"run.db", "manifest.json", ".finished.json"}
    assert load_scenarios(tmp_path / "run" / "scenarios.jsonl") == generate("orbit", 0, 1, 7) + generate(
        "orbit", 1, 1, 7
    )
    grown = start("run --planners t2,pf --obstacles 0,1 --trials 2 --seed 7 --workers 2 --out run")
    out, err = grown.communicate(timeout=600)
    assert grown.returncode == 0, err
    assert "suite: 4 of 8 trials are there already" in err.splitlines()
    assert "4 trials to run" in err.splitlines()
    assert out.startswith("Predictor cubic; prediction margin 0; ")


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_stopped_run_is_saved_and_leaves_no_process(tmp_path, number: signal.Signals) -> None:
    run = start("run --planners pf --obstacles 3 --trials 500 --workers 2 --out run")
    deadline_s = time.monotonic() + 600
    while not finished_trials(tmp_path / "run" / "run.db"):
        assert run.poll() is None, run.communicate()[1]
        assert time.monotonic() < deadline_s
        time.sleep(0.05)
    if number == signal.SIGINT:
        os.killpg(run.pid, number)  # as a terminal does
    else:
        run.send_signal(number)
    _, err = run.communicate(timeout=60)
    assert run.returncode == 130
    saved = finished_trials(tmp_path / "run" / "run.db")
    last = err.splitlines()[-1]
    assert last == f"suite: stopped: {saved} of 500 trials are saved in run; the same command goes on from there"
    assert "Traceback" not in err
    assert is_gone(run.pid)


def is_gone(group: int) -> bool:
    """Whether no process of the group is left; Python's own resource tracker ends a moment after its parent."""
    for _ in range(100):
        try:
            os.killpg(group, 0)
        except ProcessLookupError:
            return True
        time.sleep(0.1)
    return False


def finished_trials(file: Path) -> int:
    if not file.exists():
        return 0
    db = sqlite3.connect(f"file:{file}?mode=ro", uri=True)
    try:
        return int(db.execute("SELECT count(*) FROM trials").fetchone()[0])
    except sqlite3.OperationalError:  # not made yet
        return 0
    finally:
        db.close()


@pytest.mark.parametrize("is_interrupted", [True, False])
def test_an_interrupt_that_the_compiler_swallows_is_one(is_interrupted: bool, monkeypatch, capfd) -> None:
    def compiles(*_: object, **__: object) -> None:
        with suppress(KeyboardInterrupt):
            if is_interrupted:
                os.kill(os.getpid(), signal.SIGINT)
                time.sleep(5)
        raise RuntimeError("no compiled object yet")

    monkeypatch.setattr(cli, "app", compiles)
    if is_interrupted:
        assert main(["planners"]) == 130
        assert capfd.readouterr().err == "suite: stopped before anything ran\n"
    else:
        with pytest.raises(RuntimeError):
            main(["planners"])
