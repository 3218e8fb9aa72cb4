import pandas as pd
import pytest
from test_tables import make_row

from suite.compare.pairs import compare_in_pairs
from suite.compare.tables import summarize
from suite.show.conditions import column, sentence, varying
from suite.show.text import as_csv, as_markdown_page, render, render_pairs
from suite.store.frames import read_table_csv, read_trials_csv, trials_csv, trials_frame

UNLIKE = {
    "family_parameters": ("default", "max_speed_m_s=0.03"),
    "arm": ("default", "radius_m=0.015"),
    "limits": (False, True),
    "noise_mm": (0.0, 5.0),
    "dropout": (0.0, 0.5),
    "experiment_seed": (3, 4),
    "settings": ('{"gain":0.5,"depth":3}', '{"gain":0.25,"depth":3}'),
    "predictor": ("arc", "cubic"),
    "prediction_margin": (0.0, 1.0),
}


def unlike_trials(name: str, planners: dict[str, float]) -> pd.DataFrame:
    """Four scenarios under each of two values of a condition; under the second, planners win a share of them."""
    rows = []
    for value, is_second in zip(UNLIKE[name], (False, True), strict=True):
        for planner, share in planners.items():
            for k in range(4):
                rows.append(make_row(planner, k, success=not is_second or k < 4 * share, **{name: value}))
    return trials_frame(rows)


@pytest.mark.parametrize("name", UNLIKE)
def test_rows_of_unlike_conditions_are_rows_of_their_own(name: str, tmp_path) -> None:
    (tmp_path / "trials.csv").write_text(trials_csv(unlike_trials(name, {"pf": 0.25})))
    summary = summarize(read_trials_csv(tmp_path / "trials.csv"))
    assert summary[name].tolist() == list(UNLIKE[name]) or name == "settings"
    assert sorted(summary["success_per_step_percent"]) == [25, 100]
    assert summary["trials"].tolist() == [4, 4]
    assert varying(summary) == [name]
    told = {
        "family_parameters": "max_speed_m_s=0.03", "arm": "radius_m=0.015", "limits": "on", "noise_mm": "5",
        "dropout": "0.5", "experiment_seed": "4", "settings": "gain=0.25", "predictor": "arc",
        "prediction_margin": "1",
    }  # fmt: skip
    cells = [cell.strip() for line in render(summary, "markdown").splitlines() for cell in line.split("|")]
    assert told[name] in cells
    (tmp_path / "table.csv").write_text(as_csv(summary))
    assert render(read_table_csv(tmp_path / "table.csv"), "markdown") == render(summary, "markdown")
    assert sentence(read_table_csv(tmp_path / "table.csv")) == sentence(summary)


def test_what_all_have_in_common_stands_above_the_table() -> None:
    conditions = {"arm": "default", "family_parameters": "default", "prediction_margin": 0.0}
    rows = [make_row("pf", 0, success=True, **conditions), make_row("t2", 0, success=True, **conditions)]
    rows += [make_row("rrt", 0, success=True, **conditions | {"predictor": "gp", "prediction_margin": 1.0})]
    summary = summarize(trials_frame(rows), ["t2", "pf", "rrt"])
    assert varying(summary) == []
    said = (
        "Predictor cubic (t2, pf), gp (rrt); prediction margin 0 (t2, pf), 1 (rrt); family parameters default;"
        " arm default; motion limits off; observation noise 0 mm; dropout 0; seed 3."
    )
    assert sentence(summary) == said
    assert said in as_markdown_page("run", summary)


def test_what_varies_is_not_said_to_be_common() -> None:
    assert "noise" not in sentence(summarize(unlike_trials("noise_mm", {"pf": 1.0})))


def test_a_bounds_shares_are_of_the_same_conditions() -> None:
    summary = summarize(unlike_trials("noise_mm", {"clairvoyant": 1.0, "pf": 0.5})).set_index(["noise_mm", "planner"])
    shares = summary["success_per_step_of_bound_percent"]
    assert (shares[0.0, "pf"], shares[5.0, "pf"]) == (100, 50)


def test_a_bound_may_have_a_predictor_of_its_own() -> None:
    rows = [make_row("clairvoyant", 0, success=True, predictor="truth"), make_row("pf", 0, success=True)]
    assert summarize(trials_frame(rows))["success_per_step_of_bound_percent"][0] == 100


@pytest.mark.parametrize("name", ["arm", "noise_mm", "predictor"])
def test_pairs_compare_like_with_like(name: str) -> None:
    pairs = compare_in_pairs(unlike_trials(name, {"pf": 0.25, "rrt": 0.75}), "pf", "per_step")
    assert pairs[["scenarios", "only_planner", "only_reference"]].to_numpy().tolist() == [[4, 0, 0], [4, 2, 0]]
    assert pairs[name].tolist() == list(UNLIKE[name])
    assert column(pairs, name)[0] in render_pairs(pairs, "markdown")
    assert varying(pairs) == [name]


def test_planners_with_predictors_of_their_own_meet() -> None:
    rows = [make_row("pf", 0, success=True), make_row("rrt", 0, success=False, predictor="gp")]
    assert compare_in_pairs(trials_frame(rows), "pf", "per_step")["only_reference"].tolist() == [1]
