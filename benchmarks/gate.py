"""How often the gate of ``suite compare`` is wrong: false alarms and power, simulated and on real trials.

Of simulated pairs a tenth are discordant. Real ones come from a pool: one cheap planner on the same scenarios with many
seeds. A run takes, scenario by scenario, the trial of one seed, its partner that of another: a pair of runs that differ
in nothing but the planner's seed. To run 200 such pairs anew would take hours.
"""

from __future__ import annotations

import tempfile
from collections import Counter
from pathlib import Path

import numpy as np
import pandas as pd

import suite
from benchmarks.timing import Line
from scenarios import generate, save_scenarios
from suite.compare.gate import Bar, Judgement, compare_runs, judge_success

PLANNER = "rrt[iterations=100]"
DISCORDANT = 0.10
LOSS = 0.05
BAR = Bar()
PAIRS = (100, 200, 400)


def gate(quick: bool) -> list[Line]:
    """False alarms and power of the gate, in percent of pairs of runs."""
    return _simulated(2_000 if quick else 20_000) + _on_real_trials(*((40, 3, 20) if quick else (400, 6, 200)))


def _simulated(repeats: int) -> list[Line]:
    """Counts of pairs drawn as if each were independent."""
    rng = np.random.default_rng(0)
    lines = []
    for pairs in PAIRS:
        for loss, named in ((0.0, "no loss"), (LOSS, f"a loss of {100 * LOSS:g} points")):
            shares = [0.5 * (DISCORDANT + loss), 0.5 * (DISCORDANT - loss), 1.0 - DISCORDANT]
            drawn = Counter(map(tuple, rng.multinomial(pairs, shares, size=repeats)[:, :2].tolist()))
            said: Counter[Judgement] = Counter()
            for (only_base, only_new), times in drawn.items():
                said[judge_success(only_base, only_new, pairs, BAR)] += times
            for judgement in (Judgement.REGRESSION, Judgement.NON_INFERIOR):
                shown = said[judgement] + (said[Judgement.BETTER] if judgement == Judgement.NON_INFERIOR else 0)
                lines.append(Line(f"simulated, {pairs} pairs, {named}: {judgement}", 100 * shown / repeats, "%"))
    return lines


def _on_real_trials(scenarios: int, seeds: int, repeats: int) -> list[Line]:
    """Pairs of runs put together from real trials, as they are and with successes lost in one of them."""
    pool = _pool(scenarios, seeds)
    rng = np.random.default_rng(1)
    alarms: Counter[str] = Counter()
    discordant = 0.0
    for _ in range(repeats):
        base, new = _two_runs(pool, rng)
        discordant += float((base["success_executable"].to_numpy() != new["success_executable"].to_numpy()).mean())
        alarms.update(_alarms(base, new, "as they are"))
        alarms.update(_alarms(base, _worse(new, rng), "loses"))
    success = 100 * pool["success_executable"].mean()
    pairs = f"real, {scenarios} pairs"
    return [
        Line(f"real trials: success of {PLANNER}", success, "%"),
        Line(f"{pairs}: discordant", 100 * discordant / repeats, "%"),
        Line(f"{pairs}, another seed: success a regression", 100 * alarms["as they are", "success"] / repeats, "%"),
        Line(f"{pairs}, another seed: a cost a regression", 100 * alarms["as they are", "cost"] / repeats, "%"),
        Line(f"{pairs}, another seed: exit code 1", 100 * alarms["as they are", "any"] / repeats, "%"),
        Line(f"{pairs}, 5 points lost: success a regression", 100 * alarms["loses", "success"] / repeats, "%"),
    ]


def _pool(scenarios: int, seeds: int) -> pd.DataFrame:
    """Trials of the planner on the same scenarios, with every seed."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "scenarios.jsonl"
        save_scenarios(file, [one for n in (3, 6) for one in generate("orbit", n, scenarios // 2, 0)])
        runs = [
            suite.run(PLANNER, scenario_files=(str(file),), seed=seed, processes=2, out=Path(folder) / str(seed)).trials
            for seed in range(seeds)
        ]
    return pd.concat(runs, ignore_index=True)


def _two_runs(pool: pd.DataFrame, rng: np.random.Generator) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Two trials of each scenario, with different seeds, one for each run."""
    by_scenario = pool.groupby("scenario_hash").indices.values()
    chosen = np.array([rng.choice(rows, size=2, replace=False) for rows in by_scenario])
    return pool.iloc[chosen[:, 0]], pool.iloc[chosen[:, 1]]


def _worse(trials: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """The same with successes turned into failures, each with the probability that costs ``LOSS`` of all trials."""
    won = trials["success_executable"].astype(bool)
    lost = won.to_numpy() & (rng.uniform(size=len(trials)) < LOSS / won.mean())
    return trials.assign(success_executable=won & ~lost)


def _alarms(base: pd.DataFrame, new: pd.DataFrame, kind: str) -> set[tuple[str, str]]:
    regressions = compare_runs(base, new, BAR).of(Judgement.REGRESSION)
    found = {(kind, "success" if finding.quantity == "success" else "cost") for finding in regressions}
    return found | ({(kind, "any")} if found else set())
