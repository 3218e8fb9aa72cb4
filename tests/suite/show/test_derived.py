import pytest
from fake_runs import run_with_fakes

import suite
from scenarios import load_scenarios
from suite.auditor.trajectory_file import read_trajectories
from suite.errors import SuiteError


def test_trajectories_say_under_which_condition_where_a_scenario_was_met_again(tmp_path) -> None:
    run_with_fakes(tmp_path, noise_mm=(0, 1), limits=(False, True))
    read = read_trajectories(tmp_path / "trajectories.csv", load_scenarios(tmp_path / "scenarios.jsonl"))
    assert len(read) == 64
    conditions = [f"limits={limits};noise_mm={noise}" for limits in (0, 1) for noise in (0.0, 1.0)]
    names = {f"{planner} {condition}" for planner in ("pf", "rrt") for condition in conditions}
    assert {trajectory.planner for trajectory in read} == names
    run = suite.load(tmp_path)
    scenario = read[0].scenario.id
    with pytest.raises(SuiteError, match=r"found 4 trials of .*, allowed one: say which by limits, noise_mm"):
        run.trajectory(scenario, "pf")
    one = run.trajectory(scenario, "pf", limits=True, noise_mm=1.0)
    (same,) = (each for each in read if (each.scenario.id, each.planner) == (scenario, "pf limits=1;noise_mm=1.0"))
    assert one.configurations_rad == pytest.approx(same.configurations_rad, rel=1e-8)


def test_an_unswept_run_has_no_such_column(tmp_path) -> None:
    run_with_fakes(tmp_path)
    header = (tmp_path / "trajectories.csv").read_text(encoding="utf-8").partition("\n")[0]
    assert header.startswith("scenario_id,planner,time_s,u1_rad")
