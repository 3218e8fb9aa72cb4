"""How a run agrees with the published Table I: ``python docs/figures/agreement.py RUN [VERDICT]``, swept by default.

For every planner of the run that the paper has a row for: success in percent with its 95 % Wilson interval beside the
published one with its own, and the square of their difference over its variance, summed over the cells. Where both are
samples of one thing it exceeds 9.5 over four cells, or 15.5 over eight, once in twenty.
"""

import re
import sys
from pathlib import Path

import pandas as pd
from scipy.stats import binomtest, chi2

PUBLISHED = Path(__file__).resolve().parents[2] / "suite" / "compare" / "published_table1.csv"


def row_of(planner: str) -> str:
    """The paper's name of a planner: T2, T3, H, Hs or PF, whatever its other settings are."""
    horizon = re.search(r"horizon=(\d+)", planner)
    name = planner.partition("[")[0]
    if name.startswith("temporal"):
        return f"T{horizon[1] if horizon else 3}"
    return {"t2": "T2", "t3": "T3", "h": "H", "hs": "Hs", "pf": "PF"}.get(name, name)


def cell(hits: int, trials: int) -> str:
    """Percent and interval."""
    bounds = binomtest(hits, trials).proportion_ci(method="wilson")
    return f"{100 * hits / trials:.0f} [{100 * bounds.low:.0f}, {100 * bounds.high:.0f}]"


def squared(hits: int, trials: int, others: int, of: int) -> float:
    """Squared difference of two shares over its variance."""
    p, q = hits / trials, others / of
    return (p - q) ** 2 / (p * (1 - p) / trials + q * (1 - q) / of)


def main(run: Path, verdict: str) -> None:
    """Print the table."""
    published = pd.read_csv(PUBLISHED).set_index(["planner", "n_obstacles"])
    trials = pd.read_csv(run / "trials.csv")
    for planner, rows in trials.groupby("planner", sort=False):
        total, line = 0.0, []
        for n, of_n in rows.groupby("n_obstacles"):
            if (row_of(planner), n) not in published.index:
                break
            theirs = published.loc[row_of(planner), n]
            hits, others = int(of_n[f"success_{verdict}"].sum()), round(theirs.success_percent * theirs.trials / 100)
            total += squared(hits, len(of_n), others, int(theirs.trials))
            line.append(f"{cell(hits, len(of_n))} / {cell(others, int(theirs.trials))}")
        else:
            beyond = chi2.sf(total, len(line))
            sys.stdout.write(f"{planner:<56} {'  '.join(line)}  sum z2 {total:.1f} (p = {beyond:.2g})\n")


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2] if len(sys.argv) > 2 else "swept")
