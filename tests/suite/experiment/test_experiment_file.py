import importlib.util
import json
from pathlib import Path

import pytest

from suite.cli.main import main
from suite.errors import SuiteError
from suite.experiment.experiment import make_experiment
from suite.experiment.file import check_experiment_file, read_experiment_file
from suite.experiment.manifest import make_manifest

ROOT = Path(__file__).resolve().parents[3]

STUDY = """
planners: [t2, 'temporal[horizon=4]', temporal, {name: rrt, iterations: [100, 200]}]
preset: table1
trials: 2
arm: {radius_m: 0.015}
sweep:
  obstacles: 1..3
  noise_mm: [0, 2]
  family.max_speed_m_s: 0.01..0.03/3
  arm.n_sections: [2, 3]
  temporal.spacing_rad: [0.5, 1]
"""


def write(folder: Path, text: str, name: str = "study.yaml") -> Path:
    (folder / name).write_text(text)
    return folder / name


def test_a_file_says_what_the_command_line_says(tmp_path) -> None:
    assert check_experiment_file(write(tmp_path, STUDY)) == make_experiment(
        planners="t2,temporal[horizon=4,spacing_rad=0.5|1],temporal[spacing_rad=0.5|1],rrt[iterations=100|200]",
        family="orbit[max_speed_m_s=0.01|0.02|0.03]",
        arm=["radius_m=0.015,n_sections=2", "radius_m=0.015,n_sections=3"],
        obstacles=(1, 2, 3),
        trials=2,
        noise_mm=(0, 2),
    )


def test_every_combination_is_a_trial_and_a_row_says_which(tmp_path) -> None:
    experiment = make_experiment(
        planners="pf", family="orbit[max_speed_m_s=0.01|0.02]", arm=["", "radius_m=0.01"], obstacles="0..1", trials=1,
        noise_mm="0,1", dropout=[0, 0.1], limits=[True, False], seed="3,4",
    )  # fmt: skip
    tasks = list(experiment.tasks(experiment.scenarios()))
    names = ("family_parameters", "arm", "n_obstacles", "noise_mm", "dropout", "limits", "experiment_seed")
    assert len({tuple(task.identity[name] for name in names) for task in tasks}) == len(tasks) == 2**7
    assert len({task.key for task in tasks}) == 2**7


def test_scenarios_of_unlike_settings_have_unlike_names() -> None:
    experiment = make_experiment(
        planners="pf", family="orbit,orbit[max_speed_m_s=0.02]", arm=["", "radius_m=0.01"], obstacles=1, trials=2
    )
    ids = [scenario.id for scenario in experiment.scenarios()]
    assert len(set(ids)) == 8
    assert ids[0] == "orbit-n1-s0-0000"  # the defaults' names never move: seeds come from them
    with pytest.raises(SuiteError, match="orbit-n1-s0-0000 2 times"):
        make_experiment(planners="pf", family="orbit,orbit[max_speed_m_s=0.015]", obstacles=1, trials=1).scenarios()


def test_conditions_that_come_to_the_same_are_one_trial() -> None:
    experiment = make_experiment(
        planners="pf,clairvoyant", obstacles=1, trials=1, predictor="own,cubic,arc", margin="0,1"
    )
    labels = [task.spec.label for task in experiment.tasks(experiment.scenarios())]
    assert (labels.count("pf"), labels.count("clairvoyant")) == (4, 1)


def test_a_manifest_is_such_a_file(tmp_path) -> None:
    swept = make_experiment(
        planners="pf,temporal[horizon=2]", obstacles=2, trials=1, noise_mm="0,1", arm=["", "radius_m=0.01"]
    )
    file = write(tmp_path, json.dumps(make_manifest(swept, swept.scenarios())), "manifest.json")
    assert make_experiment(**read_experiment_file(file)) == swept


def test_the_folder_stays_when_a_sweep_grows() -> None:
    names = {make_experiment(planners="pf", noise_mm=noise).name for noise in ("0,1", "0,1,2", (5, 6))}
    assert len(names) == 1
    assert names != {make_experiment(planners="pf", noise_mm=noise).name for noise in (0, 1)}


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("planners: [pf]\nnoise: 3", "found 'noise', allowed .*; nearest: noise_mm"),
        ("planners: [pf]\nsweep: {noise: [1]}", "sweep: found 'noise', allowed .*; nearest: noise_mm"),
        ("planners: [pf]\nsweep: {rrt.range: [1]}", r"sweep: found 'rrt\.range', allowed .*"),
        ("planners: [pf]\nsweep: {family.speed: [1]}", "orbit: found setting 'speed', allowed .*"),
        ("planners: [pf]\nsweep: {obstacles: 1..x}", "obstacles: found '1..x', allowed: .*"),
        ("planners: [pf]\nnoise_mm: 0.1..0.5", r"noise_mm: found '0\.1\.\.0\.5', allowed with the number of values.*"),
        ("planners: [pf]\npreset: table", "preset: found 'table', allowed .*; nearest: table1"),
        ("planners: [temporl]", "planner: found 'temporl', allowed .*; nearest: temporal"),
        ("planners: [pf]\ntrials: many", "trials: found 'many', allowed: .*"),
        ("planners: [pf]\nfamily: [3]", "family.*: found .*"),
        ("planners: [pf]\nschema_version: 2", "schema_version: found 2, allowed: .*"),
        ("- 1\n- 2", "found no experiment in it, .*"),
        ("planners: &a [pf]\nsweep: *a", ".*alias.*"),
        ("sweep: {obstacles: [1]}", r"planners: .*"),
    ],
)
def test_a_mistake_is_one_line_that_names_the_file(tmp_path, text: str, line: str) -> None:
    file = write(tmp_path, text)
    with pytest.raises(ValueError, match=rf"^{file}: {line}$"):
        check_experiment_file(file)


def test_check_knows_both_kinds_of_files(tmp_path, capfd) -> None:
    file = write(tmp_path, STUDY)
    assert main(["check", str(file), str(ROOT / "scenarios" / "examples" / "shapes.yaml")]) == 0
    assert "7 planners, sound" in capfd.readouterr().out
    assert main(["check", str(write(tmp_path, STUDY + "colour: red"))]) == 2
    assert "'colour'" in capfd.readouterr().err


@pytest.mark.parametrize("name", ["experiment", "scenario"])
def test_the_published_schemas_are_those_of_the_code(name: str) -> None:
    spec = importlib.util.spec_from_file_location("schema", ROOT / "docs" / "schema.py")
    schema = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(schema)
    published = (ROOT / "docs" / f"{name}.schema.json").read_text(encoding="utf-8")
    assert published == schema.schema_text(name), "python docs/schema.py writes it anew"


@pytest.mark.parametrize("file", sorted((ROOT / "docs" / "studies").glob("*.yaml")), ids=lambda file: file.stem)
def test_the_studies_are_sound_and_the_runs_kept_are_theirs(file: Path) -> None:
    study = check_experiment_file(file)
    kept = ROOT / "results" / file.stem / "manifest.json"
    if kept.exists():
        assert make_experiment(**read_experiment_file(kept)) == study
