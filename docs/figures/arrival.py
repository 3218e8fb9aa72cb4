"""What it matters when an arm has arrived: ``python docs/figures/arrival.py PLANNER TRIALS [SEED]``.

Algorithm 2 ends when the tip is in the goal's cube, section V within "some small distance": the ball of the suite. The
same trials are run to either end and judged swept.
"""

import functools
import sys

import numpy as np

from planners import parse_planner
from scenarios import generate
from scenarios.families.base import CUBE_M
from suite.auditor.certificate import certified_contacts
from suite.trial import episode
from suite.trial.execution import Execution
from suite.trial.task import TrialTask


class CubeExecution(Execution):
    """Arrives in the goal's cube."""

    def _arrived(self, configurations: np.ndarray) -> np.ndarray:
        inside = np.floor(self._arm.tips(configurations) / CUBE_M) == np.floor(self._goal / CUBE_M)
        return np.asarray(inside.all(axis=1))


def succeeds(task: TrialTask, execution: type[Execution]) -> bool:
    """Whether the arm arrives, and nothing touches it at any instant before."""
    made: list[Execution] = []

    def make(*given: object) -> Execution:
        made.append(execution(*given))
        return made[0]

    episode.Execution = make  # type: ignore[assignment,misc]  # the trial's own loop, with another end
    result = episode.run_trial(task)
    contacts = certified_contacts(
        task.scenario, result.times_s, result.configurations_rad, float(result.times_s[-1])
    )  # fmt: skip
    return made[0].has_arrived and bool(np.isnan(contacts.swept_s))


def main(planner: str, trials: int, seed: int) -> None:
    """Print both shares for each number of obstacles."""
    spec = parse_planner(planner)
    for n in (1, 3, 5, 6):
        tasks = [TrialTask(scenario, spec, "cubic", False, seed) for scenario in generate("orbit", n, trials, seed)]
        ball, cube = (
            sum(map(functools.partial(succeeds, execution=kind), tasks)) for kind in (Execution, CubeExecution)
        )
        sys.stdout.write(f"n = {n}: ball {100 * ball / trials:.1f} %, cube {100 * cube / trials:.1f} %\n")


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]) if len(sys.argv) > 3 else 0)
