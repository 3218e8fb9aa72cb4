"""Compare motion planners for continuum arms among moving obstacles.

``run`` runs an experiment, ``load`` reads one back, ``merge`` puts several together, each as a ``Run``; ``plan`` asks a
planner once, ``run_trial`` runs it through one scenario, ``audit`` judges a motion from anywhere. Arms, scenarios and
kinematics are in ``scenarios``. What is here is imported when it is first used: ``suite --help`` answers at once.
"""

from __future__ import annotations

import sys
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from suite.api import Run, audit, load, merge, plan, run, run_trial

__all__ = ["Run", "audit", "load", "merge", "plan", "run", "run_trial"]


def __getattr__(name: str) -> object:
    if name in __all__:
        from suite import api

        return getattr(api, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__])


def _refuse_shadows() -> None:
    """Say so when a folder or file of the caller's hides ``planners`` or ``scenarios``: what follows makes no sense.

    Raises:
        ImportError: One does; SystemExit with the same line under ``python -m suite``.
    """
    root = Path(__file__).resolve().parents[1]
    for package in ("planners", "scenarios"):
        spec = find_spec(package)
        places = [] if spec is None else [spec.origin or "", *(spec.submodule_search_locations or [])]
        if any(place and Path(place).resolve().is_relative_to(root / package) for place in places):
            continue
        found = next((place for place in places if place), "none")
        line = f"package {package!r}: found {found}, allowed the suite's own: rename yours or run from another folder"
        if sys.argv[:1] == ["-m"]:
            raise SystemExit(f"suite: error: {line}")
        raise ImportError(line)


_refuse_shadows()
