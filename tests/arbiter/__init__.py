"""Whole trials both ways: with planners' kernels, and with every check asked of the shared checker and validator."""

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

ROOT = Path(__file__).resolve().parents[2]
OBSTACLES = (1, 3, 5, 6)
PLANNERS = ("t3", "temporal-best", "h", "hs", "pf", "prm", "strrt", "temporal-ct")
CAUTIOUS = {"temporal-ct": 0.001}
"""Planners that give up a motion which they cannot prove free soon, and on what share of motions at most."""


class BothWays(NamedTuple):
    """What came of the trials of one planner."""

    trials: int
    different: int
    """Trials whose rows differ."""
    solves: int
    through_ompl: int
    """Questions that checker and validator answer in a run, those of OMPL, of the session and of the planner's code."""
    asked: int
    """Questions that the planner's kernels decide themselves in a run, here put to checker and validator."""
    unsafe: int
    """Motions free to the kernel alone, or distances that are not the checker's."""
    cautious: int
    """Motions free to the validator alone."""
    allowed: float
    """Share of ``asked`` on which the planner may be cautious."""

    @property
    def is_kept(self) -> bool:
        """Whether the planner's kernels give the arbiter's answers, but for what it errs on the safe side by design."""
        errs = self.cautious <= self.allowed * self.asked
        return self.asked > 0 and self.unsafe == 0 and errs and (self.allowed > 0 or self.different == 0)

    def __str__(self) -> str:
        """One line."""
        return (
            f"{self.different} of {self.trials} trials differ; a solve asks {self.through_ompl / self.solves:.1f} and "
            f"decides {self.asked / self.solves:.1f}, {self.asked:,} in all; free to the kernel alone {self.unsafe}, "
            f"to the arbiter alone {self.cautious}"
        )


def both_ways(
    planner: str, trials: int, seed: int, obstacles: tuple[int, ...] = OBSTACLES, *, interpreted: bool = False
) -> BothWays:
    """Run ``trials`` scenarios of family orbit for each number of obstacles with the kernels and with questions.

    With ``interpreted`` nothing is compiled for the questions, which is sooner done for a few trials.
    """
    given = planner, str(seed), str(trials), ",".join(map(str, obstacles))
    own = _run({}, "own", *given)
    if interpreted:
        asked = _run({"NUMBA_DISABLE_JIT": "1"}, "ask", *given)
    else:
        with tempfile.TemporaryDirectory() as cache:  # kernels that ask must never be found by anybody else
            asked = _run({"SUITE_CACHE_DIR": cache}, "ask", *given)
    different = sum(one != other for one, other in zip(own["rows"], asked["rows"], strict=True))
    solves = sum(row["n_solves"] or 0 for row in own["rows"])
    counts = (asked[name] for name in ("asked", "unsafe", "cautious"))
    return BothWays(len(own["rows"]), different, solves, own["through_ompl"], *counts, CAUTIOUS.get(planner, 0.0))


def _run(setting: Mapping[str, str], *arguments: str) -> dict[str, Any]:
    command = [sys.executable, "-m", "tests.arbiter.asked", *arguments]
    done = subprocess.run(command, cwd=ROOT, env=os.environ | setting, capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(f"{' '.join(arguments)}: {done.stderr[-2000:]}")
    answer: dict[str, Any] = json.loads(done.stdout)
    return answer
