"""Scenario files: YAML for people, JSON and JSON lines for machines. Untrusted, so checked and bounded."""

import json
import math
import os
import reprlib
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import yaml
from pydantic import ValidationError

from scenarios.errors import ScenarioError
from scenarios.reading import parse, read_text
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
    return list(read_scenarios(path))


def read_scenarios(path: str | os.PathLike[str]) -> Iterator[Scenario]:
    """What ``load_scenarios`` returns, one after the other: of a large file none but its text is held.

    Raises:
        FileError, ScenarioError: As there; after those that come before what is wrong.
    """
    file = Path(path)
    count, entries = _entries(file)
    if not 1 <= count <= MAX_SCENARIOS:
        raise ScenarioError(f"{file}: found {count} scenarios, allowed 1 to {MAX_SCENARIOS}")
    known = set[str]()
    for k, entry in enumerate(entries):
        scenario = _validate(file, k, count, entry)
        if scenario.id in known:
            raise ScenarioError(f"{file}: id: found {scenario.id!r} twice, allowed once per file")
        known.add(scenario.id)
        yield scenario


def _entries(file: Path) -> tuple[int, Iterator[Any]]:
    """How many values a file holds, and those, made as they are asked for where each has a line of its own."""
    if _suffix(file) == ".jsonl":
        lines = [line for line in read_text(file, MAX_FILE_BYTES).split("\n") if line.strip()]
        return len(lines), (entry for line in lines for entry in parse(file, ".jsonl", line))
    values = read_entries(file)
    return len(values), iter(values)


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
