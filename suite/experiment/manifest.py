"""The manifest of a run: the configuration that reruns it and everything else its rows depend on."""

from __future__ import annotations

import hashlib
import json
import os
import platform
import sys
from collections.abc import Sequence
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from scenarios.scenario import Scenario
from suite.experiment.experiment import Experiment

DISTRIBUTION = "continuum-arm-suite"
_PACKAGES = ("scenarios", "planners", "suite")
_LIBRARIES = ("ompl", "numpy", "scipy", "numba", "python-fcl", "pydantic")
"""Libraries whose version can change a row."""

Manifest = dict[str, Any]


def make_manifest(experiment: Experiment, scenarios: Sequence[Scenario]) -> Manifest:
    """Describe a run: experiment, scenarios, sources, versions and machine."""
    hashes = "".join(scenario.content_hash for scenario in scenarios)
    return {
        "experiment": experiment.model_dump(mode="json"),
        "scenarios": {"count": len(scenarios), "hash": hashlib.sha256(hashes.encode()).hexdigest()[:16]},
        "sources": source_hash(),
        "versions": versions(),
        "machine": {
            "system": f"{platform.system()} {platform.machine()}",
            "processor": _processor(),
            "cores": os.cpu_count(),
        },
    }


def differences(theirs: Manifest, ours: Manifest) -> list[str]:
    """What keeps two runs from being one; the machine may change, since only timings depend on it."""
    found = []
    for part in ("experiment", "versions"):
        there, here = theirs.get(part, {}), ours[part]
        names = sorted(set(there) | set(here))
        found += [
            f"{name}: {json.dumps(there.get(name))} there, {json.dumps(here.get(name))} here"
            for name in names
            if there.get(name) != here.get(name)
        ]
    if theirs.get("scenarios") != ours["scenarios"]:
        found.append("other scenarios")
    if theirs.get("sources") != ours["sources"]:
        found.append("the sources have changed since")
    return found


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


def _processor() -> str:
    if sys.platform == "linux":
        for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor() or platform.machine()
