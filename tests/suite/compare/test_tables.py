import math

import pandas as pd
import pytest

from scenarios import UserError
from suite.compare.pairs import compare_in_pairs
from suite.compare.published import beside, published_file, read_published
from suite.compare.statistics import wilson_interval
from suite.compare.tables import summarize
from suite.errors import SuiteError
from suite.show.latex import as_latex
from suite.show.text import as_csv, as_markdown_page, render, render_pairs
from suite.store.frames import TABLE_TYPES, read_trials_csv, trials_csv, trials_frame
from suite.trial.columns import COLUMNS, Row, complete_row


def make_row(planner: str, number: int, *, success: bool, **others: object) -> Row:
    base = {
        "scenario_id": f"orbit-n3-s0-{number:04d}",
        "scenario_hash": f"{number:016x}",
        "family": "orbit",
        "n_obstacles": 3,
        "planner": planner,
        "predictor": "cubic",
        "limits": False,
        "noise_mm": 0.0,
        "dropout": 0.0,
        "experiment_seed": 3,
        "outcome": "reached" if success else "collided",
        "success_per_step": success,
        "planning_time_s": 1.0 + number,
        "solve_p50_s": 0.001,
        "arrival_time_s": 10.0 + number if success else None,
    }
    return complete_row(base | others)


def make_trials(**successes: list[bool]) -> pd.DataFrame:
    return trials_frame(
        make_row(planner, number, success=success)
        for planner, outcomes in successes.items()
        for number, success in enumerate(outcomes)
    )


def test_failures_stay_in_success_and_planning_time() -> None:
    """Of trials that took 1, 2, 3 and 4 s to plan, the first two arrived: theirs alone would be 1.5 s."""
    (row,) = summarize(make_trials(pf=[True, True, False, False])).to_dict("records")
    assert (row["trials"], row["reached"], row["success_per_step_percent"]) == (4, 2, 50.0)
    assert (row["planning_time_mean_s"], row["planning_time_median_s"]) == (2.5, 2.5)
    assert row["arrival_median_s"] == 10.5  # of the two that arrived, after 10 and 11 s
    low, high = wilson_interval(2, 4)
    assert (row["success_per_step_low"], row["success_per_step_high"]) == (100 * low, 100 * high)


def test_a_killed_trial_counts_as_a_failure_and_as_an_error() -> None:
    rows = [make_row("pf", 0, success=True), make_row("pf", 1, success=False, outcome="planner_hung")]
    (row,) = summarize(trials_frame(rows)).to_dict("records")
    assert (row["success_per_step_percent"], row["errors"]) == (50.0, 1)
    assert "errors" in render(summarize(trials_frame(rows)), "markdown")


def test_a_verdict_that_nobody_gave_is_not_zero() -> None:
    summary = summarize(make_trials(pf=[False, False]))
    assert math.isnan(summary["success_swept_percent"][0])
    assert summary["success_per_step_percent"][0] == 0.0
    assert "| -" in render(summary, "markdown")


def test_planners_come_in_the_order_asked_for() -> None:
    trials = make_trials(a=[True], b=[True], c=[True])
    assert list(summarize(trials, ["c", "b"])["planner"]) == ["c", "b", "a"]


def test_groups_do_not_mix() -> None:
    rows = [make_row("pf", k, success=k < n, n_obstacles=n) for n in (1, 2, 10) for k in range(3)]
    summary = summarize(trials_frame(rows))
    assert list(zip(summary["n_obstacles"], summary["success_per_step_percent"].round(), strict=True)) == [
        (1, 33), (2, 67), (10, 100),
    ]  # fmt: skip


def test_a_bound_stands_last_and_successes_are_shares_of_its() -> None:
    trials = make_trials(clairvoyant=[True, True, True, False], rrt=[True, False, False, False], pf=[True] * 4)
    summary = summarize(trials, ["clairvoyant", "rrt", "pf"]).set_index("planner")
    assert list(summary.index) == ["rrt", "pf", "clairvoyant"]
    assert summary["is_bound"].tolist() == [False, False, True]
    shares = summary["success_per_step_of_bound_percent"]
    assert shares["rrt"] == pytest.approx(100 / 3)
    assert shares["pf"] == pytest.approx(400 / 3)  # what a bound fails at is not shown to be impossible
    assert math.isnan(shares["clairvoyant"])
    assert math.isnan(summary.loc["rrt", "success_swept_of_bound_percent"])  # nobody was judged
    text = render(summary.reset_index(), "markdown")
    assert "clairvoyant (bound)" in text
    assert "of possible" in text
    assert "of possible" not in render(summarize(make_trials(pf=[True])), "markdown")


def test_shares_are_over_the_scenarios_that_both_were_tried_on() -> None:
    rows = [make_row("clairvoyant", k, success=True) for k in range(2)]
    rows += [make_row("clairvoyant[restarts=1]", 2, success=True)]  # a second bound shows more to be possible
    rows += [make_row("pf", k, success=k != 1) for k in range(5)]
    summary = summarize(trials_frame(rows)).set_index("planner")
    assert summary.loc["pf", "success_per_step_of_bound_percent"] == pytest.approx(200 / 3)


def test_a_bound_is_compared_in_pairs_only_when_asked_for() -> None:
    trials = make_trials(clairvoyant=[True, True], rrt=[True, False], pf=[True, False])
    assert set(compare_in_pairs(trials, "rrt", "per_step")["planner"]) == {"pf"}
    assert set(compare_in_pairs(trials, "clairvoyant", "per_step")["planner"]) == {"rrt", "pf"}


def test_trials_survive_the_csv(tmp_path) -> None:
    trials = make_trials(pf=[True, False], rrt=[False, True])
    (tmp_path / "trials.csv").write_text(trials_csv(trials))
    again = read_trials_csv(tmp_path / "trials.csv")
    pd.testing.assert_frame_equal(again, trials)
    assert trials_csv(again) == trials_csv(trials)
    assert {name: str(dtype) for name, dtype in again.dtypes.items()} == {c.name: c.dtype for c in COLUMNS}


def test_the_csv_does_not_depend_on_the_order_of_finishing() -> None:
    rows = [make_row(planner, k, success=True) for planner in ("pf", "rrt") for k in range(3)]
    assert trials_csv(trials_frame(rows)) == trials_csv(trials_frame(rows[::-1]))


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("", "cannot be read"),
        ("scenario_id\nx\n", "found no column scenario_hash"),
        (",".join(c.name for c in COLUMNS) + "\n" + ",".join("?" for _ in COLUMNS) + "\n", "cannot be read"),
    ],
)
def test_a_broken_trials_file_is_one_line(tmp_path, text: str, line: str) -> None:
    (tmp_path / "trials.csv").write_text(text)
    with pytest.raises(UserError, match=line) as caught:
        read_trials_csv(tmp_path / "trials.csv")
    assert "\n" not in str(caught.value)


def test_the_published_table_is_the_papers() -> None:
    published = read_published(published_file("published")).set_index(["planner", "n_obstacles"])
    assert [published.loc[("T3", n), "success_percent"] for n in (1, 3, 5, 6)] == [93, 72, 56, 46]


def test_published_numbers_stand_beside_equal_planners_whatever_their_name() -> None:
    summary = summarize(make_trials(t2=[True], t3=[True], temporal=[True], rrt=[True]))
    joined = beside(summary, read_published(published_file("published"))).set_index("planner")
    assert joined["published_success_percent"].dropna().to_dict() == {"t2": 69, "t3": 72, "temporal": 72}
    assert joined.loc["temporal", "published_time_s"] == 50.61
    assert "published %" in render(joined.reset_index(), "markdown")


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("planner,n_obstacles\n", "found no column time_s"),
        ("planner,n_obstacles,time_s,success_percent,trials\nT2,many,1,2,3\n", "cannot be read"),
        (
            "planner,n_obstacles,time_s,success_percent,trials\nT2,1,1,2,3\nT2,1,1,2,3\n",
            "two rows for T2 and n_obstacles 1",
        ),
    ],
)
def test_a_broken_published_file_is_one_line(tmp_path, text: str, line: str) -> None:
    (tmp_path / "theirs.csv").write_text(text)
    with pytest.raises(UserError, match=line) as caught:
        read_published(tmp_path / "theirs.csv")
    assert "\n" not in str(caught.value)


def test_pairs_by_hand() -> None:
    trials = make_trials(
        ref=[True] * 8 + [False] * 2,
        bad=[False] * 8 + [True, False],  # eight lost, one won: p = 2 * (1 + 9) / 2^9
        same=[True] * 8 + [False] * 2,
    )
    pairs = compare_in_pairs(trials, "ref", "per_step").set_index("planner")
    assert pairs.loc["bad", ["scenarios", "only_planner", "only_reference"]].tolist() == [10, 1, 8]
    assert pairs.loc["bad", "p_mcnemar"] == pytest.approx(0.0390625)
    assert pairs.loc["bad", "p_holm"] == pytest.approx(2 * 0.0390625)
    assert pairs.loc["same", ["p_mcnemar", "p_holm"]].tolist() == [1.0, 1.0]


def test_pairs_use_only_scenarios_that_both_were_tried_on() -> None:
    pairs = compare_in_pairs(make_trials(ref=[True, True, False], other=[False]), "ref", "per_step")
    assert pairs[["scenarios", "only_reference"]].to_numpy().tolist() == [[1, 1]]


def test_a_reference_alone_makes_an_empty_table() -> None:
    assert compare_in_pairs(make_trials(ref=[True]), "ref", "per_step").empty


def test_an_unknown_reference_lists_the_known_ones() -> None:
    with pytest.raises(SuiteError, match="reference: found 't9', allowed: pf, rrt"):
        compare_in_pairs(make_trials(pf=[True], rrt=[True]), "t9", "per_step")


def test_formats() -> None:
    trials = make_trials(pf=[True, False], rrt=[False, True])
    summary, pairs = summarize(trials), compare_in_pairs(trials, "pf", "per_step")
    for text in (as_latex("name", summary), render_pairs(pairs, "latex")):
        assert text.count(r"\toprule") == text.count(r"\bottomrule") == 1
    for text in (render(summary, "markdown"), render_pairs(pairs, "markdown")):
        assert set(text.splitlines()[1]) == {"|", "-"}
    assert render(summary, "csv") == as_csv(summary)
    assert as_csv(summary).count("\n") == 3
    assert list(summary) == list(TABLE_TYPES)
    page = as_markdown_page("name", summary)
    assert page.startswith("# name\n\nPredictor cubic; motion limits off; observation noise 0 mm; dropout 0; seed 3.\n")
    assert "95 % Wilson interval" in page
