"""Hard scenarios of family orbit, listed rather than drawn: somebody solves them and OMPL's RRT did not.

``suite generate FILE --keep possible-hard`` makes such lists (docs/possible.md); ``hard.csv`` is one of them.
"""

import csv
import functools
import re
from collections.abc import Iterator
from pathlib import Path

from scenarios.arm import ContinuumArm
from scenarios.errors import ScenarioError
from scenarios.families.base import Family
from scenarios.families.orbit import OrbitFamily
from scenarios.scenario import Scenario

LIST = Path(__file__).with_name("hard.csv")

_ID = re.compile(r"orbit-n(\d+)-s(\d+)-(\d+)")


class HardFamily(Family):
    """A list has no ranges."""

    def scenarios(self, name: str, n_obstacles: int, trials: int, seed: int, arm: ContinuumArm) -> Iterator[Scenario]:
        """The first ``trials`` of the list, whatever the seed of the experiment is; see ``Family.scenarios``."""
        known = origins()
        if arm != ContinuumArm():
            raise ScenarioError(f"{name}: found another arm, allowed the default one, with which the list was made")
        if n_obstacles not in known:
            raise ScenarioError(f"{name}: found {n_obstacles} obstacles, allowed {', '.join(map(str, known))}")
        listed = known[n_obstacles]
        if trials > len(listed):
            found = f"found {trials} trials, allowed the {len(listed)} listed with {n_obstacles} obstacles"
            raise ScenarioError(f"{name}: {found}")
        for its_seed, number in listed[:trials]:
            scenario = OrbitFamily().scenario("orbit", n_obstacles, number, its_seed, arm)
            named = {"id": scenario.id.replace("orbit", name), "family": name}
            yield scenario.model_copy(update=named | {"parameters": {"n_obstacles": n_obstacles}})


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
