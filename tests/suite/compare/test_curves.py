import json

import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st
from test_tables import make_row

from scenarios import SpecError
from suite.compare.conditions import line_of, pool, telling_apart, values_of
from suite.compare.curves import curves, swept
from suite.compare.statistics import wilson_interval
from suite.compare.tables import summarize
from suite.errors import SuiteError
from suite.store.frames import trials_frame

SETTINGS = json.dumps({"horizon": 3})


def trials_of(*rows: dict[str, object]) -> pd.DataFrame:
    base = {"arm": "default", "family_parameters": "default", "settings": SETTINGS, "prediction_margin": 0.0}
    return trials_frame(
        make_row(
            str(row.get("planner", "pf")),
            number,
            **{"success": True, "success_swept": row.get("success", True)}
            | base
            | {key: value for key, value in row.items() if key != "planner"},
        )
        for number, row in enumerate(rows)
    )


def test_conditions_in_texts_have_values() -> None:
    trials = trials_of(
        {"family_parameters": "max_speed_m_s=0.03,redraw=False"},
        {"arm": "radius_m=0.01", "planner": "rrt[budget=0.1]"},
        {"planner": "rrt", "settings": "{}"},
        {"family_parameters": None, "settings": None},
    ).sort_values("scenario_id")
    assert values_of(trials, "max_speed_m_s").tolist()[:3] == [0.03, 0.015, 0.015]  # the default's where none is given
    assert values_of(trials, "redraw").tolist()[:2] == [False, True]
    assert values_of(trials, "radius_m").tolist() == [0.018, 0.01, 0.018, 0.018]
    assert values_of(trials, "horizon").tolist()[:2] == [3, 3]
    assert pd.isna(values_of(trials, "horizon").iloc[2])
    budgets = values_of(trials, "budget").tolist()
    assert budgets[1:3] == [0.1, 1.0]
    assert pd.isna(budgets[0])  # of a planner that has no budget anywhere
    with pytest.raises(SpecError, match="nearest: noise_mm"):
        values_of(trials, "noise")


def test_a_line_is_a_planner_without_what_is_on_the_axis() -> None:
    assert line_of("temporal[horizon=3,target=closest]", "horizon") == "temporal[target=closest]"
    assert line_of("rrt[budget=0.1]", "budget") == "rrt"
    assert line_of("rrt", "budget") == "rrt"


def test_points_are_counted_and_never_mix_conditions() -> None:
    places = [(noise, n, k) for noise in (0.0, 2.0) for n in (0, 1) for k in range(4)]
    trials = trials_of(*({"noise_mm": noise, "n_obstacles": n, "success": k < 3 - noise - n} for noise, n, k in places))
    found = curves(trials, "noise_mm")
    assert [dict(panel.conditions) for panel in found.panels] == [{"n_obstacles": 0}, {"n_obstacles": 1}]
    for panel in found.panels:
        (line,) = panel.lines
        for point in line.points:
            wins = 3 - int(point.at) - panel.conditions["n_obstacles"]
            low, high = wilson_interval(wins, 4)
            assert (point.trials, point.percent) == (4, 25 * wins)
            assert (point.low, point.high) == (100 * low, 100 * high)
    pooled = curves(trials, "noise_mm", by=())
    (panel,) = pooled.panels
    assert [(point.trials, point.percent) for point in panel.lines[0].points] == [(8, 62.5), (8, 12.5)]
    assert str(pooled.pooled) == "Pooled, as asked, over n_obstacles (0, 1)."


def test_a_condition_that_goes_along_has_no_panel() -> None:
    """Two ends of a range, moved together: one panel, and the other end is named."""
    texts = [f"min_distance_m={low},max_distance_m={low + 0.1}" for low in (0.2, 0.3, 0.4)]
    found = curves(trials_of(*({"family_parameters": text} for text in texts)), "max_distance_m")
    assert [len(line.points) for panel in found.panels for line in panel.lines] == [3]
    assert found.beside == ["min_distance_m"]


def test_settings_make_points_and_planners_without_them_levels() -> None:
    rows = [{"planner": f"temporal[horizon={h}]", "settings": json.dumps({"horizon": h})} for h in (2, 3)]
    trials = trials_of(*rows, {"planner": "pf", "settings": "{}"})
    found = curves(trials, None, planners=("pf", "temporal[horizon=2]"))
    assert found.over == "horizon"
    assert [(line.planner, [point.at for point in line.points]) for line in found.panels[0].lines] == [
        ("pf", [None]), ("temporal", [2, 3]),
    ]  # fmt: skip


def test_unlike_conditions_of_one_planner_are_lines() -> None:
    rows = [{"noise_mm": noise, "predictor": name} for noise in (0.0, 1.0) for name in ("arc", "cubic")]
    found = curves(trials_of(*rows), "noise_mm")
    assert [line.planner for line in found.panels[0].lines] == ["pf, arc", "pf, cubic"]


def test_nothing_swept_is_one_line() -> None:
    with pytest.raises(SuiteError, match="found no condition in which trials differ"):
        swept(trials_of({}, {}))


DRAWN = st.tuples(
    st.sampled_from([0, 1, 2]), st.sampled_from([0.0, 1.0]), st.sampled_from(["pf", "rrt"]), st.booleans()
)


@given(st.lists(DRAWN, min_size=1, max_size=40))
def test_a_pooled_table_counts_every_trial_once(drawn: list[tuple[int, float, str, bool]]) -> None:
    """Against counting by hand."""
    trials = trials_of(
        *({"n_obstacles": n, "noise_mm": noise, "planner": planner, "success": won} for n, noise, planner, won in drawn)
    )
    pooled = pool(trials, ["n_obstacles"])
    table = summarize(pooled.trials)
    counted = {(row.n_obstacles, row.planner): (row.trials, row.success_swept_percent) for row in table.itertuples()}
    by_hand: dict[tuple[int, str], list[bool]] = {}
    for n, _, planner, won in drawn:
        by_hand.setdefault((n, planner), []).append(won)
    if len({n for n, *_ in drawn}) == 1:
        assert set(pooled.over) <= {"noise_mm"}
    assert counted == {key: (len(wins), 100 * sum(wins) / len(wins)) for key, wins in by_hand.items()}
    assert ("noise_mm" in pooled.over) == (len({noise for _, noise, *_ in drawn}) == 2)


def test_what_is_told_apart_stays_and_the_rest_is_not_claimed() -> None:
    trials = trials_of(
        {"family_parameters": "max_speed_m_s=0.03,redraw=False", "arm": "radius_m=0.01"},
        {"family_parameters": "default"},
    )
    kept = pool(trials, ["max_speed_m_s"]).trials
    assert set(kept["family_parameters"]) == {"max_speed_m_s=0.03", "max_speed_m_s=0.015"}
    assert kept["arm"].isna().all()


def test_trials_of_one_planner_on_one_scenario_are_told_apart() -> None:
    twice = trials_of({"scenario_id": "a", "noise_mm": 0.0}, {"scenario_id": "a", "noise_mm": 1.0})
    assert telling_apart(twice) == ["noise_mm"]
    assert telling_apart(trials_of({}, {"noise_mm": 1.0})) == []
