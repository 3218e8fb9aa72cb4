"""A report counts what the rows say, and keeps within its size."""

import json
import re
from pathlib import Path

import pandas as pd
import pytest
from fake_runs import run_with_fakes

import suite
from suite.cli.main import main
from suite.show.report.data import entries, entry_of, failures, headline, times
from suite.show.report.page import report_page


@pytest.fixture(scope="module")
def run(tmp_path_factory) -> Path:
    """Two planners under two noises, of made-up trials."""
    folder = tmp_path_factory.mktemp("reports") / "run"
    run_with_fakes(folder, obstacles=(1, 3), trials=6, noise_mm=(0.0, 2.0))
    return folder


def data_of(text: str) -> dict:
    return json.loads(re.search(r'id="data">(.*?)</script>', text, re.DOTALL)[1])


def test_every_trial_is_in_the_row_of_the_table_that_counts_it(run) -> None:
    trials, summary = suite.load(run).trials, suite.load(run).table()
    rows = pd.Series(entry_of(trials, summary))
    assert rows.value_counts().sort_index().tolist() == summary["trials"].tolist()
    for k, (planner, n, noise) in enumerate(
        zip(summary["planner"], summary["n_obstacles"], summary["noise_mm"], strict=True)
    ):
        theirs = trials[rows == k]
        assert set(theirs["planner"]) == {planner}
        assert set(theirs["n_obstacles"]) == {n}
        assert set(theirs["noise_mm"]) == {noise}
    assert entries(summary)[0]["place"] == "1 obstacle, noise mm 0"


def test_failures_and_successes_add_up(run) -> None:
    trials = suite.load(run).trials
    for each in failures(trials, ["pf", "rrt"]):
        theirs = trials[trials["planner"] == each["planner"]]
        assert each["n"] == len(theirs)
        for verdict, kinds in each["kinds"].items():
            assert sum(kinds.values()) == (theirs[f"success_{verdict}"] == False).sum()  # noqa: E712  missing is not False
        assert sum(each["touched"].values()) == theirs["contact_section"].notna().sum()


def test_times_are_of_all_trials(run) -> None:
    trials = suite.load(run).trials
    for each in times(trials, ["pf", "rrt"]):
        spent = trials.loc[trials["planner"] == each["planner"], "planning_time_s"]
        assert each["n"] == len(spent)
        assert each["seconds"][0] == pytest.approx(spent.min(), rel=1e-3)
        assert each["seconds"][-1] == pytest.approx(spent.max(), rel=1e-3)


def test_the_headline_names_the_best_under_each_condition_and_no_bound() -> None:
    def entry(planner: str, place: str, percent: float, bound: bool = False) -> dict:
        return {"label": planner, "place": place, "bound": bound, "success": {"swept": [percent, 0.0, 100.0]}}

    said = [
        entry("a", "1", 50.0),
        entry("b", "1", 60.0),
        entry("c", "1", 90.0, True),
        entry("a", "2", 5.0),
        entry("b", "2", 5.0),
    ]
    summary = pd.DataFrame({"planner": ["a", "b", "c"], "trials": [10, 10, 10]})
    assert headline(summary, said, "swept") == (
        "3 planners, 30 trials. Most successes, swept: b with 1 (60 % [0, 100]); a and b with 2 (5 % [0, 100])."
    )


def test_a_report_keeps_within_its_size_and_shows_disagreements_first(run) -> None:
    everything = data_of(report_page(run))
    assert len(everything["episodes"]) == 12
    sizes = {name: len(json.dumps(each)) for name, each in everything["episodes"].items()}
    whole = len(report_page(run))
    small = report_page(run, most_bytes=whole - sum(sizes.values()) // 2)
    assert len(small.encode()) <= whole - sum(sizes.values()) // 2
    kept = data_of(small)["episodes"]
    assert 0 < len(kept) < 12
    won = suite.load(run).trials.groupby("scenario_id")["success_swept"].agg(["any", "all"])
    disagreed = set(won.index[won["any"] & ~won["all"]])
    assert set(kept) <= disagreed or disagreed <= set(kept)


def test_a_run_that_kept_rows_only_has_a_report_without_replays(run, tmp_path, capfd) -> None:
    suite.load(run).trials.to_csv(tmp_path / "trials.csv", index=False)
    assert main(["report", str(tmp_path), "-o", str(tmp_path / "a.html")]) == 0
    data = data_of((tmp_path / "a.html").read_text(encoding="utf-8"))
    assert data["episodes"] == {}
    assert len(data["trials"]["entry"]) == data["count"] == len(suite.load(run).trials)


def test_what_cannot_be_written_is_a_line(run, tmp_path, capfd) -> None:
    assert main(["report", str(run), "-o", str(tmp_path / "a.pdf")]) == 2
    assert main(["report", str(tmp_path)]) == 2
    assert len(capfd.readouterr().err.splitlines()) == 2
