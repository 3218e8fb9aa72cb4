"""Hard scenarios of family orbit, listed rather than drawn: somebody solves them and OMPL's RRT did not.

``suite generate FILE --keep possible-hard`` makes such lists (docs/possible.md); ``hard.csv`` is one of them.
"""

import csv
import functools
import re
from pathlib import Path

import numpy as np

from scenarios.arm import ContinuumArm
from scenarios.families.base import Family, Problem

LIST = Path(__file__).with_name("hard.csv")

_ID = re.compile(r"orbit-n(\d+)-s(\d+)-(\d+)")


class HardFamily(Family):
    """A list has no ranges."""

    def draw(self, rng: np.random.Generator, arm: ContinuumArm, n_obstacles: int) -> Problem:
        """Refuse: which scenarios are hard has been found out, by trying."""
        raise ValueError("found nothing to draw from, allowed what is listed")


@functools.cache
def origins() -> dict[int, list[tuple[int, int]]]:
    """Seed and number of each hard scenario in family orbit, by its number of obstacles."""
    found: dict[int, list[tuple[int, int]]] = {}
    with LIST.open(encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            match = _ID.fullmatch(row["scenario_id"])
            assert match, row
            n, seed, number = map(int, match.groups())
            found.setdefault(n, []).append((seed, number))
    return found
