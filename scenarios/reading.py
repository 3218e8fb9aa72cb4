"""The one reader of files from users: bounded, and one line for whatever is wrong with one.

Every file that the suite reads comes through here, whether people or programs wrote it. A path may lead to a pipe, a
device or a file that grows; its text may hold anything.
"""

import json
import os
import re
import stat
from collections.abc import Hashable, Iterable
from pathlib import Path
from typing import Any, BinaryIO

import yaml

from scenarios.errors import FileError, shortened

_HALF = re.compile(r"\\u[dD][89a-fA-F]")
MAX_DEPTH = 50
"""Values may be nested so deep."""


def open_regular(file: Path, most_bytes: int) -> BinaryIO:
    """Open a regular file of at most ``most_bytes``.

    Raises:
        FileError: It cannot be opened, is a folder, a pipe or a device, or is larger.
    """
    try:
        # A pipe that nobody writes to would be waited for.
        handle = os.open(file, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
    except (OSError, ValueError) as error:  # ValueError: a name with a NUL, or with half a character
        raise unreadable(file, error) from None
    found = os.fstat(handle)
    if stat.S_ISREG(found.st_mode) and found.st_size <= most_bytes:
        return os.fdopen(handle, "rb")
    os.close(handle)
    if stat.S_ISREG(found.st_mode):
        raise FileError(f"{file}: found {found.st_size} bytes, allowed {most_bytes}")
    raise FileError(f"{file}: found {_kind(found.st_mode)}, allowed a file")


def read_text(file: Path, most_bytes: int) -> str:
    """The text of a regular file of at most ``most_bytes``, without the mark with which some editors begin one.

    Raises:
        FileError: As ``open_regular``, or it is not UTF-8 text.
    """
    with open_regular(file, most_bytes) as handle:
        try:
            data = handle.read(most_bytes + 1)
        except OSError as error:
            raise unreadable(file, error) from None
    if len(data) > most_bytes:  # it has grown
        raise FileError(f"{file}: found more than {most_bytes} bytes, allowed {most_bytes}")
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise FileError(f"{file}: found bytes that are not UTF-8, allowed UTF-8 text") from None
    if "\0" in text:
        raise FileError(f"{file}: found a NUL, allowed UTF-8 text")
    return text


def unreadable(file: Path, error: Exception) -> FileError:
    """What an operating system's, or a parser's, error becomes."""
    return FileError(f"{file}: cannot be read: {getattr(error, 'strerror', None) or error}")


def read_json(file: Path, most_bytes: int) -> Any:
    """The values in a JSON file.

    Raises:
        FileError: As ``read_text``, or it is not JSON, has a key twice, or values nested deeper than ``MAX_DEPTH``.
    """
    return parse(file, ".json", read_text(file, most_bytes))


def parse(file: Path, suffix: str, text: str) -> Any:
    """The values in the text of a file: YAML, JSON, or a list of JSON values, one per line (.jsonl).

    Raises:
        FileError: As ``read_json``; in YAML, aliases and tags are refused as well.
    """
    try:
        if suffix == ".jsonl":
            return [_parse_json(line) for line in text.split("\n") if line.strip()]
        return _parse_json(text) if suffix == ".json" else _parse_yaml(text)
    except _KeyTwiceError as error:
        raise FileError(f"{file}: found the key {shortened(repr(error.args[0]), 60)} twice, allowed once") from None
    # ValueError: besides broken JSON, a number of thousands of digits or a date such as 2024-13-45.
    except (ValueError, TypeError, yaml.YAMLError, RecursionError) as error:
        first = " ".join(str(error).split()) or type(error).__name__
        raise FileError(f"{file}: not valid {suffix[1:].upper()} (truncated?): {shortened(first, 200)}") from None


def first_twice(names: Iterable[str]) -> str | None:
    """The first name that was there before; None when all differ."""
    seen = set[str]()
    for name in names:
        if name in seen:
            return name
        seen.add(name)
    return None


def _kind(mode: int) -> str:
    if stat.S_ISDIR(mode):
        return "a folder"
    return "a pipe" if stat.S_ISFIFO(mode) else "a device"


class _KeyTwiceError(Exception):
    """A mapping in a file has a key twice."""


def _parse_json(text: str) -> Any:
    value = json.loads(text, object_pairs_hook=_dict_of)
    _refuse_depth(value)
    if _HALF.search(text):
        json.dumps(value, ensure_ascii=False).encode()  # half a character alone can be neither shown nor stored
    return value


def _refuse_depth(value: Any) -> None:
    """Level by level: what looks at the value later may go down by calling itself."""
    level, depth = [value] if isinstance(value, dict | list) else [], 0
    while level:
        depth += 1
        if depth > MAX_DEPTH:
            raise ValueError(f"found values nested deeper than {MAX_DEPTH}")
        inside = [inner for outer in level for inner in (outer.values() if isinstance(outer, dict) else outer)]
        level = [inner for inner in inside if isinstance(inner, dict | list)]


def _dict_of(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """The object, if no key stands twice in it: Python's reader lets the last one win."""
    values = dict(pairs)
    if len(values) < len(pairs):
        raise _KeyTwiceError(first_twice(key for key, _ in pairs))
    return values


def _parse_yaml(text: str) -> Any:
    """Safe YAML of plain values, so that a small file cannot stand for gigabytes or minutes."""
    depth = 0
    for event in yaml.parse(text, Loader=yaml.CSafeLoader):
        if isinstance(event, yaml.AliasEvent) or getattr(event, "tag", None) is not None:
            raise ValueError("found a YAML alias or tag, allowed plain values only")
        depth += isinstance(event, yaml.CollectionStartEvent) - isinstance(event, yaml.CollectionEndEvent)
        # libyaml takes time quadratic in the depth.
        if depth > MAX_DEPTH:
            raise ValueError(f"found values nested deeper than {MAX_DEPTH}")
    return yaml.load(text, Loader=_Loader)


class _Loader(yaml.CSafeLoader):
    """YAML's safe loader, which by itself lets the last of two equal keys win."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Hashable, Any]:
        """The mapping, if no key stands twice in it."""
        twice = first_twice(key.value for key, _ in node.value if isinstance(key, yaml.ScalarNode))
        if twice is not None:
            raise _KeyTwiceError(twice)
        return super().construct_mapping(node, deep)
