"""Whole trials both ways: ``python -m tests.arbiter [PLANNERS [TRIALS [SEED]]]``, TRIALS a number of obstacles.

Prints, for each planner, in how many trials the two rows differ, how many questions the arbiter was asked, and on how
many motions a kernel and the validator differ. Exits with 1 where a planner breaks its promise.
"""

import sys
import time

from scenarios.spec import split_specs

from . import PLANNERS, both_ways


def main(planners: str = ",".join(PLANNERS), trials: str = "50", seed: str = "1000") -> int:
    """Print a line per planner."""
    broken = 0
    for planner in split_specs(planners):
        started = time.perf_counter()
        found = both_ways(planner, int(trials), int(seed))
        broken += not found.is_kept
        verdict = "kept" if found.is_kept else "BROKEN"
        print(f"{verdict:6} {planner:14} {found} {time.perf_counter() - started:5.0f} s", flush=True)
    return int(broken > 0)


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
