"""What is proven impossible beside what ``clairvoyant`` solves, and that nothing solved is ever proven impossible."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Iterator
from itertools import count, cycle, product
from typing import NamedTuple

import numpy as np

from benchmarks.timing import Line
from scenarios import Box, Capsule, ContinuumArm, Cylinder, Mesh, Obstacle, Scenario, Shape, generate
from scenarios.proofs import Proof, Reason, prove
from suite import run_trial

FAMILIES = ("orbit", "crossing", "wander")
ARMS = (
    ContinuumArm(),
    ContinuumArm(n_sections=2, section_length_m=0.22, radius_m=0.02),
    ContinuumArm(n_sections=4, section_length_m=0.11, radius_m=0.012),
    ContinuumArm(section_length_m=0.12, max_bend_rad=2.0, max_bend_rate_rad_s=0.25),
    ContinuumArm(n_sections=1, section_length_m=0.4, radius_m=0.01),
)
SOUNDNESS_SEED = 1919


def possible(quick: bool) -> list[Line]:
    """Seed 0, every family, n = 1, 3, 5, 6: solved by clairvoyant, proven impossible and by what, open."""
    lines = list[Line]()
    prove(generate("orbit", 3, 1, seed=1)[0])  # compiles
    for family in FAMILIES:
        seconds, left_open = list[float](), 0
        for n in (1, 3, 5, 6):
            tally = Counter[str]()
            for scenario in generate(family, n, 10 if quick else 100, seed=0):
                started = time.process_time()
                bound = prove(scenario).executable
                seconds.append(time.process_time() - started)
                if bound.outcome == "impossible":
                    tally[str(bound.reason)] += 1
                else:
                    tally[bound.outcome] += 1
                    tally["open"] += not run_trial(scenario, "clairvoyant").row["success_executable"]
            total = tally.total() - tally["open"]
            proven = sum(tally[reason] for reason in Reason)
            where = f"{family}, n = {n}"
            lines.append(Line(f"{where}: solved by clairvoyant", total - proven - tally["open"], f"of {total}"))
            lines += [Line(f"{where}: impossible by {reason}", tally[reason], "") for reason in Reason if tally[reason]]
            lines += [Line(f"{where}: not impossible, but a deadline", tally["deadline"], "")]
            lines += [Line(f"{where}: open", tally["open"], "")]
            left_open += tally["open"]
        lines.append(Line(f"{family}: open in all", left_open, "", "<= 6" if family == "orbit" else ""))
        median, late, longest = np.percentile(seconds, [50, 95, 100])
        lines.append(Line(f"{family}: processor time of a proof, median", float(median), "s"))
        lines.append(Line(f"{family}: 95th percentile", float(late), "s", "<= 1"))
        lines.append(Line(f"{family}: longest", float(longest), "s"))
    return lines


class Challenge(NamedTuple):
    """A proof put to the test by a planner."""

    scenario: Scenario
    proof: Proof
    executable_s: float | None
    """When the planner arrived, by the executable verdict [s]; None when it failed."""
    swept_s: float | None
    """The same by the swept verdict."""

    @property
    def refuted(self) -> list[str]:
        """Verdicts whose bound the planner has shown to be wrong."""
        pairs = (("executable", self.executable_s), ("swept", self.swept_s))
        bounds = self.proof._asdict()
        return [v for v, t in pairs if t is not None and not bounds[v].earliest_s <= t < bounds[v].latest_s]


def challenges() -> Iterator[Challenge]:
    """Scenarios of every family, five arms, 1 to 15 spheres or 1 to 6 shapes, and planners that try them, for ever.

    ``temporal-ct`` keeps to the rates, ``t2`` does not and so speaks for the swept verdict alone.
    """
    rng = np.random.default_rng(SOUNDNESS_SEED)
    cases = cycle(product((False, True), range(len(ARMS)), FAMILIES))
    for k, (shaped, a, family) in zip(count(), cases, strict=False):
        n = int(rng.integers(1, 7 if shaped else 16))
        scenario = generate(family, n, 1, SOUNDNESS_SEED + k, ARMS[a])[0]
        if shaped:
            scenario = _shaped(scenario, rng)
        # The lattice of t2 is the default arm's.
        planner = "t2" if a == 0 and k % 4 == 0 else "temporal-ct"
        row = run_trial(scenario, planner).row
        arrival = row["arrival_time_s"]
        executable, swept = (arrival if row[f"success_{v}"] else None for v in ("executable", "swept"))
        yield Challenge(scenario, prove(scenario), executable, swept)


def soundness(quick: bool) -> list[Line]:
    """Over 2,000 solved scenarios: how many were proven impossible, or to be solved at another time only."""
    wanted, tally = 60 if quick else 2000, Counter[str]()
    for challenge in challenges():
        tally["tried"] += 1
        tally["executable"] += challenge.executable_s is not None
        tally["swept"] += challenge.swept_s is not None
        tally["impossible"] += challenge.proof.executable.outcome == "impossible"
        tally["refuted"] += bool(challenge.refuted)
        if tally["executable"] >= wanted:
            break
    return [
        Line("scenarios tried", tally["tried"], ""),
        Line("proven impossible", tally["impossible"], ""),
        Line("solved, executable", tally["executable"], "", f">= {wanted}"),
        Line("solved, swept", tally["swept"], ""),
        Line("solved at a time when nobody can arrive", tally["refuted"], "", "<= 0"),
    ]


def _shaped(scenario: Scenario, rng: np.random.Generator) -> Scenario:
    """The same with every sphere replaced by a shape of about its size."""
    bodies = [Obstacle(shape=_shape(rng, obstacle.radius_m), motion=obstacle.motion) for obstacle in scenario.obstacles]
    return scenario.model_copy(update={"obstacles": tuple(bodies)})


def _shape(rng: np.random.Generator, radius: float) -> Shape:
    turned = tuple(rng.normal(size=3).tolist())
    match rng.integers(4):
        case 0:
            return Box(size_m=tuple((radius * rng.uniform(0.5, 3.0, size=3)).tolist()), rotation_rad=turned)
        case 1:
            return Capsule(radius_m=0.6 * radius, length_m=3.0 * radius, rotation_rad=turned)
        case 2:
            return Cylinder(radius_m=radius, length_m=1.5 * radius, rotation_rad=turned)
        case _:
            return Mesh(vertices_m=tuple(map(tuple, (radius * rng.normal(size=(8, 3))).tolist())), rotation_rad=turned)
