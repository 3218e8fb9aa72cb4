import json

import pytest
from fakes import fake_spec, make_scenario

from scenarios import SpecError, UserError, save_scenarios
from suite.errors import SuiteError
from suite.experiment.code import house, house_code
from suite.experiment.experiment import make_experiment
from suite.experiment.file import preset_fields
from suite.experiment.manifest import make_manifest
from suite.experiment.presets import PRESETS, standard_of
from suite.trial.task import TrialTask


@pytest.mark.parametrize(
    ("fields", "line"),
    [
        ({"planners": ("nope",)}, r"planner: found 'nope', allowed temporal, .*"),
        ({"planners": ("temporal[depth=3]",)}, r"temporal: found setting 'depth', allowed horizon, .*"),
        ({"planners": ("temporal[horizon=0]",)}, r"temporal\[horizon\]: found '0', allowed: .*"),
        ({"planners": ("pf", "pf")}, r"planners: found pf 2 times, allowed once"),
        ({"planners": ()}, r"planners: found \(\), allowed: .*"),
        ({"obstacles": (3, -1)}, r"obstacles: found -1, allowed: .*greater than or equal to 0"),
        ({"obstacles": (3, 3)}, r"obstacles: found 3 2 times, allowed once"),
        ({"obstacles": (10**6,)}, r"obstacles: found 1000000, allowed: .*"),
        ({"trials": 0}, r"trials: found 0, allowed: .*greater than or equal to 1"),
        ({"trials": 10**9}, r"trials: found 1000000000, allowed: .*"),
        ({"seed": -1}, r"seed: found -1, allowed: .*"),
        ({"family": "spiral"}, r"family: found 'spiral', allowed orbit.*"),
        ({"predictor": "crystal"}, r"predictor: found 'crystal', allowed .*cubic.*"),
        ({"noise_mm": float("nan")}, r"noise_mm: found nan, allowed: .*"),
        ({"dropout": 1.0}, r"dropout: found 1\.0, allowed: .*"),
        ({"colour": "red"}, r"colour: found 'red', allowed: .*"),
    ],
)
def test_what_is_not_allowed_is_one_line(fields: dict[str, object], line: str) -> None:
    with pytest.raises(SuiteError, match=f"^{line}$"):
        make_experiment(**{"planners": ("pf",), **fields})


def test_tasks_pair_every_planner_with_every_scenario_in_a_fixed_order() -> None:
    experiment = make_experiment(planners=("pf", "t2"), obstacles=(1, 2), trials=2, seed=3)
    scenarios = experiment.scenarios()
    tasks = list(experiment.tasks(scenarios))
    assert [(len(task.scenario.obstacles), task.spec.label) for task in tasks] == [
        (1, "pf"), (1, "t2"), (1, "pf"), (1, "t2"), (2, "pf"), (2, "t2"), (2, "pf"), (2, "t2"),
    ]  # fmt: skip
    assert len({task.key for task in tasks}) == 8
    assert len({task.trial_seed for task in tasks}) == 8


def test_a_trial_seed_depends_on_names_only() -> None:
    alone = make_experiment(planners=("pf",), obstacles=(2,), trials=1, seed=3)
    among = make_experiment(planners=("t2", "rrt", "pf"), obstacles=(1, 2), trials=3, seed=3)
    seeds = {task.key: task.trial_seed for task in among.tasks(among.scenarios())}
    for task in alone.tasks(alone.scenarios()):
        assert seeds[task.key] == task.trial_seed


def test_a_trial_seed_suits_ompl_and_never_moves() -> None:
    seeds = {
        TrialTask(make_scenario(k), fake_spec("pf"), predictor="cubic", limits=False, seed=s).trial_seed
        for k in range(50)
        for s in range(10)
    }
    assert len(seeds) == 500
    assert all(1 <= seed < 2**31 for seed in seeds)
    task = TrialTask(make_scenario(7), fake_spec("pf"), predictor="cubic", limits=False, seed=1)
    assert task.trial_seed == 500767591  # recorded: a change here changes every result


def test_blanks_in_a_spec_do_not_matter() -> None:
    spaced, tight = (make_experiment(planners=(spec,)) for spec in ("temporal[ horizon = 4 ]", "temporal[horizon=4]"))
    assert spaced == tight
    assert spaced.name == tight.name


def test_the_name_follows_every_choice() -> None:
    base = {"planners": ("pf",), "trials": 5}
    names = {
        make_experiment(**base, **change).name
        for change in ({}, {"seed": 1}, {"limits": True}, {"noise_mm": 1.0}, {"dropout": 0.1}, {"predictor": "gp"})
    }
    assert len(names) == 6


def test_a_run_that_grows_stays_in_its_folder() -> None:
    base = {"planners": ("pf",), "trials": 5}
    names = {
        make_experiment(**base | change).name
        for change in ({}, {"trials": 6}, {"planners": ("rrt", "pf")}, {"obstacles": (1,)})
    }
    assert len(names) == 1


def test_tasks_say_under_which_conditions_they_run() -> None:
    experiment = make_experiment(
        planners=("pf", "rrt", "clairvoyant"), obstacles=(1,), trials=1, arm="radius_m=0.015",
        family="orbit[max_speed_m_s=0.03]",
    )  # fmt: skip
    rows = [task.identity for task in experiment.tasks(experiment.scenarios())]
    assert [row["predictor"] for row in rows] == ["cubic", "portfolio", "truth"]
    assert [row["prediction_margin"] for row in rows] == [0.0, 1.0, 0.0]
    for row in rows:
        assert (row["arm"], row["family_parameters"]) == ("radius_m=0.015", "max_speed_m_s=0.03")
        assert row["house_code"] == row["planner_code"] == house_code(house())
    plain = make_experiment(planners=("pf",), obstacles=(1,), trials=1)
    (task,) = plain.tasks(plain.scenarios())
    assert (task.identity["arm"], task.identity["family_parameters"]) == ("default", "default")


def test_a_predictor_that_is_asked_for_is_had_by_all_but_bounds() -> None:
    experiment = make_experiment(planners=("rrt", "clairvoyant"), obstacles=(1,), trials=1, predictor="arc")
    assert [task.predictor for task in experiment.tasks(experiment.scenarios())] == ["arc", "truth"]


def test_too_many_trials_in_all_are_refused_before_they_are_made() -> None:
    experiment = make_experiment(planners=("pf", "t2", "t3"), obstacles=tuple(range(1, 11)), trials=100_000)
    with pytest.raises(SuiteError, match="found 3000000 trials in all, allowed 1000000"):
        experiment.scenarios()


def test_the_same_problem_twice_is_refused(tmp_path) -> None:
    one, two = tmp_path / "one.json", tmp_path / "two.jsonl"
    save_scenarios(one, [make_scenario(1), make_scenario(2)])
    save_scenarios(two, [make_scenario(3), make_scenario(2).model_copy(update={"id": "other"})])
    experiment = make_experiment(planners=("pf",), scenario_files=(str(one), str(two)))
    with pytest.raises(SuiteError, match="found other, the same problem as fake-0002, allowed once"):
        experiment.scenarios()


def test_the_same_name_twice_is_refused(tmp_path) -> None:
    one, two = tmp_path / "one.json", tmp_path / "two.json"
    save_scenarios(one, [make_scenario(1)])
    save_scenarios(two, [make_scenario(2).model_copy(update={"id": "fake-0001"})])
    experiment = make_experiment(planners=("pf",), scenario_files=(str(one), str(two)))
    with pytest.raises(SuiteError, match="scenario files: found fake-0001 2 times, allowed once"):
        experiment.scenarios()


def test_table1_is_the_papers() -> None:
    experiment = make_experiment(**PRESETS["table1"])
    assert experiment.planners == ("t2", "t3", "temporal-best", "h", "hs", "pf")
    assert (experiment.obstacles, experiment.trials, experiment.seed) == ((1, 3, 5, 6), 100, (0,))


def test_a_manifest_reruns_its_experiment(tmp_path) -> None:
    experiment = make_experiment(planners=("pf", "temporal[horizon=2]"), obstacles=(2,), trials=3, dropout=0.1)
    file = tmp_path / "manifest.json"
    file.write_text(json.dumps(make_manifest(experiment, experiment.scenarios())))
    assert make_experiment(**preset_fields(str(file))) == experiment


@pytest.mark.parametrize("text", ["", "[]", '{"experiment": 3}', "{"])
def test_a_file_without_an_experiment_is_no_preset(tmp_path, text: str) -> None:
    file = tmp_path / "manifest.json"
    file.write_text(text)
    with pytest.raises(UserError, match=r"manifest\.json: (found no experiment|not valid JSON)"):
        preset_fields(str(file))


def test_an_unknown_preset_lists_the_known_ones() -> None:
    with pytest.raises(SpecError, match="preset: found 'table9', allowed table1, standard-1; nearest: table1"):
        preset_fields("table9")


def test_standard_1_is_known_by_its_scenarios() -> None:
    scenarios = make_experiment(**PRESETS["standard-1"]).scenarios()
    assert len(scenarios) == 900
    mine = make_experiment(**PRESETS["standard-1"] | {"planners": ("pf",)})
    assert standard_of(mine, scenarios.digest) == ("standard-1", True)
    assert make_manifest(mine, scenarios)["standard"] == "standard-1"
    assert standard_of(mine, "0" * 16) == ("standard-1", False)
    assert standard_of(make_experiment(**PRESETS["standard-1"] | {"seed": 1}), scenarios.digest) is None


def test_bounds_are_a_planner_more() -> None:
    asked = make_experiment(planners=("pf",))
    assert asked.with_bound().planners == ("pf", "clairvoyant")
    assert asked.with_bound(5).planners == ("pf", "clairvoyant[restarts=100]")
    assert asked.with_bound().with_bound() == asked.with_bound()
    assert asked.with_bound().name == asked.name  # the run grows
