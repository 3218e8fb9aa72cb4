"""Whether anything that was solved is proven impossible: ``python docs/figures/sound.py RUN...``.

Every success of the runs, swept or executable, against the bounds of its scenario's proof (docs/possible.md).
"""

import sys
from concurrent.futures import ProcessPoolExecutor
from typing import NamedTuple

import suite
from scenarios import Scenario, load_scenarios
from scenarios.proofs import prove

VERDICTS = ("swept", "executable")


class Solved(NamedTuple):
    """A scenario, and when somebody arrived in it, by verdict [s]."""

    scenario: Scenario
    arrivals_s: dict[str, list[float]]


def solved_in(folder: str) -> list[Solved]:
    """Scenarios of a run in which somebody succeeded."""
    run = suite.load(folder)
    scenarios = {scenario.id: scenario for scenario in load_scenarios(run.folder / "scenarios.jsonl")}
    found: dict[str, dict[str, list[float]]] = {}
    for verdict in VERDICTS:
        successes = run.trials[run.trials[f"success_{verdict}"].fillna(False).astype(bool)]
        for scenario_id, arrivals in successes.groupby("scenario_id")["arrival_time_s"]:
            found.setdefault(scenario_id, {})[verdict] = arrivals.tolist()
    return [Solved(scenarios[scenario_id], arrivals) for scenario_id, arrivals in found.items()]


def refuted(solved: Solved) -> bool:
    """Whether an arrival lies outside its verdict's bound."""
    bounds = prove(solved.scenario)._asdict()
    return any(
        not bounds[verdict].earliest_s <= t < bounds[verdict].latest_s
        for verdict, arrivals in solved.arrivals_s.items()
        for t in arrivals
    )


def main() -> None:
    """Print the counts, and how far it is."""
    everything = [one for folder in sys.argv[1:] for one in solved_in(folder)]
    executable = sum("executable" in one.arrivals_s for one in everything)
    wrong = 0
    with ProcessPoolExecutor() as pool:
        for count, is_wrong in enumerate(pool.map(refuted, everything, chunksize=10), 1):
            wrong += is_wrong
            if count % 100 == 0:
                sys.stderr.write(f"{count} of {len(everything)}: {wrong} refuted\n")
    sys.stdout.write(f"{len(everything)} scenarios solved, {executable} executable: {wrong} outside their bounds\n")


if __name__ == "__main__":
    main()
