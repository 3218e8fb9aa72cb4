"""Compare the success counts of a small run with the recorded ones; ``--record`` writes them anew.

Counts do not depend on the machine's speed, so a count that moves means that a change changed what planners do.
"""

import sys
from pathlib import Path

import pandas as pd

RECORDED = Path(__file__).with_name("smoke.csv")
VERDICTS = ["success_per_step", "success_swept", "success_executable"]


def main(run: Path, record: bool) -> int:
    """Return 0 when every count is as recorded, 1 when one moved."""
    for name in ("table.md", "table.csv", "trials.csv"):
        assert (run / name).stat().st_size > 0, f"{name} is empty"
    trials = pd.read_csv(run / "trials.csv")
    counts = trials.groupby(["planner", "n_obstacles"], as_index=False)[VERDICTS].sum()
    if record:
        counts.to_csv(RECORDED, index=False)
        print(f"smoke comparison: recorded in {RECORDED.name}")
        return 0
    both = pd.read_csv(RECORDED).merge(
        counts, how="outer", on=["planner", "n_obstacles"], suffixes=(" recorded", " found")
    )
    moved = [verdict for verdict in VERDICTS if not both[f"{verdict} recorded"].equals(both[f"{verdict} found"])]
    if moved:
        print(both.to_string(index=False))
        print(f"smoke comparison: {', '.join(moved)} moved; if that is meant: python .ci/smoke.py {run} --record")
        return 1
    print(f"smoke comparison: {len(trials)} trials, all counts as recorded")
    return 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), "--record" in sys.argv[2:]))
