"""Planners from outside: found by file, by module and by entry point; what fails there fails alone."""

import os
import sys
import time
from pathlib import Path

import pytest

import suite
from planners import ArmPlanner, Session, describe, failure_of, parse_planner, plugins
from planners.isolation import OutsideSettings
from planners.spec import load, read_spec
from scenarios import SpecError, generate
from suite.show.listing import planners_text

PLANNER = '''
"""A planner that stands still."""
import numpy as np
from pydantic import BaseModel, ConfigDict, Field
from planners import ArmPlanner, TimedPath

class Gains(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")
    gain: float = Field(default=1.0, gt=0, description="gain")

class Still(ArmPlanner):
    settings_model = Gains
    summary = "stands still"
    predictor = "velocity"

    def search(self, q, now_s, stop):
        return TimedPath(np.array([now_s, now_s + 1.0]), np.stack([q, q]))
'''


@pytest.fixture
def folder(tmp_path, monkeypatch) -> Path:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [*sys.path])
    (tmp_path / "still.py").write_text(PLANNER)
    return tmp_path


def test_a_file_is_a_planner_with_a_short_label(folder) -> None:
    for spec in (parse_planner("./still.py:Still[gain=2]"), describe("./still.py:Still[gain=2]")):
        assert spec.label == "Still[gain=2]"
        assert spec.name == f"{folder / 'still.py'}:Still"
        assert spec.predictor == "velocity"
        assert spec.settings.model_dump() == {"gain": 2.0}
        planner, settings = load(spec)
        assert planner.__name__ == "Still"
        assert isinstance(settings, planner.settings_model)


def test_what_is_described_was_not_imported_here(folder) -> None:
    (folder / "loud.py").write_text(PLANNER + "\nimport sys; sys.loud = True\n")
    assert isinstance(describe("loud.py:Still").settings, OutsideSettings)
    assert not hasattr(sys, "loud")


def test_a_described_planner_plans(folder) -> None:
    scenario = generate("orbit", 1, 1, 1000)[0]
    session = Session(describe("still.py:Still"), scenario, predictor="velocity", limits=False, seed=1)
    assert session.commitment == "step"


def test_a_given_name_is_the_label_of_any_planner(folder) -> None:
    assert parse_planner("still.py:Still[gain=2,name=mine-2]").label == "mine-2"
    assert parse_planner("rrt[range=3,name=short]").label == "short"
    assert parse_planner("rrt[range=3,name=short]").settings == parse_planner("rrt[range=3]").settings
    with pytest.raises(SpecError, match="at most 40 letters"):
        parse_planner("rrt[name=a b]")


def test_a_module_is_a_planner(folder) -> None:
    package = folder / "my_package_of_planners"
    package.mkdir()
    (package / "__init__.py").write_text("")
    (package / "still.py").write_text(PLANNER)
    spec = describe("my_package_of_planners.still:Still")
    assert (spec.label, spec.failure) == ("Still", None)
    before = spec.code
    (package / "other.py").write_text("x = 1\n")
    assert plugins.code_hash(spec.name) != before


def test_an_installed_distribution_offers_planners(folder) -> None:
    site, info = folder / "site", folder / "site" / "mine-1.0.dist-info"
    info.mkdir(parents=True)
    (site / "mine_planners.py").write_text(PLANNER)
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: mine\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(
        f"[{plugins.GROUP}]\nstill = mine_planners:Still\nbroken = mine_nowhere:Still\nrrt = mine_planners:Still\n"
    )
    sys.path.append(str(site))
    assert {"still", "broken"} <= set(plugins.offered())
    spec = describe("still[gain=3]")
    assert (spec.label, spec.failure, spec.settings.model_dump()) == ("still[gain=3]", None, {"gain": 3.0})
    assert spec.code == plugins.code_hash("still")
    assert parse_planner("rrt").code == ""  # the house's names are the house's
    with pytest.raises(SpecError, match="mine_nowhere"):
        describe("broken")
    listed = planners_text()
    assert "  still: stands still\n      gain = 1.0\n" in listed
    assert "  broken: unavailable: planner: found no module 'mine_nowhere'" in listed
    assert "  rrt: unavailable: the house has a planner of this name" in listed


def test_the_code_of_a_file_is_what_it_imports_from_beside_it_too(folder) -> None:
    (folder / "still.py").write_text("import helper\n" + PLANNER)
    (folder / "helper.py").write_text("from parts import deep\n")
    (folder / "parts").mkdir()
    (folder / "parts" / "__init__.py").write_text("")
    (folder / "parts" / "deep.py").write_text("x = 1\n")
    (folder / "unrelated.py").write_text("x = 1\n")
    first = describe("still.py:Still")
    assert first.failure is None
    (folder / "unrelated.py").write_text("x = 2\n")
    assert plugins.code_hash(first.name) == first.code
    (folder / "parts" / "deep.py").write_text("x = 2\n")
    assert plugins.code_hash(first.name) != first.code


def test_a_class_of_this_process_is_a_planner_in_it() -> None:
    class Mine(ArmPlanner):
        summary = "made here"

    spec = describe(plugins.offer(Mine))
    assert (spec.label, load(spec)[0]) == ("Mine", Mine)


@pytest.mark.parametrize(
    ("source", "outcome", "parts"),
    [
        ("import nothing_like_this", "planner_error", ["in import: ModuleNotFoundError", "bad.py:1"]),
        ("x = 1\nraise ValueError('two\\nlines')", "planner_error", ["ValueError: two lines", "bad.py:2"]),
        ("def f(:", "planner_error", ["SyntaxError", "bad.py:1"]),
        ("raise SystemExit(0)", "planner_error", ["SystemExit"]),
        ("raise ValueError('bad \\udc80 name')", "planner_error", ["\\udc80"]),
        ("raise ValueError('x' * 10_000_000)", "planner_error", ["bad.py:1"]),
        ("import os; os._exit(0)", "planner_error", ["the process died: exit code 0"]),
        ("import os; os.abort()", "planner_error", ["SIGABRT"]),
        ("import os; os.closerange(0, 64); os.kill(os.getpid(), 9)", "planner_error", ["SIGKILL"]),
        ("import time; time.sleep(1000)", "planner_hung", ["killed after 2 s"]),
        ("import subprocess, time; subprocess.Popen(['sleep', '999']); time.sleep(1000)", "planner_hung", ["killed"]),
    ],
)
def test_what_can_not_be_imported_is_a_failure_in_one_line(folder, source: str, outcome: str, parts: list[str]) -> None:
    (folder / "bad.py").write_text(source)
    started = time.monotonic()
    spec = describe("bad.py:Mine", limit_s=2.0 if outcome == "planner_hung" else 60.0)
    assert time.monotonic() - started < 60
    assert spec.label == "Mine"
    assert spec.failure is not None
    assert spec.failure.outcome == outcome
    assert len(spec.failure.message) <= 300
    assert len(spec.failure.message.splitlines()) == 1
    for part in parts:
        assert part in spec.failure.message


def test_what_a_planner_prints_while_it_is_imported_is_no_answer(folder) -> None:
    (folder / "still.py").write_text("import os\nprint('{' * 100_000)\nos.write(1, b'noise')\n" + PLANNER)
    assert describe("still.py:Still").failure is None


@pytest.mark.parametrize(
    ("text", "parts"),
    [
        ("nothere.py:Mine", ["no file 'nothere.py'"]),
        ("still.py:Other", ["no class 'Other'", "allowed Still"]),
        ("still.py:Gains", ["'Gains'", "derived from planners.ArmPlanner"]),
        ("still.py:", ["file.py:Class"]),
        (":Still", ["file.py:Class"]),
        ("still.py:Still[gian=2]", ["'gian'", "allowed gain"]),
        ("still.py:Still[gain=-1]", ["Still[gain]", "greater than 0"]),
        ("no_such_module.x:Mine", ["no module 'no_such_module.x'"]),
        ("json.nothing:Mine", ["no module 'json.nothing'"]),
        ("sys:Mine", ["no class 'Mine' in sys"]),
        ("strt", ["nearest: strrt"]),
    ],
)
def test_a_mistake_in_a_spec_is_one_line(folder, text: str, parts: list[str]) -> None:
    with pytest.raises(SpecError) as caught:
        describe(text)
    for part in parts:
        assert part in str(caught.value)
    assert len(str(caught.value).splitlines()) == 1


def test_a_file_that_is_edited_is_looked_at_again(folder) -> None:
    first = describe("still.py:Still")
    (folder / "still.py").write_text(PLANNER.replace("default=1.0", "default=5.0"))
    second = describe("still.py:Still")
    assert first.code != second.code
    assert second.settings.model_dump() == {"gain": 5.0}


def test_a_failure_names_the_line_of_the_planners_own_code(folder) -> None:
    (folder / "raises.py").write_text("import json\n\ndef f():\n    json.loads('{')\n")
    sys.path.append(str(folder))
    import raises

    with pytest.raises(ValueError, match="Expecting") as caught:
        raises.f()
    failure = failure_of(caught.value)
    assert "(raises.py:4)" in failure.message
    assert "json.loads" in failure.traceback


def test_long_specs_take_linear_time() -> None:
    started = time.process_time()
    for text in (" " * 200_000, "," * 200_000, "rrt[" + "a=1," * 50_000 + "a=2]", "[" * 200_000):
        with pytest.raises(SpecError):
            read_spec(text)
    assert time.process_time() - started < 5


def test_a_reference_means_the_same_in_any_folder(folder, tmp_path_factory) -> None:
    spec = describe("still.py:Still")
    os.chdir(tmp_path_factory.mktemp("elsewhere"))
    assert load(spec)[0].__name__ == "Still"


def test_what_is_edited_while_this_process_lives_is_imported_anew(folder) -> None:
    (folder / "parts.py").write_text("GAIN = 1\n")
    (folder / "still.py").write_text("import parts\n" + PLANNER + "    gain = parts.GAIN\n")
    before = parse_planner("still.py:Still")
    assert load(before)[0].gain == 1
    (folder / "parts.py").write_text("GAIN = 2\n")
    after = parse_planner("still.py:Still")
    assert after.code != before.code
    assert load(after)[0].gain == 2


def test_rows_of_an_edited_planner_are_run_again_and_no_others(folder, capfd) -> None:
    first = suite.run("./still.py:Still,pf", obstacles=(0,), trials=2, seed=1000, out="run").trials
    (folder / "still.py").write_text(PLANNER + "# edited\n")
    capfd.readouterr()
    second = suite.run("./still.py:Still,pf", obstacles=(0,), trials=2, seed=1000, out="run").trials
    assert "Still: its code has changed; its 2 rows of before are stale and run again" in capfd.readouterr().err
    theirs, ours = (trials[trials["planner"] == "pf"].reset_index(drop=True) for trials in (first, second))
    assert theirs.equals(ours)  # even their timings stand
    edited = [set(trials[trials["planner"] == "Still"]["planner_code"]) for trials in (first, second)]
    assert edited[0].isdisjoint(edited[1])
