"""Replays of real trials: what they say is what was executed, observed and predicted."""

import json
import re
import shutil
from pathlib import Path

import numpy as np
import pytest
from test_packed_arrays import unpacked

import suite
from scenarios import make_world
from suite.cli.main import main
from suite.show.replay.again import Played, play
from suite.show.replay.chosen import Trial, choose
from suite.show.replay.story import holds, story
from suite.store.journal import Executed
from suite.trial.look import Look

OUTSIDER = '''
from pathlib import Path
from planners import ArmPlanner
Path(r"{marker}").write_text("imported")
class Still(ArmPlanner):
    """Stays."""
    def search(self, q, now_s, stop):
        return None
'''


@pytest.fixture(scope="module")
def run(tmp_path_factory) -> Path:
    """One scenario of one obstacle, noisy, that one planner fails on."""
    folder = tmp_path_factory.mktemp("runs") / "a"
    suite.run("pf", out=folder, obstacles=(3,), trials=2, seed=1003, noise_mm=3.0)
    return folder


def data_of(file: Path) -> dict:
    text = file.read_text(encoding="utf-8")
    return json.loads(re.search(r'id="data">(.*?)</script>', text, re.DOTALL)[1])


def test_a_replay_holds_what_was_executed_and_what_was_true(run, tmp_path, capfd) -> None:
    scenario_id = str(suite.load(run).trials["scenario_id"][0])
    file = tmp_path / "a.html"
    assert main(["show", str(run), "--scenario", scenario_id, "--out", str(file)]) == 0
    assert str(file) in capfd.readouterr().out
    data, executed = data_of(file), suite.load(run).trajectory(scenario_id, "pf")
    (trial,) = data["trials"]
    assert np.allclose(unpacked(trial["times"]), executed.times_s, atol=1e-6)
    assert np.allclose(unpacked(trial["states"]), executed.configurations_rad, atol=1e-4)
    trace, scenario = data["scenario"]["trace"], suite.load(run).scenario(scenario_id)
    centers = unpacked(trace["centers"])
    times = trace["start"] + trace["step"] * np.arange(len(centers))
    for j, obstacle in enumerate(scenario.obstacles):
        assert np.allclose(centers[:, j], obstacle.position(times), atol=2e-5)
    row = choose(run, scenario_id, ()).trials[0].row
    assert len(trial["looks"]["solves"]) == row["n_solves"]
    swept = row["violation_swept_time_s"] if row["violation_swept_kind"] == "collision" else 0.0
    assert data["open"] == pytest.approx(max(0.0, swept - 2.0))


def test_played_again_a_planner_believes_what_it_believed(run) -> None:
    chosen = choose(run, None, ())
    played = play(run, chosen.scenario, chosen.trials[0])
    assert played.remark == ""
    assert [look.now_s for look in played.looks] == list(range(len(played.looks)))
    first = played.looks[0].expected
    noise = first.centers_m[0] - np.stack([o.position(np.zeros(1))[0] for o in chosen.scenario.obstacles])
    assert 0.0005 < np.abs(noise).max() < 0.02  # what it had observed, noise of 3 mm included


def test_trials_of_one_planner_are_told_apart_by_their_conditions(tmp_path) -> None:
    suite.run("pf", out=tmp_path / "a", obstacles=(1,), trials=1, noise_mm=(0.0, 2.0))
    shown = choose(tmp_path / "a", "orbit-n1-s0-0000", ())
    assert [trial.label for trial in shown.trials] == ["pf, noise mm 0.0", "pf, noise mm 2.0"]
    played = [play(tmp_path / "a", shown.scenario, trial) for trial in shown.trials]
    firsts = [each.looks[0].expected.centers_m[0] for each in played]
    assert np.abs(firsts[0] - firsts[1]).max() > 1e-4


def test_a_trial_that_goes_otherwise_is_shown_without_its_planners_answers(run) -> None:
    chosen = choose(run, None, ())
    (trial,) = chosen.trials
    bent = trial.executed._replace(configurations_rad=trial.executed.configurations_rad + 1e-6)
    played = play(run, chosen.scenario, trial._replace(executed=bent))
    assert played.looks == []
    assert "went otherwise" in played.remark


def test_a_run_that_kept_rows_only_is_played_again(run, tmp_path) -> None:
    for name in ("manifest.json", "trials.csv"):
        shutil.copy(run / name, tmp_path / name)
    chosen, kept = choose(tmp_path, None, ()), choose(run, None, ())
    assert chosen.scenario == kept.scenario  # drawn again
    played = play(tmp_path, chosen.scenario, chosen.trials[0])
    assert played.remark == "Played again: the run keeps rows only."
    assert np.array_equal(played.executed.configurations_rad, kept.trials[0].executed.configurations_rad)


def test_code_that_a_run_names_is_run_only_when_the_user_names_it(tmp_path) -> None:
    marker, file = tmp_path / "marker", tmp_path / "mine.py"
    file.write_text(OUTSIDER.format(marker=marker))
    suite.run(f"{file}:Still", out=tmp_path / "run", obstacles=(0,), trials=1)
    marker.unlink()
    chosen = choose(tmp_path / "run", None, ())
    untrusted = play(tmp_path / "run", chosen.scenario, chosen.trials[0])
    assert (untrusted.looks, marker.exists()) == ([], False)
    assert "--planner" in untrusted.remark
    trusted = play(tmp_path / "run", chosen.scenario, chosen.trials[0], ["Still"])
    assert len(trusted.looks) == 120
    assert "120 of 120 solves gave no path (Infeasible)" in " ".join(story(chosen.scenario, trusted))
    assert holds(trusted) == [(0.0, 120.0)]


def test_the_story_tells_a_wrong_prediction_from_a_collision_foreseen(run) -> None:
    scenario = choose(run, None, ()).scenario
    at = scenario.obstacles[1].position(np.array([7.4]))[0]
    row = dict.fromkeys(choose(run, None, ()).trials[0].row) | {
        "outcome": "collided",
        "violation_swept_time_s": 7.4,
        "violation_swept_kind": "collision",
        "contact_obstacle": 2,
        "contact_section": 3,
        "contact_while": "holding",
    }
    executed = Executed(scenario.id, "pf", np.array([0.0, 8.0]), np.stack([scenario.start] * 2), {})
    tip = scenario.arm.tip(scenario.start)

    def told(expected_of_it: np.ndarray) -> str:
        centers = np.stack([at + 5.0, expected_of_it, at + 5.0])
        world = make_world(7.0, 1.0, np.stack([centers] * 2), np.full(3, 0.02))
        return " ".join(story(scenario, Played("pf", row, executed, [Look(7.0, world, None)], "")))

    off = told(at + np.array([0.0, 0.003, 0.004]))
    assert off.startswith("At 7.40 s obstacle 2 touched section 3, which was holding still. The planner had looked at")
    assert "obstacle 2 at 5.0 mm from where it then was" in off
    assert "the prediction was wrong" in told(tip + np.array([0.0, 0.0, 0.02 + 0.018 + 0.0042]))
    assert "the two meet: 38.0 mm deep" in told(tip)


def test_unknown_names_are_one_line_with_the_nearest(run, tmp_path, capfd) -> None:
    out = str(tmp_path / "a.html")
    assert main(["show", str(run), "--scenario", "orbit-n3-s1003-0009", "--out", out]) == 2
    assert "nearest: orbit-n3-s1003-000" in capfd.readouterr().err
    assert main(["show", str(run), "--planner", "fp", "--out", out]) == 2
    assert "--planner: found 'fp', allowed pf" in capfd.readouterr().err
    assert main(["show", str(tmp_path), "--out", out]) == 2
    assert main(["show", str(run), "--out", str(tmp_path / "a.pdf")]) == 2
    assert len(capfd.readouterr().err.splitlines()) == 2


def test_a_scenario_file_is_shown_with_every_shape(tmp_path, capfd) -> None:
    file = tmp_path / "a.html"
    assert main(["show", "scenarios/examples/shapes.yaml", "--out", str(file)]) == 0
    shapes = data_of(file)["scenario"]["shapes"]
    assert [shape["kind"] for shape in shapes] == ["sphere", "box", "capsule", "cylinder", "mesh"]
    triangles = np.array(shapes[4]["triangles"]).reshape(-1, 3, 3)
    assert len(triangles) == 8
    outward = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    assert (np.einsum("ij,ij->i", outward, triangles.mean(axis=1)) > 0).all()


def test_trials_without_motion_are_shown_at_the_start(run) -> None:
    chosen = choose(run, None, ())
    row = chosen.trials[0].row | {"outcome": "planner_hung", "message": "no answer for 300 s"}
    dof = len(chosen.scenario.start)
    played = play(run, chosen.scenario, Trial(row, Executed("a", "pf", np.empty(0), np.empty((0, dof)), {}), "pf"))
    assert played.executed.configurations_rad.tolist() == [list(chosen.scenario.start_rad)]
    assert story(chosen.scenario, played)[0] == "The planner hung and was stopped: no answer for 300 s."
