"""Run trials in this process: ``python -m tests.arbiter.asked ask|own SPEC SEED TRIALS N,N,...``.

Prints a JSON object: rows without their timings, how often checker and validator were asked through OMPL, and with
``ask`` what the planner's kernels asked and found.
"""

import json
import sys

from planners import parse_planner
from scenarios import generate
from suite.trial.columns import TIMING_NAMES
from suite.trial.episode import run_trial
from suite.trial.task import TrialTask

from .court import COURT


def main(how: str, planner: str, seed: str, trials: str, obstacles: str) -> None:
    """Run ``trials`` scenarios for each number of obstacles."""
    if how == "ask":
        from .leaves import put_in_place

        put_in_place()
    COURT.sit()
    spec, rows, through_ompl = parse_planner(planner), [], 0
    for n in map(int, obstacles.split(",")):
        for scenario in generate("orbit", n, int(trials), int(seed)):
            row = run_trial(TrialTask(scenario, spec, spec.predictor_for(None), False, int(seed))).row
            through_ompl += COURT.through_ompl
            rows.append({name: value for name, value in row.items() if name not in TIMING_NAMES})
    found = {"through_ompl": through_ompl, "asked": COURT.asked, "unsafe": COURT.unsafe, "cautious": COURT.cautious}
    json.dump({"rows": rows, **found}, sys.stdout)


if __name__ == "__main__":
    main(*sys.argv[1:])
