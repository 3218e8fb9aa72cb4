"""What figures of every kind show, against the rows they are drawn from."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from fake_runs import run_with_fakes

import suite
from suite.cli.main import main
from suite.errors import SuiteError
from suite.show.plots import KINDS, plot
from suite.show.plots.asked import Asked
from suite.show.plots.profile import ratios
from suite.store.run_folder import planner_order, read_trials


@pytest.fixture(scope="module")
def run(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("kinds") / "run"
    run_with_fakes(folder, trials=8)
    return folder


@pytest.fixture(scope="module")
def drawn(run, tmp_path_factory):
    folder = tmp_path_factory.mktemp("drawn")

    def draw(kind: str, **asked: object):
        return plot(kind, read_trials(run), planner_order(run), Asked(**asked), folder / "a.svg").figure

    return draw


def test_times_are_the_sorted_times_of_all_trials(run, drawn) -> None:
    axes = drawn("times").axes
    trials = read_trials(run)
    assert [axis.get_title() for axis in axes] == ["obstacles 0", "obstacles 1"]
    for axis, n in zip(axes, (0, 1), strict=True):
        for line in axis.lines:
            theirs = trials[(trials["planner"] == line.get_label()) & (trials["n_obstacles"] == n)]
            assert list(line.get_xdata()[1:]) == sorted(theirs["planning_time_s"])
            assert line.get_ydata()[-1] == 100


def test_verdicts_are_shares_with_their_intervals(run, drawn) -> None:
    table = suite.load(run).table()
    for axis, n in zip(drawn("verdicts").axes, (0, 1), strict=True):
        marks = [container[0] for container in axis.containers]
        shown = sorted(float(mark.get_xdata()[0]) for mark in marks)
        there = table[table["n_obstacles"] == n]
        wanted = [*there["success_per_step_percent"], *there["success_swept_percent"]]  # the third was not judged
        assert shown == pytest.approx(sorted(wanted))


def test_a_profile_counts_failures_as_dearer_than_anything() -> None:
    trials = pd.DataFrame(
        {
            "scenario_hash": ["a", "a", "b", "b", "c", "c", "d"],
            "planner": ["x", "y", "x", "y", "x", "y", "x"],
            "planning_time_s": [1.0, 3.0, 4.0, 2.0, 1.0, 1.0, 1.0],
            "success_swept": [True, True, False, True, False, False, True],
            "state_checks": 1,
            "motion_checks": 0,
        }
    )
    table = ratios(trials, ["x", "y"], "success_swept", "time")
    assert table["x"].tolist() == [1.0, np.inf, np.inf]
    assert table["y"].tolist() == [3.0, 1.0, np.inf]


def test_a_profile_ends_at_the_success_rate(run, drawn) -> None:
    table = suite.load(run).table()
    for axis, n in zip(drawn("profile", verdict="per_step").axes, (0, 1), strict=True):
        for line in axis.lines:
            there = table[(table["n_obstacles"] == n) & (table["planner"] == line.get_label())]
            assert line.get_ydata()[-1] == pytest.approx(there["success_per_step_percent"].iloc[0])


def test_paths_are_those_of_the_tips(tmp_path) -> None:
    made = suite.run("pf", out=tmp_path / "run", obstacles=(1,), trials=1)
    figure = plot("paths", made.trials, ("pf",), Asked(run=tmp_path / "run"), tmp_path / "a.png").figure
    scenario = made.scenario("orbit-n1-s0-0000")
    tips = scenario.arm.tips(made.trajectory(scenario.id, "pf").configurations_rad)
    for axis, columns in zip(figure.axes, ([0, 2], [0, 1]), strict=True):
        (line,) = [line for line in axis.lines if line.get_label() == "pf"]
        assert np.allclose(line.get_xydata(), tips[:, columns])


def test_every_kind_is_a_command(run, tmp_path, capfd) -> None:
    assert set(KINDS) == {"curve", "times", "profile", "verdicts", "paths"}
    for kind in ("times", "profile", "verdicts"):
        assert main(["plot", str(run), kind, "-o", str(tmp_path / f"{kind}.pdf")]) == 0
        assert "n = 8" in capfd.readouterr().out
    assert main(["plot", str(run), "tims", "-o", str(tmp_path / "a.pdf")]) == 2
    assert "nearest: times" in capfd.readouterr().err


@pytest.mark.parametrize("kind", ["times", "profile"])
def test_a_legend_of_many_long_names_takes_nothing_from_the_panels(kind: str, run, tmp_path) -> None:
    trials = read_trials(run)
    one = trials[(trials["planner"] == trials["planner"].iloc[0]) & (trials["n_obstacles"] == 1)]
    names = [f"temporal-ct[budget={k}]" for k in range(25)]
    many = pd.concat([one.assign(planner=name) for name in names])
    figure = plot(kind, many, (), Asked(), tmp_path / "a.svg").figure
    figure.draw_without_rendering()
    (axis,), (legend,) = figure.axes, figure.legends
    assert len(legend.get_texts()) == 25
    assert axis.get_window_extent().height > 0.9 * figure.dpi
    shown = legend.get_window_extent()
    assert shown.x0 >= 0
    assert shown.x1 <= figure.bbox.x1


def test_a_run_of_bounds_alone_has_no_profile(run, tmp_path) -> None:
    with pytest.raises(SuiteError, match="profile: found no trials to draw"):
        plot("profile", read_trials(run).assign(is_bound=True), (), Asked(), tmp_path / "a.svg")
