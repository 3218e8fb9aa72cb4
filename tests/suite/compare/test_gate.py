import numpy as np
import pandas as pd
import pytest
from fakes import make_tasks

from suite.compare.gate import Bar, Comparison, Judgement, compare_runs, judge_success
from suite.errors import SuiteError
from suite.show.changes import FORMATS, conclusion
from suite.store.frames import trials_frame
from suite.trial.task import trial_row


def run_of(wins: dict[str, list[bool]], **changes: object) -> pd.DataFrame:
    """Trials of planners by label, won or lost as said; ``changes`` are columns, in values or lists of values."""
    rows = []
    for label, won in wins.items():
        for k, (task, success) in enumerate(zip(make_tasks([label], len(won)), won, strict=True)):
            measured: dict[str, object] = {
                "outcome": "reached" if success else "collided",
                "success_executable": success,
                "success_swept": success,
                "arrival_time_s": 10.0 + k if success else None,
                "state_checks": 100 + k,
                "motion_checks": 7,
                "n_solves": 1,
                "tip_path_length_m": 0.3,
                "smoothness_paper_rad": 2.0,
                "planning_time_s": 0.1,
                "solve_p50_s": 0.1,
            }
            own = {name: value[k] if isinstance(value, list) else value for name, value in changes.items()}
            rows.append(trial_row(task, measured) | own)
    return trials_frame(rows)


def judged(found: Comparison, planner: str = "a", quantity: str = "success") -> Judgement:
    (finding,) = [one for one in found.findings if (one.planner, one.quantity) == (planner, quantity)]
    return finding.judgement


def flipped(won: list[bool], *, to_lost: int = 0, to_won: int = 0) -> list[bool]:
    turned = list(won)
    for value, count in ((True, to_lost), (False, to_won)):
        for k in [k for k, one in enumerate(won) if one is value][:count]:
            turned[k] = not value
    return turned


HALF = [True, False] * 200


def test_equal_rows_are_unchanged_whatever_the_clock_says() -> None:
    found = compare_runs(run_of({"a": HALF}), run_of({"a": HALF}, planning_time_s=9.0, trial_wall_s=3.0), Bar())
    assert {one.judgement for one in found.findings} == {Judgement.UNCHANGED, Judgement.NOT_JUDGED}
    assert {one.quantity for one in found.of(Judgement.NOT_JUDGED)} == {"planning_time_s", "solve_p50_s"}
    assert conclusion(found) == "No regression."


@pytest.mark.parametrize(
    ("lost", "won", "expected"),
    [
        (30, 10, Judgement.REGRESSION),
        (10, 30, Judgement.BETTER),
        (10, 10, Judgement.NON_INFERIOR),
        (26, 16, Judgement.INCONCLUSIVE),
        (9, 0, Judgement.NON_INFERIOR),  # surely lost something, and surely less than the margin
    ],
)
def test_success_is_judged_in_pairs(lost: int, won: int, expected: Judgement) -> None:
    new = run_of({"a": flipped(HALF, to_lost=lost, to_won=won)})
    found = compare_runs(run_of({"a": HALF}), new, Bar())
    assert judged(found) == expected == judge_success(lost, won, 400, Bar())
    (finding,) = [one for one in found.findings if one.quantity == "success"]
    assert (finding.only_base, finding.only_new, finding.pairs) == (lost, won, 400)
    assert finding.change == pytest.approx((won - lost) / 4)


def test_a_wider_margin_forgives_more() -> None:
    assert judge_success(30, 10, 400, Bar(margin=9.0)) == Judgement.NON_INFERIOR
    assert judge_success(30, 10, 400, Bar(alpha=0.0001)) == Judgement.INCONCLUSIVE


def test_many_planners_ask_for_more() -> None:
    """16 lost and 6 won are one-sided p = 0.026: a regression of one planner, not of the worst of three."""
    worse = flipped(HALF, to_lost=16, to_won=6)
    bar = Bar(margin=4.0)
    alone = compare_runs(run_of({"a": HALF}), run_of({"a": worse}), bar)
    others = dict.fromkeys("bc", flipped(HALF, to_lost=3, to_won=3))
    among = compare_runs(run_of(dict.fromkeys("abc", HALF)), run_of({"a": worse} | others), bar)
    assert (judged(alone), judged(among)) == (Judgement.REGRESSION, Judgement.INCONCLUSIVE)


def test_other_success_can_be_chosen() -> None:
    new = run_of({"a": HALF}, success_swept=flipped(HALF, to_lost=60))
    assert judged(compare_runs(run_of({"a": HALF}), new, Bar())) == Judgement.NON_INFERIOR
    assert judged(compare_runs(run_of({"a": HALF}), new, Bar(verdict="swept"))) == Judgement.REGRESSION


def test_costs_count_where_both_solve_only() -> None:
    checks = [100 + k if won else 10**6 for k, won in enumerate(HALF)]
    found = compare_runs(run_of({"a": HALF}), run_of({"a": HALF}, state_checks=checks), Bar())
    assert judged(found, quantity="state_checks") == Judgement.NON_INFERIOR
    (finding,) = [one for one in found.findings if one.quantity == "state_checks"]
    assert (finding.pairs, finding.change) == (200, pytest.approx(0.0))


@pytest.mark.parametrize(
    ("factor", "expected"),
    [(1.3, Judgement.REGRESSION), (0.7, Judgement.BETTER), (1.02, Judgement.NON_INFERIOR)],
)
def test_counts_are_judged_beyond_what_makes_no_difference(factor: float, expected: Judgement) -> None:
    rng = np.random.default_rng(0)
    checks = [int((100 + k) * factor * np.exp(rng.normal(scale=0.2))) for k in range(400)]
    found = compare_runs(run_of({"a": HALF}), run_of({"a": HALF}, state_checks=checks), Bar())
    assert judged(found, quantity="state_checks") == expected


def test_times_are_never_judged() -> None:
    found = compare_runs(run_of({"a": HALF}), run_of({"a": flipped(HALF, to_won=1)}, planning_time_s=50.0), Bar())
    assert judged(found, quantity="planning_time_s") == Judgement.NOT_JUDGED


def test_what_has_no_partner_is_named() -> None:
    base, new = run_of({"a": HALF[:20], "b": HALF[:20]}), run_of({"a": HALF[:18]})
    found = compare_runs(base, new, Bar())
    assert set(found.missing) == {
        "a, fake: 2 not in NEW: fake-0018, fake-0019",
        "b, fake: 20 not in NEW: fake-0000, fake-0001, fake-0002 and 17 more",
    }
    assert {one.planner for one in found.findings} == {"a"}
    assert not compare_runs(run_of({"b": HALF[:2]}), run_of({"a": HALF[:2]}), Bar()).findings


def test_conditions_keep_pairs_apart_unless_asked() -> None:
    base, new = run_of({"a": HALF}), run_of({"a": flipped(HALF, to_lost=50)}, predictor="arc")
    apart = compare_runs(base, new, Bar())
    assert not apart.findings
    assert apart.missing[-1] == "a: predictor cubic in BASE, arc in NEW; --across predictor pairs them all the same"
    across = compare_runs(base, new, Bar(across=("predictor",)))
    assert judged(across) == Judgement.REGRESSION
    assert "a: predictor cubic in BASE, arc in NEW" in across.differing
    with pytest.raises(SuiteError, match=r"--across: found 'colour', allowed limits, "):
        compare_runs(base, new, Bar(across=("colour",)))


def test_several_seeds_of_one_scenario_are_paired_like_with_like() -> None:
    lost = [False] * 10
    base = pd.concat([run_of({"a": [True] * 10}, experiment_seed=1), run_of({"a": lost}, experiment_seed=2)])
    new = pd.concat([run_of({"a": lost}, experiment_seed=2), run_of({"a": [True] * 10}, experiment_seed=1)])
    found = compare_runs(base, new, Bar())
    assert judged(found) == Judgement.UNCHANGED
    assert next(one.pairs for one in found.findings if one.quantity == "success") == 20


def test_settings_that_differ_are_said() -> None:
    found = compare_runs(run_of({"a": HALF}), run_of({"a": HALF}, settings='{"gain":2.0}'), Bar())
    assert found.differing == ('a: settings {"gain":0.5} in BASE, {"gain":2.0} in NEW',)


@pytest.mark.parametrize("wrong", [{"margin": 0.0}, {"alpha": 0.6}, {"cost_margin": float("nan")}, {"margin": 200.0}])
def test_a_bar_out_of_range_is_refused(wrong: dict[str, float]) -> None:
    with pytest.raises(SuiteError, match="allowed above 0, up to"):
        Bar(**wrong)


def test_every_format_says_what_got_worse() -> None:
    new = run_of({"a": flipped(HALF, to_lost=60), "b": HALF})
    found = compare_runs(run_of({"a": HALF, "b": HALF}), new, Bar())
    for write in FORMATS.values():
        assert "regression" in write(found).lower()
    text = FORMATS["text"](found)
    assert "Worse:" in text
    assert "Unchanged" in text
    assert text.endswith("Regression: a success.\n")
    assert max(map(len, text.splitlines())) <= 80
