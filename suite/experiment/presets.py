"""Experiments by name."""

from __future__ import annotations

from typing import Any, NamedTuple

from scenarios.spec import known_name
from suite.experiment.experiment import Experiment, make_experiment

PRESETS: dict[str, dict[str, Any]] = {
    "table1": {
        "planners": ("t2", "t3", "temporal-best", "h", "hs", "pf"),
        "obstacles": (1, 3, 5, 6),
        "trials": 100,
        "seed": 0,
    },
    "standard-1": {
        "planners": ("t3", "temporal-best", "h", "hs", "pf", "temporal-ct", "rrt", "prm", "strrt", "clairvoyant"),
        "family": ("orbit", "crossing", "wander"),
        "obstacles": (1, 3, 6),
        "trials": 100,
        "seed": 0,
    },
}
"""Named experiments, as fields of ``Experiment``; ``table1`` is Table I of the paper, and its idea at its best.

``standard-1`` is a benchmark to cite: it never changes, a better one gets another number. Any planner may run on it
(``--preset standard-1 --planners mine.py:Mine``).
"""

STANDARDS = {"standard-1": "cf95398f4638c096"}
"""Hash of the scenarios of each benchmark, as ``PackedScenarios.digest``: others are not the benchmark."""

_DRAWN = ("family", "arm", "obstacles", "trials", "seed", "scenario_files")
"""Fields that decide which scenarios there are."""


class Standard(NamedTuple):
    """The benchmark that an experiment asks for."""

    name: str
    is_met: bool
    """Whether the scenarios are the benchmark's."""


def standard_of(experiment: Experiment, digest: str) -> Standard | None:
    """The benchmark that an experiment asks for with scenarios of this ``digest``; None if it asks for none."""
    for name, hash in STANDARDS.items():
        standard = make_experiment(**PRESETS[name])
        if all(getattr(standard, field) == getattr(experiment, field) for field in _DRAWN):
            return Standard(name, digest == hash)
    return None


def preset_of(name: str) -> dict[str, Any]:
    """Fields of a named experiment.

    Raises:
        SpecError: There is none of that name.
    """
    return PRESETS[known_name("preset", name, PRESETS)]
