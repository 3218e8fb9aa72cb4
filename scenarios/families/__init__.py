"""Families of scenarios and the generator that draws from them.

A new family is one subclass of ``DrawnFamily`` and one line in ``FAMILIES``.
"""

from collections.abc import Iterator

from scenarios.arm import ContinuumArm
from scenarios.errors import ScenarioError
from scenarios.families.base import Family
from scenarios.families.crossing import CrossingFamily
from scenarios.families.hard import HardFamily
from scenarios.families.orbit import OrbitFamily
from scenarios.families.wander import WanderFamily
from scenarios.scenario import Scenario
from scenarios.spec import known_name, parse_settings, parse_spec

FAMILIES: dict[str, type[Family]] = {
    "orbit": OrbitFamily,
    "crossing": CrossingFamily,
    "wander": WanderFamily,
    "hard": HardFamily,
}


def parse_family(spec: str) -> tuple[str, Family]:
    """Name and settings of ``orbit`` or ``orbit[max_speed_m_s=0.03]``.

    Raises:
        SpecError: Unknown family or setting; lists the known ones.
    """
    name, values = parse_spec(spec)
    return name, parse_settings(name, FAMILIES[known_name("family", name, FAMILIES)], values)


def generate(family: str, n_obstacles: int, trials: int, seed: int, arm: ContinuumArm | None = None) -> list[Scenario]:
    """Draw scenarios; number k depends on family, obstacles, seed and k alone, never on what was drawn before.

    A draw is rejected when the start is hit while the obstacles are observed (never with ``redraw=false``), and for
    nothing else: a generator must not remove hard cases.

    Args:
        family: Family spec, such as ``orbit``.
        n_obstacles: Number of obstacles in each scenario.
        trials: Number of scenarios.
        seed: Seed of the experiment.
        arm: The arm; the default one when None.

    Raises:
        SpecError: Unknown family or setting.
        ScenarioError: Numbers out of range, or settings from which no scenario can be drawn.
    """
    return list(drawn(family, n_obstacles, trials, seed, arm))


def drawn(family: str, n_obstacles: int, trials: int, seed: int, arm: ContinuumArm | None = None) -> Iterator[Scenario]:
    """What ``generate`` returns, one after the other: nobody needs to hold them all."""
    name, settings = parse_family(family)
    if not 0 <= n_obstacles <= 1000:
        raise ScenarioError(f"obstacles: found {n_obstacles}, allowed 0 to 1000")
    if not 1 <= trials <= 100_000:
        raise ScenarioError(f"trials: found {trials}, allowed 1 to 100000")
    if not 0 <= seed < 2**63:
        raise ScenarioError(f"seed: found {seed}, allowed 0 to 2^63 - 1")
    yield from settings.scenarios(name, n_obstacles, trials, seed, arm or ContinuumArm())
