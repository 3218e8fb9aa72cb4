"""Experiments by name."""

from __future__ import annotations

from typing import Any

from scenarios.spec import known_name

PRESETS: dict[str, dict[str, Any]] = {
    "table1": {
        "planners": ("t2", "t3", "temporal-best", "h", "hs", "pf"),
        "obstacles": (1, 3, 5, 6),
        "trials": 100,
        "seed": 0,
    },
}
"""Named experiments, as fields of ``Experiment``; ``table1`` is Table I of the paper, and its idea at its best."""


def preset_of(name: str) -> dict[str, Any]:
    """Fields of a named experiment.

    Raises:
        SpecError: There is none of that name.
    """
    return PRESETS[known_name("preset", name, PRESETS)]
