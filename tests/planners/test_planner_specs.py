"""The notation of planners: what is meant is read, what is not is one line that lists what is."""

import pickle

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planners import ALIASES, PLANNERS, PlannerSpec, check_fit, parse_planner, split_specs
from planners.spec import planner_class
from scenarios import ContinuumArm, ScenarioError, SpecError


@pytest.mark.parametrize("name", [*PLANNERS, *ALIASES])
def test_every_name_alone_is_a_spec(name: str) -> None:
    spec = parse_planner(name)
    assert spec.name == ALIASES.get(name, (name,))[0]
    assert spec.label == str(spec) == name
    assert spec.settings == PLANNERS[spec.name].settings_model.model_validate(ALIASES.get(name, (name, {}))[1])
    assert pickle.loads(pickle.dumps(spec)) == spec


@pytest.mark.parametrize("name", PLANNERS)
def test_every_setting_is_described_and_its_default_allowed(name: str) -> None:
    settings_of = PLANNERS[name].settings_model
    for key, field in settings_of.model_fields.items():
        assert field.description, key
        spec = parse_planner(f"{name}[{key}={field.default}]")
        assert getattr(spec.settings, key) == field.default


def test_t2_and_t3_are_temporal() -> None:
    assert parse_planner("t2").settings.horizon == 2
    assert parse_planner("t3").settings == parse_planner("temporal").settings
    assert parse_planner("temporal[horizon=3]").settings == parse_planner("temporal").settings
    assert parse_planner("t3[waiting=false]").settings.waiting is False


def test_the_papers_reading_is_the_default_and_the_idea_at_its_best_has_a_name() -> None:
    t3, best = parse_planner("t3").settings, parse_planner("temporal-best").settings
    assert (t3.transitions, t3.target) == ("edges", "closest")
    assert best == t3.model_copy(update={"transitions": "chained", "target": "reachable"})


def test_blanks_do_not_matter() -> None:
    spec = parse_planner("  rrt [ range = 3 , goal_bias = 0.1 ] ")
    assert spec.label == "rrt[range=3,goal_bias=0.1]"
    assert (spec.settings.range, spec.settings.goal_bias) == (3.0, 0.1)
    assert parse_planner(str(spec)) == spec


def test_commas_in_brackets_belong_to_their_spec() -> None:
    specs = split_specs("t2,rrt[range=3,goal_bias=0.1], temporal[horizon=4],pf")
    assert [s.label for s in specs] == ["t2", "rrt[range=3,goal_bias=0.1]", "temporal[horizon=4]", "pf"]


def test_the_same_planner_with_other_settings_is_another() -> None:
    assert len(split_specs("temporal,temporal[horizon=4],temporal[horizon=5]")) == 3


def error(text: str) -> str:
    with pytest.raises(SpecError) as caught:
        split_specs(text)
    message = str(caught.value)
    assert "\n" not in message
    return message


@pytest.mark.parametrize(
    ("text", "parts"),
    [
        ("temporel", ["'temporel'", *PLANNERS, *ALIASES]),
        ("temporal[horizont=3]", ["'horizont'", "horizon, transitions, target, waiting, spacing_rad"]),
        (
            "temporal[transitions=leaps]",
            ["temporal[transitions]", "'leaps'", "'steps', 'layers', 'edges' or 'chained'"],
        ),
        ("temporal-best[target=closest]", ["temporal-best", "temporal[target=...] only"]),
        ("temporal[horizon=0]", ["temporal[horizon]", "'0'", "greater than or equal to 1"]),
        ("temporal[horizon=2.5]", ["temporal[horizon]", "integer"]),
        ("temporal[horizon=x]", ["temporal[horizon]", "'x'"]),
        ("rrt[goal_bias=2]", ["rrt[goal_bias]", "less than or equal to 1"]),
        ("rrt[goal_bias=nan]", ["rrt[goal_bias]"]),
        ("rrt[range=inf]", ["rrt[range]"]),
        ("temporal[horizon=2,horizon=3]", ["'horizon' twice"]),
        ("t2[horizon=5]", ["t2", "temporal[horizon=...] only"]),
        ("temporal[horizon]", ["key=value"]),
        ("temporal[=3]", ["key=value"]),
        ("temporal[horizon=]", ["key=value"]),
        ("temporal[horizon=3", ["temporal[horizon=3"]),
        ("temporal]", ["temporal]"]),
        ("temporal[[horizon=3]]", ["temporal[["]),
        ("temporal[horizon=3]x", ["name[key=value,...]"]),
        ("t2,t3,t2", ["'t2' twice"]),
        ("t2,", ["empty entry"]),
        (",", ["empty entry"]),
        ("", ["empty entry"]),
    ],
)
def test_what_cannot_be_meant_is_one_line(text: str, parts: list[str]) -> None:
    message = error(text)
    for part in parts:
        assert part in message


names = st.sampled_from([*PLANNERS, *ALIASES, "nonsense"])
keys = st.sampled_from(
    sorted({key for entry in PLANNERS.values() for key in entry.settings_model.model_fields} | {"nonsense"})
)
values = st.one_of(st.integers().map(str), st.floats().map(str), st.text(max_size=5), st.sampled_from(["true", "1e3"]))
likely = st.builds(
    lambda name, pairs: f"{name}[{','.join(f'{key}={value}' for key, value in pairs)}]",
    names,
    st.lists(st.tuples(keys, values), max_size=3),
)


@settings(max_examples=300)
@given(
    st.one_of(st.text(max_size=40), st.text("t23rpf,[]= .", max_size=20), st.lists(likely, max_size=3).map(",".join))
)
def test_any_text_is_specs_or_one_spec_error(text: str) -> None:
    try:
        specs = split_specs(text)
    except SpecError as refused:
        message = str(refused)
    else:
        message = "read"
        assert all(isinstance(spec, PlannerSpec) for spec in specs)
        assert [parse_planner(spec.label) for spec in specs] == specs
    assert len(message.splitlines()) == 1


def test_a_lattice_that_does_not_fit_the_arm_is_refused_before_anything_is_built() -> None:
    check_fit(split_specs("temporal,rrt,pf"), ContinuumArm())
    with pytest.raises(ScenarioError, match="spacing_rad"):
        check_fit(split_specs("rrt,temporal"), ContinuumArm(n_sections=5))


def test_a_margin_that_is_asked_for_is_every_planners_but_a_bounds() -> None:
    rrt, temporal, bound = parse_planner("rrt"), parse_planner("temporal"), parse_planner("clairvoyant")
    assert [spec.margin_for(None) for spec in (rrt, temporal, bound)] == [1.0, 0.0, 0.0]
    assert [spec.margin_for(1.5) for spec in (rrt, temporal, bound)] == [1.5, 1.5, 0.0]


def test_a_budget_scales_what_the_planner_declares_and_nothing_else() -> None:
    for name in [*PLANNERS, "ompl.KPIECE1"]:
        planner = planner_class(name)
        if not planner.budget:
            with pytest.raises(SpecError, match=f"^{name}: found setting 'budget', allowed"):
                parse_planner(f"{name}[budget=2]")
            continue
        whole, half = (
            parse_planner(name).settings.model_dump(),
            parse_planner(f"{name}[budget=0.5]").settings.model_dump(),
        )
        assert {key for key in whole if whole[key] != half[key]} == set(planner.budget)
        for key in planner.budget:
            assert half[key] == max(1, round(0.5 * whole[key]))
    assert parse_planner("rrt[iterations=500,budget=0.1]").settings.iterations == 50
    assert parse_planner("rrt[budget=1]").settings == parse_planner("rrt").settings
    assert parse_planner("rrt[budget=0.1]").label == "rrt[budget=0.1]"


@pytest.mark.parametrize(
    ("spec", "line"),
    [
        ("rrt[budget=x]", r"rrt\[budget\]: found 'x', allowed a number above 0 and up to 1000"),
        ("rrt[budget=0]", r"rrt\[budget\]: found '0', allowed .*"),
        ("rrt[budget=nan]", r"rrt\[budget\]: found 'nan', allowed .*"),
        ("rrt[budget=1e9]", r"rrt\[budget\]: found '1e9', allowed .*"),
        ("strrt[budget=0.001]", r"strrt\[budget=0\.001\]\[nodes\]: found 4, allowed: .*"),
        ("rrt[iteration=3]", r"rrt: found setting 'iteration', allowed .*; nearest: iterations"),
    ],
)
def test_a_budget_that_cannot_be_is_one_line(spec: str, line: str) -> None:
    with pytest.raises(SpecError, match=f"^{line}$"):
        parse_planner(spec)
