"""Scenario files: round trips, a hash that stays, and one clear line for everything that can be wrong with one."""

import json
import time
from pathlib import Path
from types import SimpleNamespace

import hypothesis
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from strategies import scenarios

from scenarios import Obstacle, Orbit, Scenario, Track, UserError, files, load_scenarios, save_scenarios

SUFFIXES = [".yaml", ".yml", ".json", ".jsonl"]

FIXED = Scenario(
    id="fixed",
    start_rad=(0.1, 0.2, -0.3, 0.4, 0.5, -0.6),
    goal_m=(0.105, -0.205, 0.305),
    obstacles=(
        Obstacle(
            radius_m=0.02,
            motion=Orbit(center_m=(0.1, 0.2, 0.3), radius_m=0.1, normal=(0, 0, 1), rate_rad_s=0.125, phase_rad=1e-7),
        ),
        Obstacle(radius_m=0.03, motion=Track(times_s=(0, 2.5), positions_m=((0.25, 0, 0.5), (0.5, 1, 1 / 3)))),
    ),
)


@pytest.mark.parametrize("suffix", SUFFIXES)
@settings(max_examples=25, suppress_health_check=[hypothesis.HealthCheck.function_scoped_fixture])
@given(st.lists(scenarios(), min_size=1, max_size=3, unique_by=lambda s: s.id))
def test_what_is_saved_is_what_is_loaded(tmp_path: Path, suffix: str, written: list[Scenario]) -> None:
    file = tmp_path / f"scenarios{suffix}"
    save_scenarios(file, written)
    read = load_scenarios(file)
    assert read == written
    assert [s.content_hash for s in read] == [s.content_hash for s in written]


def test_the_hash_of_a_problem_never_changes(tmp_path: Path) -> None:
    # Rows of old runs carry it. If this fails, schema_version must go up.
    assert FIXED.content_hash == "24b360dcce82382b"
    for suffix in SUFFIXES:
        save_scenarios(tmp_path / f"fixed{suffix}", [FIXED])
        assert load_scenarios(tmp_path / f"fixed{suffix}")[0].content_hash == FIXED.content_hash


def test_the_hash_is_of_the_problem_not_of_its_name() -> None:
    def changed(**fields: object) -> str:
        return FIXED.model_copy(update=fields).content_hash

    assert changed(id="other", family="other", seed=9, parameters={"a": 1.0}) == FIXED.content_hash
    assert changed(goal_m=(0.105, -0.205, 0.3050001)) != FIXED.content_hash
    assert changed(obstacles=FIXED.obstacles[::-1]) != FIXED.content_hash
    assert changed(arm=FIXED.arm.model_copy(update={"radius_m": 0.015})) != FIXED.content_hash
    assert changed(time_limit_s=60.0) != FIXED.content_hash


def test_a_person_can_leave_out_what_has_a_default(tmp_path: Path) -> None:
    file = tmp_path / "short.yaml"
    file.write_text("id: short\nstart_rad: [0, 0, 0, 0, 0, 0]\ngoal_m: [0.1, 0, 0.3]\n")
    (scenario,) = load_scenarios(file)
    assert scenario == Scenario(id="short", start_rad=(0,) * 6, goal_m=(0.1, 0, 0.3))


def content(**fields: object) -> dict[str, object]:
    return {**FIXED.model_dump(mode="json"), **fields}


def without(field: str) -> dict[str, object]:
    return {key: value for key, value in content().items() if key != field}


def orbit_with(**fields: object) -> dict[str, object]:
    obstacle = FIXED.model_dump(mode="json")["obstacles"][0]
    return content(obstacles=[{**obstacle, "motion": {**obstacle["motion"], **fields}}])


WRONG_FIELDS = {
    "unknown field": (content(colour="red"), "colour", "schema_version, id"),
    "missing field": (without("goal_m"), "goal_m", "required"),
    "text for a number": (content(time_limit_s="long"), "time_limit_s", "valid number"),
    "number for a list": (content(goal_m=1.0), "goal_m", "valid tuple"),
    "too short a list": (content(goal_m=[0.1, 0.2]), "goal_m", "required"),
    "not a number": (content(goal_tolerance_m=float("nan")), "goal_tolerance_m", "finite"),
    "infinity": (content(goal_m=[0.1, float("inf"), 0.3]), "goal_m.1", "finite"),
    "parameter not a number": (content(parameters={"speed": float("nan")}), "parameters.speed", "finite"),
    "out of range": (content(time_limit_s=0.5), "time_limit_s", "greater than or equal to 1"),
    "seed out of range": (content(seed=2**63), "seed", "less than"),
    "half a step": (content(observation_s=4.5), "observation_s", "multiple of 1"),
    "future version": (content(schema_version=2), "schema_version", "1"),
    "name with a slash": (content(id="a/b"), "id", "match"),
    "start for another arm": (content(start_rad=[0.0] * 4), "scenario", "start_rad has 4 numbers, the arm needs 6"),
    "start bent too far": (
        content(start_rad=[0.0, 3.0, 3.0, 0.0, 3.0, 3.0]),
        "scenario",
        "start_rad bends a section past max_bend_rad",
    ),
    "wrong field of the arm": (content(arm={"sections": 3}), "arm.sections", "no such field"),
    "unknown law of motion": (orbit_with(kind="spiral"), "obstacles.0.motion", "spiral"),
    "wrong field of a motion": (orbit_with(speed=1), "obstacles.0.motion.orbit.speed", "no such field"),
    "orbit without a plane": (orbit_with(normal=[0, 0, 0]), "obstacles.0.motion.orbit", "normal must not be zero"),
    "obstacle of no size": (content(obstacles=[{"radius_m": 0}]), "obstacles.0.radius_m", "greater than 0"),
    "not a scenario": ("hello", "scenario", "dictionary"),
}


def the_error(file: Path) -> str:
    with pytest.raises(UserError) as caught:
        load_scenarios(file)
    message = str(caught.value)
    assert message.startswith(f"{file}: ")
    assert "\n" not in message
    assert len(message) < 500
    return message


@pytest.mark.parametrize("suffix", SUFFIXES)
@pytest.mark.parametrize("case", WRONG_FIELDS)
def test_a_wrong_field_is_named(tmp_path: Path, suffix: str, case: str) -> None:
    entry, field, allowed = WRONG_FIELDS[case]
    file = tmp_path / f"bad{suffix}"
    file.write_text(yaml.safe_dump(entry) if suffix.startswith(".y") else json.dumps(entry))
    message = the_error(file)
    assert f" {field}: found " in message or f" {field}." in message
    assert "allowed" in message
    assert allowed in message


def test_the_wrong_one_of_many_is_named(tmp_path: Path) -> None:
    file = tmp_path / "many.jsonl"
    entries = [content(id="a"), content(id="b"), content(id="c", seed=-1)]
    file.write_text("".join(json.dumps(entry) + "\n" for entry in entries))
    assert " [2].seed: found -1, allowed" in the_error(file)


def test_the_same_name_twice_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "twice.json"
    file.write_text(json.dumps([content(), content(seed=1)]))
    assert "'fixed'" in the_error(file)


def test_the_first_name_that_stands_twice_is_found_in_a_single_pass(tmp_path: Path, monkeypatch) -> None:
    """A hundred thousand names, one of them twice: seconds if each is looked up among all the others."""
    entries = [{"id": str(k)} for k in range(100_000)] + [{"id": "99999"}]
    monkeypatch.setattr(files, "MAX_SCENARIOS", len(entries))
    monkeypatch.setattr(files, "_validate", lambda file, index, count, entry: SimpleNamespace(**entry))
    (tmp_path / "long.jsonl").write_text("".join(json.dumps(entry) + "\n" for entry in entries))
    started = time.process_time()
    assert "id: found '99999' twice, allowed once per file" in the_error(tmp_path / "long.jsonl")
    assert time.process_time() - started < 5.0  # 0.2 s, quadratically 100 s


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_byte_order_mark_and_blank_last_lines_are_no_mistake(tmp_path: Path, suffix: str) -> None:
    file = tmp_path / f"marked{suffix}"
    save_scenarios(file, [FIXED])
    file.write_bytes("\ufeff".encode() + file.read_bytes() + b"\n \n")
    assert load_scenarios(file) == [FIXED]


TWICE = {
    "top.json": (json.dumps(content())[:-1] + ', "goal_m": [0, 0, 0]}', "goal_m"),
    "top.jsonl": (json.dumps(content())[:-1] + ', "id": "other"}', "id"),
    "top.yaml": (yaml.safe_dump(content()) + "seed: 4\n", "seed"),
    "inside.json": (json.dumps(content()).replace('"kind": "orbit"', '"kind": "orbit", "kind": "orbit"'), "kind"),
    "inside.yaml": (yaml.safe_dump(content()).replace("kind: orbit", "radius_m: 0.2\n    kind: orbit"), "radius_m"),
    "quoted.yaml": (yaml.safe_dump(content()) + '"seed": 4\n', "seed"),
    "long.json": ('{"' + "x" * 5000 + '": 1, "' + "x" * 5000 + '": 2}', "xxx"),
}


@pytest.mark.parametrize("name", TWICE)
def test_a_key_that_stands_twice_is_refused(tmp_path: Path, name: str) -> None:
    text, key = TWICE[name]
    (tmp_path / name).write_text(text)
    message = the_error(tmp_path / name)
    assert f"found the key '{key}" in message
    assert "twice, allowed once" in message


DEEP = 100_000
BOMB = "a: &a [x, x]\n" + "".join(
    f"{chr(98 + k)}: &{chr(98 + k)} [*{chr(97 + k)}, *{chr(97 + k)}]\n" for k in range(20)
)
BROKEN = {
    "truncated.json": json.dumps(content())[:-20],
    "truncated.jsonl": json.dumps(content()) + "\n" + json.dumps(content())[:-20],
    "truncated.yaml": yaml.safe_dump(content(), default_flow_style=True)[:-20],
    "empty.json": "",
    "empty.jsonl": "",
    "empty.yaml": "",
    "nothing.json": "[]",
    "alias bomb.yaml": BOMB,
    "code.yaml": "!!python/object/apply:os.system [echo]",
    "tag.yaml": "seed: !!bool maybe",
    "deep.json": "[" * DEEP + "]" * DEEP,
    "deep.yaml": "[" * DEEP + "]" * DEEP,
    "deep value.json": '{"id": ' + "[" * 900 + "]" * 900 + "}",
    "digits.json": '{"seed": ' + "1" * 5000 + "}",
    "digits.yaml": "seed: " + "1" * 5000,
    "hexadecimal digits.yaml": yaml.safe_dump(without("seed")) + "seed: 0x" + "f" * 10_000,
    "no such day.yaml": "id: 2024-13-45",
    "a day.yaml": yaml.safe_dump(without("seed")) + "seed: 2024-12-24",
    "bell.yaml": "id: \a",
    "two documents.yaml": "id: a\n---\nid: b\n",
    "list for a key.yaml": "? [a]\n: b\n",
}


@pytest.mark.parametrize("name", BROKEN)
def test_a_broken_file_is_one_line(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_text(BROKEN[name])
    the_error(tmp_path / name)


def test_a_file_that_is_not_utf_8(tmp_path: Path) -> None:
    (tmp_path / "latin.yaml").write_bytes("id: Gödel".encode("latin-1"))
    assert "UTF-8" in the_error(tmp_path / "latin.yaml")


def test_a_file_that_is_too_large(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(files, "MAX_FILE_BYTES", 1000)
    (tmp_path / "large.json").write_text(" " * 1001)
    assert "found 1001 bytes, allowed 1000" in the_error(tmp_path / "large.json")


def test_too_many_scenarios(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(files, "MAX_SCENARIOS", 2)
    (tmp_path / "many.json").write_text(json.dumps([content()] * 3))
    assert "found 3 scenarios" in the_error(tmp_path / "many.json")


def test_a_file_that_is_not_there(tmp_path: Path) -> None:
    assert "No such file" in the_error(tmp_path / "missing.yaml")


def test_a_folder(tmp_path: Path) -> None:
    (tmp_path / "folder.json").mkdir()
    assert "found a folder" in the_error(tmp_path / "folder.json")


@pytest.mark.parametrize("name", ["scenarios.toml", "scenarios", "scenarios.yaml.gz"])
def test_a_wrong_suffix_lists_the_right_ones(tmp_path: Path, name: str) -> None:
    assert ".yaml, .yml, .json, .jsonl" in the_error(tmp_path / name)
    with pytest.raises(UserError, match=r"\.jsonl"):
        save_scenarios(tmp_path / name, [FIXED])


def test_a_place_that_cannot_be_written(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="cannot be written"):
        save_scenarios(tmp_path / "no such folder" / "a.yaml", [FIXED])


@settings(max_examples=150, suppress_health_check=[hypothesis.HealthCheck.function_scoped_fixture])
@given(st.sampled_from(SUFFIXES), st.one_of(st.binary(max_size=60), st.text(max_size=60).map(str.encode)))
def test_garbage_is_one_line(tmp_path: Path, suffix: str, garbage: bytes) -> None:
    (tmp_path / f"garbage{suffix}").write_bytes(garbage)
    the_error(tmp_path / f"garbage{suffix}")


JSON_VALUES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=6,
)


@settings(max_examples=200, suppress_health_check=[hypothesis.HealthCheck.function_scoped_fixture])
@given(st.sampled_from(sorted(Scenario.model_fields)), JSON_VALUES)
def test_any_value_in_any_field_is_taken_or_refused_in_one_line(tmp_path: Path, field: str, value: object) -> None:
    file = tmp_path / "any.json"
    file.write_text(json.dumps(content(**{field: value})))
    try:
        (loaded,) = load_scenarios(file)
    except UserError:
        assert field in the_error(file) or "scenario: " in the_error(file)
    else:
        assert json.loads(json.dumps(loaded.model_dump(mode="json"), allow_nan=False))
