"""Which code makes the rows: sources of the house and versions of its libraries, and what planners from outside add."""

from __future__ import annotations

import hashlib
import json
import platform
from collections.abc import Mapping
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any, TypeGuard

DISTRIBUTION = "continuum-arm-suite"
_PACKAGES = ("scenarios", "planners", "suite")
_LIBRARIES = ("ompl", "numpy", "scipy", "numba", "python-fcl", "pydantic")
"""Libraries whose version can change a row."""

House = Mapping[str, Any]
"""``sources``, a hash, and ``versions`` by name: all that a row of the house's own planners depends on."""


def house() -> dict[str, Any]:
    """The house as it is now."""
    return {"sources": source_hash(), "versions": versions()}


def is_house(value: Any) -> TypeGuard[House]:
    """Whether what a file says of a house can be one."""
    return isinstance(value, dict) and isinstance(value.get("sources"), str) and isinstance(value.get("versions"), dict)


def house_code(house: House) -> str:
    """16 hexadecimal digits of a house."""
    text = json.dumps([house["sources"], house["versions"]], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def changes(theirs: House, ours: House) -> list[str]:
    """What has changed from one house to another, each in a few words."""
    there, here = theirs["versions"], ours["versions"]
    found = ["the sources have changed"] if theirs["sources"] != ours["sources"] else []
    return found + [
        f"{name} {there.get(name)} there, {here.get(name)} here"
        for name in sorted({*there, *here})
        if there.get(name) != here.get(name)
    ]


@cache
def source_hash() -> str:
    """16 hexadecimal digits of all Python sources of the three packages."""
    root = Path(__file__).resolve().parents[2]
    digest = hashlib.sha256()
    for file in sorted(file for package in _PACKAGES for file in (root / package).rglob("*.py")):
        digest.update(file.relative_to(root).as_posix().encode() + b"\0" + file.read_bytes() + b"\0")
    return digest.hexdigest()[:16]


def versions() -> dict[str, str | None]:
    """Versions of Python and of the libraries that can change a row; None for what is not installed."""
    return {"python": platform.python_version()} | {name: installed(name) for name in _LIBRARIES}


def installed(distribution: str) -> str | None:
    """Version of an installed distribution, None if it is not installed."""
    try:
        return version(distribution)
    except PackageNotFoundError:
        return None
