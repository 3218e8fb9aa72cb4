"""Scenarios that tell planners apart: solved by somebody, and failed by the planners that are named."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from itertools import islice
from pathlib import Path
from typing import NamedTuple

from scenarios import Scenario, save_scenarios
from scenarios.proofs import prove
from suite.experiment.experiment import make_experiment
from suite.runner import run_experiment
from suite.store.run_folder import read_trials

FIRST_BATCH, LARGEST_BATCH = 100, 200
MOST_TRIED = 100_000
SOLVERS = ("temporal-ct", "clairvoyant[restarts=2]")
"""Who is to solve them, the quick one first. Most of what both fail nobody can solve, and to find that out takes ten
times as long."""


class Hard(NamedTuple):
    """A scenario that was kept."""

    scenario: Scenario
    solved_by: str
    """Who solved it, executable."""


class Batch(NamedTuple):
    """What came of some scenarios."""

    kept: list[Hard]
    tried: int
    """Scenarios tried in this batch."""


def keep_hard(drawn: Iterator[Scenario], planners: tuple[str, ...], wanted: int, workers: int) -> Iterator[Batch]:
    """Try scenarios, batch by batch, until ``wanted`` are possible and failed by all of ``planners``, executable.

    What is proven impossible at once (docs/possible.md) is given to nobody; what all of them fail to ``SOLVERS``.

    Args:
        drawn: Scenarios, in the order in which they are to be kept.
        planners: Specs of those that are to fail.
        wanted: How many to keep; the iteration ends there, or with ``drawn``.
        workers: Number of worker processes.
    """
    kept = tried = 0
    while kept < wanted:
        share = max(kept, 1) / tried if tried else 1.0
        more = int(1.1 * (wanted - kept) / share) if tried else 0
        scenarios = list(islice(drawn, max(FIRST_BATCH, min(more, LARGEST_BATCH))))
        if not scenarios:
            return
        left = [scenario for scenario in scenarios if prove(scenario, "base").executable.outcome != "impossible"]
        left = _failed(left, planners, workers)
        solved_by = dict[str, str]()
        for solver in SOLVERS:
            unsolved = {scenario.id for scenario in _failed(left, (solver,), workers)}
            solved_by |= {scenario.id: solver for scenario in left if scenario.id not in unsolved}
            left = [scenario for scenario in left if scenario.id in unsolved]
        possible = [Hard(scenario, solved_by[scenario.id]) for scenario in scenarios if scenario.id in solved_by]
        found = possible[: wanted - kept]
        kept, tried = kept + len(found), tried + len(scenarios)
        yield Batch(found, len(scenarios))


def _failed(scenarios: list[Scenario], planners: tuple[str, ...], workers: int) -> list[Scenario]:
    """Those of the scenarios in which none of the planners succeeds."""
    if not scenarios:
        return []
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "scenarios.jsonl"
        save_scenarios(file, scenarios)
        experiment = make_experiment(planners=planners, scenario_files=(str(file),))
        run_experiment(experiment, Path(folder) / "run", workers=workers)
        trials = read_trials(Path(folder) / "run", ("scenario_id", "success_executable"))
    assert trials is not None
    solved = set(trials.loc[trials["success_executable"].fillna(False).astype(bool), "scenario_id"])
    return [scenario for scenario in scenarios if scenario.id not in solved]
