"""Families of scenarios and the generator that draws from them.

A new family is one subclass of ``Family`` and one line in ``FAMILIES``.
"""

import hashlib
import json
from collections.abc import Iterator

import numpy as np
from pydantic import BaseModel

from scenarios.arm import ContinuumArm
from scenarios.collision import is_motion_valid
from scenarios.errors import ScenarioError
from scenarios.families.base import Family
from scenarios.families.crossing import CrossingFamily
from scenarios.families.hard import HardFamily, origins
from scenarios.families.orbit import OrbitFamily
from scenarios.families.wander import WanderFamily
from scenarios.scenario import Scenario
from scenarios.shaped_world import shaped_world
from scenarios.spec import known_name, parse_settings, parse_spec
from scenarios.world import positions, sample_times, sample_world

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
    arm = arm or ContinuumArm()
    if isinstance(settings, HardFamily):
        yield from _listed(n_obstacles, trials, arm)
        return
    end = _ending(settings, arm)
    for k in range(trials):
        yield _draw(name, settings, n_obstacles, k, seed, arm, end)


def _listed(n_obstacles: int, trials: int, arm: ContinuumArm) -> Iterator[Scenario]:
    """The first ``trials`` of the hard scenarios, whatever the seed of the experiment is."""
    known = origins()
    if arm != ContinuumArm():
        raise ScenarioError("hard: found another arm, allowed the default one, with which the list was made")
    if n_obstacles not in known:
        raise ScenarioError(f"hard: found {n_obstacles} obstacles, allowed {', '.join(map(str, known))}")
    listed = known[n_obstacles]
    if trials > len(listed):
        raise ScenarioError(
            f"hard: found {trials} trials, allowed the {len(listed)} listed with {n_obstacles} obstacles"
        )
    for seed, number in listed[:trials]:
        scenario = _draw("orbit", OrbitFamily(), n_obstacles, number, seed, arm, "")
        named = {"id": scenario.id.replace("orbit", "hard"), "family": "hard"}
        yield scenario.model_copy(update=named | {"parameters": {"n_obstacles": n_obstacles}})


def _ending(*models: BaseModel) -> str:
    """What tells scenarios of unlike settings apart by name: empty for the defaults, else a hash of what differs."""
    changed = [model.model_dump(exclude_defaults=True) for model in models]
    if not any(changed):
        return ""
    return f"-{hashlib.sha256(json.dumps(changed, sort_keys=True).encode()).hexdigest()[:8]}"


def _draw(name: str, settings: Family, n_obstacles: int, k: int, seed: int, arm: ContinuumArm, end: str) -> Scenario:
    digest = hashlib.sha256(f"{name}/{n_obstacles}/{seed}/{k}".encode()).digest()
    rng = np.random.default_rng(int.from_bytes(digest[:8], "big"))
    for _ in range(1000):
        try:
            problem = settings.draw(rng, arm, n_obstacles)
        except ValueError as error:
            raise ScenarioError(f"{name}: {error}") from None
        scenario = Scenario(
            id=f"{name}-n{n_obstacles}-s{seed}-{k:04d}{end}",
            family=name,
            seed=seed,
            parameters={"n_obstacles": n_obstacles, **settings.model_dump()},
            arm=arm,
            start_rad=tuple(problem.start.tolist()),
            goal_m=tuple(problem.goal.tolist()),
            obstacles=problem.obstacles,
        )
        if not settings.redraw or start_is_free(scenario):
            return scenario
    raise ScenarioError(f"{name}: every one of 1000 draws hits the start, allowed settings that leave it free")


def start_is_free(scenario: Scenario) -> bool:
    """Whether nothing touches the arm at its start at any instant of the observation, [-observation_s, 0]."""
    arm, q, start_s, step_s = scenario.arm, scenario.start, -scenario.observation_s, 0.05
    world = sample_world(scenario.obstacles, start_s, 0.0, step_s)
    if is_motion_valid(arm, q, start_s, q, 0.0, world):
        return True
    centers = positions(scenario.obstacles, sample_times(start_s, 0.0, step_s))
    exact = shaped_world(scenario.obstacles, start_s, step_s, centers)
    return exact is not None and exact.is_motion_valid(arm, q, start_s, q, 0.0)
