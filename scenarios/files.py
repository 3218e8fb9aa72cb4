"""Scenario files: YAML for people, JSON and JSON lines for machines. Untrusted, so checked and bounded."""

import json
import math
import os
import reprlib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import yaml
from pydantic import ValidationError

from scenarios.errors import ScenarioError
from scenarios.reading import first_twice, parse, read_text
from scenarios.scenario import Scenario

MAX_FILE_BYTES = 64 * 1024 * 1024
MAX_SCENARIOS = 100_000
SUFFIXES = (".yaml", ".yml", ".json", ".jsonl")


def load_scenarios(path: str | os.PathLike[str]) -> list[Scenario]:
    """Read a file that holds one scenario, a list of them, or one per line (.jsonl).

    Raises:
        FileError: The file cannot be read, is too large, or is not valid YAML or JSON.
        ScenarioError: A field is wrong; the message names file, field, what was found and what is allowed.
    """
    file = Path(path)
    entries = read_entries(file)
    if not 1 <= len(entries) <= MAX_SCENARIOS:
        raise ScenarioError(f"{file}: found {len(entries)} scenarios, allowed 1 to {MAX_SCENARIOS}")
    count = len(entries)
    entries.reverse()  # taken from the end, each is gone when the next is read: a large file is not held twice
    scenarios = [_validate(file, k, count, entries.pop()) for k in range(count)]
    twice = first_twice(scenario.id for scenario in scenarios)
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
        FileError: The file cannot be read, is too large, or is not valid YAML or JSON.
        ScenarioError: Its suffix is unknown.
    """
    content = parse(file, _suffix(file), read_text(file, MAX_FILE_BYTES))
    return content if isinstance(content, list) else [content]


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
