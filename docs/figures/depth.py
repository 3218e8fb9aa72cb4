"""Figure of success against prediction depth: ``python docs/figures/depth.py CUBIC_RUN TRUTH_RUN depth.png``.

The two runs differ in their predictor only; needs matplotlib (the ``report`` extra).
"""

import re
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import pandas as pd
from scipy.stats import binomtest


def depth(planner: str) -> int:
    """Steps planned ahead by ``t2``, ``temporal[horizon=h,...]`` or ``temporal-best``, which looks 3 ahead."""
    return int(next(iter(re.findall(r"\d+", planner)), 3))


def draw(cubic: Path, truth: Path, figure: Path) -> None:
    """Draw swept success over depth, a panel per number of obstacles, with 95 % Wilson intervals."""
    runs = {"cubic prediction": cubic, "the future known": truth}
    trials = {name: pd.read_csv(run / "trials.csv") for name, run in runs.items()}
    counts = sorted(trials["cubic prediction"]["n_obstacles"].unique())
    _, axes = plt.subplots(
        1, len(counts), figsize=(3 * len(counts), 3), sharey=True, squeeze=False, constrained_layout=True
    )
    for axis, n in zip(axes[0], counts, strict=True):
        for name, style in (("cubic prediction", "o-"), ("the future known", "s--")):
            of_n = trials[name][trials[name]["n_obstacles"] == n]
            groups = sorted((depth(planner), rows["success_swept"]) for planner, rows in of_n.groupby("planner"))
            depths = [h for h, _ in groups]
            tests = [binomtest(int(hits.sum()), len(hits)) for _, hits in groups]
            rates = [100 * test.statistic for test in tests]
            bounds = [test.proportion_ci(method="wilson") for test in tests]
            below = [rate - 100 * b.low for rate, b in zip(rates, bounds, strict=True)]
            above = [100 * b.high - rate for rate, b in zip(rates, bounds, strict=True)]
            axis.errorbar(depths, rates, yerr=[below, above], fmt=style, capsize=3, label=name)
        axis.set(title=f"{n} obstacles", xlabel="depth h [steps]")
    axes[0, 0].set(ylabel="success, swept [%]", ylim=(0, 102))
    axes[0, 0].legend(loc="lower left")
    plt.savefig(figure, dpi=110)


if __name__ == "__main__":
    draw(Path(sys.argv[1]), Path(sys.argv[2]), Path(sys.argv[3]))
