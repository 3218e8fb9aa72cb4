"""What is possible, from both sides."""

import pandas as pd
from hypothesis import given
from hypothesis import strategies as st

from suite.compare.possible import numbered, possible, scenarios_frame
from suite.compare.tables import summarize
from suite.show.text import render
from suite.store.frames import trials_frame
from suite.trial.columns import complete_row

PLANNERS = ("rrt", "pf", "clairvoyant")
outcomes = st.lists(
    st.tuples(*[st.booleans()] * len(PLANNERS), st.sampled_from([None, "base", "section 1"])), min_size=1, max_size=12
)


def make_trials(scenarios: list[tuple[bool, bool, bool, str | None]]) -> pd.DataFrame:
    """A row per planner and scenario; only a bound that fails says why nobody can."""
    return trials_frame(
        complete_row(
            {
                "scenario_id": f"orbit-{number}",
                "scenario_hash": f"{number:016x}",
                "family": "orbit",
                "n_obstacles": 3,
                "planner": planner,
                "is_bound": planner == "clairvoyant",
                "outcome": "reached" if success else "collided",
                "success_executable": success,
                "impossible_reason": reason if planner == "clairvoyant" and not success else None,
                "impossible_from_s": 9.5 if reason and planner == "clairvoyant" and not success else None,
            }
        )
        for number, (*successes, reason) in enumerate(scenarios)
        for planner, success in zip(PLANNERS, successes, strict=True)
    )


def answer_of(scenario: tuple[bool, bool, bool, str | None]) -> str:
    *successes, reason = scenario
    return "yes" if any(successes) else "impossible" if reason else "open"


@given(outcomes)
def test_it_is_what_somebody_did_or_what_is_proven(scenarios) -> None:
    trials = make_trials(scenarios)
    expected = [answer_of(scenario) for scenario in scenarios]
    of_trials = possible(trials, numbered(trials))
    assert of_trials.tolist() == [expected[int(name.removeprefix("orbit-"))] for name in trials["scenario_id"]]
    frame = scenarios_frame(trials).sort_values("scenario_hash")
    assert frame["possible"].tolist() == expected
    for solved_by, scenario in zip(frame["solved_by"], scenarios, strict=True):
        assert solved_by.split() == sorted(p for p, s in zip(PLANNERS, scenario, strict=False) if s)
    for _, row in summarize(trials).iterrows():
        counts = [row[f"scenarios_{name}"] for name in ("possible", "open", "impossible")]
        assert counts == [expected.count(name) for name in ("yes", "open", "impossible")]


def test_a_table_says_of_how_many() -> None:
    yes, blocked, left_open = (True, False, True, None), (False, False, False, "base"), (False, False, False, None)
    table = render(summarize(make_trials([yes, yes, (False, True, True, None), blocked, left_open])), "markdown")
    assert "| 2 of 3 to 4 " in table
    assert "| 1 of 3 to 4 " in table
    assert "| 2 of 3 " in render(summarize(make_trials([yes, yes, (False, True, True, None), blocked])), "markdown")


def test_a_success_is_stronger_than_a_proof() -> None:
    """It cannot be; should it ever, what was done and audited stands."""
    trials = make_trials([(True, False, False, "base")])
    assert set(possible(trials, numbered(trials))) == {"yes"}
