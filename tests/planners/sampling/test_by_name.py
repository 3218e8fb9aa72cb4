"""OMPL's planners by name: each that the wheel binds runs or is refused with a reason, and is set as asked."""

import hashlib
import os
import pickle
import subprocess
import sys

import numpy as np
import pytest
from ompl import base as ob
from ompl import geometric as og

from planners import Observation, Plan, Session, TimedPath, ompl_planners, ompl_refused, parse_planner
from planners.problem import Query, SpaceTimeProblem
from planners.problem.goals import GoalConfigurations
from planners.sampling.by_name.setters import setters_of
from planners.sampling.by_name.treatment import OMITTED, REFUSED, TREATMENTS
from planners.sampling.trees import SpaceTimeTree
from planners.spec import is_outside, planner_class, read_spec
from scenarios import Scenario, SpecError, generate
from suite.cli.main import main

NAMES = list(ompl_planners())
SCENARIO = generate("orbit", 2, 1, 11)[0]
KEYS = [(name, key) for name, planner in ompl_planners().items() for key in planner.settings_model.model_fields]


def observe(scenario: Scenario) -> Observation:
    times = np.arange(-scenario.observation_s, 0.5)
    positions = np.stack([obstacle.position(times) for obstacle in scenario.obstacles], axis=1)
    return Observation(times, positions, np.array([obstacle.radius_m for obstacle in scenario.obstacles]))


def plan_of(text: str, scenario: Scenario = SCENARIO) -> Plan:
    session = Session(parse_planner(text), scenario, predictor="portfolio", limits=True, seed=3)
    return session.plan(scenario.start, 0.0, observe(scenario))


def problem_without_obstacles() -> SpaceTimeProblem:
    from planners.prediction import Prediction

    nothing = Prediction(0.0, 1.0, np.empty((2, 0, 3)), np.empty(0), np.empty((2, 0)))
    query = Query(SCENARIO.arm, SCENARIO.goal, SCENARIO.goal_tolerance_m, nothing, nothing.world(0.0, 1.0), True)
    return SpaceTimeProblem(query, 90.0)


def error(text: str) -> str:
    with pytest.raises(SpecError) as caught:
        parse_planner(text)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def other(name: str, key: str) -> float | int | bool:
    """A value that is allowed and not the default."""
    field = ompl_planners()[name].settings_model.model_fields[key]
    if field.annotation is bool:
        return not field.default
    if field.annotation is int:
        return int(field.default) + 1
    return 1.5 if key == "radius_multiplier" else 0.5 * float(field.default) or 0.25


def test_every_planner_that_ompl_binds_runs_or_is_refused() -> None:
    bound = {name for name in dir(og) if isinstance(kind := getattr(og, name), type) and issubclass(kind, ob.Planner)}
    assert {f"ompl.{name}" for name in bound} == set(NAMES) | set(ompl_refused())
    assert not set(NAMES) & set(ompl_refused())
    assert all(ompl_refused().values())
    assert "ompl.KPIECE1" in NAMES


def test_what_is_said_of_planners_and_settings_is_said_of_something() -> None:
    keys = {setter.key for name in NAMES for setter in setters_of(name.removeprefix("ompl."))}
    assert set(OMITTED) <= keys
    assert {f"ompl.{name}" for name in TREATMENTS} <= set(NAMES)
    for name, treatment in TREATMENTS.items():
        assert set(treatment.defaults) <= set(ompl_planners()[f"ompl.{name}"].settings_model.model_fields)


@pytest.mark.parametrize("name", NAMES)
def test_a_name_alone_is_a_spec_of_the_suites_own(name: str) -> None:
    spec = parse_planner(name)
    assert (spec.name, spec.label, spec.code) == (name, name, "")
    assert not is_outside(name)
    assert planner_class(name) is ompl_planners()[name]
    assert pickle.loads(pickle.dumps(spec)) == spec
    assert parse_planner(f"{name}[name=mine]").label == "mine"


@pytest.mark.parametrize(("name", "key"), KEYS)
def test_settings_are_read_typed_described_and_survive_the_way_to_a_worker(name: str, key: str) -> None:
    field = ompl_planners()[name].settings_model.model_fields[key]
    assert field.description
    assert getattr(parse_planner(f"{name}[{key}={field.default}]").settings, key) == field.default
    value = other(name, key)
    spec = parse_planner(f"{name}[{key}={value}]")
    assert type(getattr(spec.settings, key)) is field.annotation
    assert getattr(spec.settings, key) == value != field.default
    assert pickle.loads(pickle.dumps(spec)).settings == spec.settings
    assert parse_planner(spec.label) == spec


@pytest.mark.parametrize("name", NAMES)
def test_every_setting_reaches_ompl(name: str) -> None:
    short, problem = name.removeprefix("ompl."), problem_without_obstacles()
    asked = [setter for setter in setters_of(short) if setter.key not in OMITTED]
    assert asked
    for setter in asked:
        value = other(name, setter.key)
        settings = parse_planner(f"{name}[{setter.key}={value}]").settings
        tree = planner_class(name)(problem, settings)._tree
        assert getattr(tree, f"get{setter.name}")() == pytest.approx(value), setter.key
    tree = planner_class(name)(problem, parse_planner(name).settings)._tree
    for key, value in TREATMENTS[short].defaults.items():
        for setter in setters_of(short):
            if setter.key == key:
                assert getattr(tree, f"get{setter.name}")() == pytest.approx(value)


@pytest.mark.parametrize(
    "name", [name for name in NAMES if "range" in ompl_planners()[name].settings_model.model_fields]
)
def test_the_range_is_finite(name: str) -> None:
    planner = planner_class(name)(problem_without_obstacles(), parse_planner(name).settings)
    assert np.isfinite(planner._tree.getRange())


@pytest.mark.parametrize(
    ("text", "parts"),
    [
        ("ompl.Nonsense", NAMES),
        ("ompl.kpiece", [*NAMES, "nearest: ompl.KPIECE1"]),
        ("ompl.", NAMES),
        *((f"ompl.{name}", [*NAMES, name, reason]) for name, reason in REFUSED.items()),
        ("ompl.KPIECE1[ranges=1]", ["'ranges'", "range", "goal_bias", "cell_m", "iterations"]),
        ("ompl.KPIECE1[range=inf]", ["ompl.KPIECE1[range]"]),
        ("ompl.KPIECE1[range=0]", ["ompl.KPIECE1[range]", "greater than or equal to 0.01"]),
        ("ompl.KPIECE1[goal_bias=2]", ["less than or equal to 1"]),
        ("ompl.KPIECE1[border_fraction=0]", ["OMPL says", "border"]),
        ("ompl.BITstar[pruning=perhaps]", ["ompl.BITstar[pruning]", "boolean"]),
        ("ompl.BITstar[samples_per_batch=2.5]", ["ompl.BITstar[samples_per_batch]", "integer"]),
        ("ompl.RRT[cell_m=1]", ["'cell_m'"]),
        ("ompl", ["ompl.NAME"]),
    ],
)
def test_what_cannot_be_meant_is_one_line(text: str, parts: list[str]) -> None:
    message = error(text)
    for part in parts:
        assert part in message


def test_a_planner_that_cannot_work_here_is_a_usage_error(tmp_path, capfd) -> None:
    assert main(["run", "--planners", "pf,ompl.PRM", "--out", str(tmp_path / "run")]) == 2
    out, err = capfd.readouterr()
    assert (out, err.count("\n")) == ("", 1)
    assert REFUSED["PRM"] in err
    assert list(tmp_path.iterdir()) == []


def test_all_of_them_are_listed_in_short_lines(capfd) -> None:
    assert main(["planners"]) == 0
    listed = capfd.readouterr().out.partition("OMPL's own, as")[2].partition("Predictors:")[0]
    words = " ".join(listed.split()) + " "
    for name, planner in ompl_planners().items():
        assert f" {name}: {planner.source} " in words
    for name, reason in ompl_refused().items():
        assert f" {name}: {reason} " in words
    assert "goal_bias=0.4" in listed
    assert "samples_per_batch=20" in listed
    assert max(map(len, listed.splitlines())) <= 100


def test_a_module_called_ompl_is_still_a_module() -> None:
    assert is_outside(read_spec("ompl.mine:Planner").name)


@pytest.mark.parametrize("name", NAMES)
def test_it_reaches_the_goal_where_little_is_in_the_way(name: str) -> None:
    reached = [plan_of(name, scenario).status == "Exact solution" for scenario in generate("orbit", 1, 6, 2000)]
    assert sum(reached) >= 2


@pytest.mark.parametrize("name", NAMES)
def test_no_path_that_the_shared_validator_refuses_comes_out(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    problem = problem_without_obstacles()
    planner = planner_class(name)(problem, parse_planner(name).settings)
    q = np.full(SCENARIO.arm.dof, 0.1)
    given = {
        "forward": TimedPath(np.array([0.0, 10.0]), np.stack([q, q + 0.1])),
        "backward": TimedPath(np.array([0.0, 10.0, 5.0]), np.stack([q, q + 0.1, q])),
        "too fast": TimedPath(np.array([0.0, 0.01]), np.stack([q, q + 1.0])),
        "from elsewhere": TimedPath(np.array([0.0, 10.0]), np.stack([q + 0.05, q])),
        "from the future": TimedPath(np.array([1.0, 10.0]), np.stack([q, q + 0.1])),
        "the goal alone": TimedPath(np.array([0.0]), q[None]),
    }
    taken = {}
    for case, path in given.items():
        monkeypatch.setattr(SpaceTimeTree, "attempt", lambda *_, path=path: path)
        taken[case] = planner.attempt(q, 0.0, q + 0.1, 1.0, lambda: False) is not None
    assert taken == {case: case == "forward" for case in given}


def test_a_goal_configuration_that_is_never_free_is_not_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    problem = problem_without_obstacles()
    planner = planner_class("ompl.FMT")(problem, parse_planner("ompl.FMT").settings)
    rng = np.random.default_rng(0)
    goals = GoalConfigurations(SCENARIO.arm, SCENARIO.goal, SCENARIO.goal_tolerance_m, 4, rng)
    planner.setProblemDefinition(problem.definition(SCENARIO.start, 0.0, goals, rng))
    goal = goals.configurations[0]
    asked = planner.pose(SCENARIO.start, 0.0, goal, 20.0, 40.0)
    assert asked.getGoal().maxSampleCount() == 10
    monkeypatch.setattr(problem.checker, "isValid", lambda _: False)
    assert planner.pose(SCENARIO.start, 0.0, goal, 20.0, 40.0) is None


_PLANS = """
import hashlib, sys
sys.path.insert(0, "tests/planners/sampling")
from test_by_name import digest
print(digest(sys.argv[1:]))
"""


def digest(names: list[str]) -> str:
    """Hash of all that planning with ``names`` gives, times of the clock aside."""
    found = hashlib.sha256()
    for name in names:
        plan = plan_of(name)
        found.update(f"{plan.status} {plan.state_checks} {plan.motion_checks}".encode())
        found.update(plan.times_s.tobytes() + plan.configurations_rad.tobytes())
    return found.hexdigest()


def test_a_seed_gives_the_same_paths_in_two_processes_and_twice_in_one() -> None:
    answers = {digest(NAMES), digest(NAMES)}
    for salt in ("1", "2"):
        child = subprocess.run(
            [sys.executable, "-c", _PLANS, *NAMES],
            env={**os.environ, "PYTHONHASHSEED": salt},
            capture_output=True,
            text=True,
            check=True,
            timeout=300,
        )
        answers.add(child.stdout.strip())
    assert len(answers) == 1
