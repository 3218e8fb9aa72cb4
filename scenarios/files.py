"""Scenario files: YAML for people, JSON and JSON lines for machines. Untrusted, so checked and bounded."""

import json
import math
import os
import reprlib
from collections.abc import Hashable, Iterable, Sequence
from pathlib import Path
from typing import Any

import yaml
from pydantic import ValidationError

from scenarios.errors import ScenarioError
from scenarios.scenario import Scenario

MAX_FILE_BYTES = 64 * 1024 * 1024
MAX_SCENARIOS = 100_000
MAX_DEPTH = 50
SUFFIXES = (".yaml", ".yml", ".json", ".jsonl")


def _parse_yaml(text: str) -> Any:
    """Safe YAML of plain values, so that a small file cannot stand for gigabytes or minutes."""
    depth = 0
    for event in yaml.parse(text, Loader=yaml.CSafeLoader):
        if isinstance(event, yaml.AliasEvent) or getattr(event, "tag", None) is not None:
            raise yaml.YAMLError("found a YAML alias or tag, allowed plain values only")
        depth += isinstance(event, yaml.CollectionStartEvent) - isinstance(event, yaml.CollectionEndEvent)
        # libyaml takes time quadratic in the depth.
        if depth > MAX_DEPTH:
            raise yaml.YAMLError(f"found values nested deeper than {MAX_DEPTH}")
    return yaml.load(text, Loader=_Loader)


class _Loader(yaml.CSafeLoader):
    """YAML's safe loader, which by itself lets the last of two equal keys win."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Hashable, Any]:
        """The mapping, if no key stands twice in it."""
        twice = _first_twice(key.value for key, _ in node.value if isinstance(key, yaml.ScalarNode))
        if twice is not None:
            raise _KeyTwiceError(twice)
        return super().construct_mapping(node, deep)


class _KeyTwiceError(Exception):
    """A mapping in a file has a key twice."""


def _parse_json(text: str) -> Any:
    return json.loads(text, object_pairs_hook=_dict_of)


def _dict_of(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """The object, if no key stands twice in it: Python's reader lets the last one win."""
    values = dict(pairs)
    if len(values) < len(pairs):
        raise _KeyTwiceError(_first_twice(key for key, _ in pairs))
    return values


def _first_twice(names: Iterable[str]) -> str | None:
    """The first name that was there before; None when all differ."""
    seen = set[str]()
    for name in names:
        if name in seen:
            return name
        seen.add(name)
    return None


def load_scenarios(path: str | os.PathLike[str]) -> list[Scenario]:
    """Read a file that holds one scenario, a list of them, or one per line (.jsonl).

    Raises:
        ScenarioError: The file cannot be read, is too large, is not valid YAML or JSON, or a field is wrong; the
            message names file, field, what was found and what is allowed.
    """
    file = Path(path)
    entries = read_entries(file)
    if not 1 <= len(entries) <= MAX_SCENARIOS:
        raise ScenarioError(f"{file}: found {len(entries)} scenarios, allowed 1 to {MAX_SCENARIOS}")
    count = len(entries)
    entries.reverse()  # taken from the end, each is gone when the next is read: a large file is not held twice
    scenarios = [_validate(file, k, count, entries.pop()) for k in range(count)]
    twice = _first_twice(scenario.id for scenario in scenarios)
    if twice is not None:
        raise ScenarioError(f"{file}: id: found {twice!r} twice, allowed once per file")
    return scenarios


def save_scenarios(path: str | os.PathLike[str], scenarios: Sequence[Scenario]) -> None:
    """Write scenarios in the format of the file's suffix.

    Raises:
        ScenarioError: The suffix is unknown or the file cannot be written.
    """
    file = Path(path)
    entries = [scenario.model_dump(mode="json") for scenario in scenarios]
    if _suffix(file) == ".jsonl":
        text = "".join(json.dumps(entry) + "\n" for entry in entries)
    elif _suffix(file) == ".json":
        text = json.dumps(entries, indent=1) + "\n"
    else:
        text = yaml.dump(entries, Dumper=yaml.CSafeDumper, sort_keys=False, default_flow_style=None, width=110)
    try:
        file.write_text(text, encoding="utf-8")
    except OSError as error:
        raise ScenarioError(f"{file}: cannot be written: {error.strerror}") from None


def _suffix(file: Path) -> str:
    if file.suffix.lower() not in SUFFIXES:
        raise ScenarioError(f"{file}: found suffix {file.suffix!r}, allowed {', '.join(SUFFIXES)}")
    return file.suffix.lower()


def read_entries(file: Path) -> list[Any]:
    """What a file holds as plain Python values, in a list: of one, or of those that the file lists.

    Raises:
        ScenarioError: The file cannot be read, is too large, or is not valid YAML or JSON.
    """
    suffix, text = _suffix(file), _text(file)
    try:
        if suffix == ".jsonl":
            return [_parse_json(line) for line in text.splitlines() if line.strip()]
        content = _parse_json(text) if suffix == ".json" else _parse_yaml(text)
    except _KeyTwiceError as error:
        raise ScenarioError(f"{file}: found the key {_short(error.args[0])} twice, allowed once") from None
    # ValueError: besides broken JSON, a number of thousands of digits or a date such as 2024-13-45.
    except (ValueError, yaml.YAMLError, RecursionError) as error:
        first = " ".join(str(error).split())[:200] or type(error).__name__
        raise ScenarioError(f"{file}: not valid {suffix[1:].upper()} (truncated?): {first}") from None
    return content if isinstance(content, list) else [content]


def _text(file: Path) -> str:
    try:
        size = file.stat().st_size
        if size > MAX_FILE_BYTES:
            raise ScenarioError(f"{file}: found {size} bytes, allowed {MAX_FILE_BYTES}")
        return file.read_text(encoding="utf-8-sig")  # some editors begin a file with a mark
    except OSError as error:
        raise ScenarioError(f"{file}: cannot be read: {error.strerror}") from None
    except UnicodeDecodeError:
        raise ScenarioError(f"{file}: found bytes that are not UTF-8, allowed UTF-8 text") from None


def _validate(file: Path, index: int, count: int, entry: Any) -> Scenario:
    try:
        return Scenario.model_validate(entry)
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(str(part) for part in first["loc"]) or "scenario"
        prefix = f"[{index}]." if count > 1 else ""
        found = first["input"]
        shown = "nothing" if first["type"] == "missing" else _short(found)
        allowed = first["msg"].removeprefix("Value error, ")
        if first["type"] == "extra_forbidden":
            known = f"; a scenario has {', '.join(Scenario.model_fields)}" if len(first["loc"]) == 1 else ""
            allowed = f"no such field{known}"
        raise ScenarioError(f"{file}: {prefix}{where}: found {shown}, allowed: {allowed}") from None


def _short(value: Any) -> str:
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    try:
        text = reprlib.repr(value)  # bounded in depth, unlike repr
    except ValueError:
        return "a number of thousands of digits"
    return text if len(text) <= 60 else text[:57] + "..."
