"""The manifest of a run: the configuration that reruns it and everything else its rows depend on."""

from __future__ import annotations

import os
import platform
import sys
from pathlib import Path
from typing import Any

from scenarios import PackedScenarios
from suite.experiment.code import house, house_code
from suite.experiment.experiment import Experiment
from suite.experiment.presets import standard_of
from suite.trial.columns import SCHEMA_VERSION

Manifest = dict[str, Any]

MAX_MANIFEST_BYTES = 64 * 1024 * 1024


def make_manifest(experiment: Experiment, scenarios: PackedScenarios) -> Manifest:
    """Describe what the latest command runs: experiment, scenarios, sources, versions, code and machine."""
    ours, codes = house(), experiment.codes()
    standard = standard_of(experiment, scenarios.digest)
    return {
        "schema_version": SCHEMA_VERSION,
        "experiment": experiment.model_dump(mode="json"),
        "standard": standard.name if standard and standard.is_met else None,
        "scenarios": {"count": len(scenarios), "hash": scenarios.digest},
        **ours,
        "code": {
            "house": house_code(ours),
            "planners": {label: code.planner for label, code in codes.items()},
        },
        "machine": {
            "system": f"{platform.system()} {platform.machine()}",
            "processor": _processor(),
            "cores": os.cpu_count(),
        },
    }


def _processor() -> str:
    if sys.platform == "linux":
        for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor() or platform.machine()
