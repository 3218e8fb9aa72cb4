"""Families whose scenarios are drawn: number k depends on family, obstacles, seed and k alone."""

import hashlib
import json
from abc import abstractmethod
from collections.abc import Iterator

import numpy as np
from pydantic import BaseModel, Field

from scenarios.arm import ContinuumArm
from scenarios.collision import is_motion_valid
from scenarios.errors import ScenarioError
from scenarios.families.base import Family, Problem
from scenarios.scenario import Scenario
from scenarios.shaped_world import shaped_world
from scenarios.world import positions, sample_times, sample_world


class DrawnFamily(Family):
    """A way to draw problems; its fields are the ranges drawn from."""

    redraw: bool = Field(default=True, description="whether a draw whose start is hit is drawn anew")

    @abstractmethod
    def draw(self, rng: np.random.Generator, arm: ContinuumArm, n_obstacles: int) -> Problem:
        """Draw start, goal and obstacles."""

    def scenarios(self, name: str, n_obstacles: int, trials: int, seed: int, arm: ContinuumArm) -> Iterator[Scenario]:
        """See ``Family.scenarios``."""
        for k in range(trials):
            yield self.scenario(name, n_obstacles, k, seed, arm)

    def scenario(self, name: str, n_obstacles: int, k: int, seed: int, arm: ContinuumArm) -> Scenario:
        """Scenario number ``k``; see ``Family.scenarios`` for the others."""
        digest = hashlib.sha256(f"{name}/{n_obstacles}/{seed}/{k}".encode()).digest()
        rng = np.random.default_rng(int.from_bytes(digest[:8], "big"))
        for _ in range(1000):
            try:
                problem = self.draw(rng, arm, n_obstacles)
            except ValueError as error:
                raise ScenarioError(f"{name}: {error}") from None
            scenario = Scenario(
                id=f"{name}-n{n_obstacles}-s{seed}-{k:04d}{_ending(self, arm)}",
                family=name,
                seed=seed,
                parameters={"n_obstacles": n_obstacles, **self.model_dump()},
                arm=arm,
                start_rad=tuple(problem.start.tolist()),
                goal_m=tuple(problem.goal.tolist()),
                obstacles=problem.obstacles,
            )
            if not self.redraw or start_is_free(scenario):
                return scenario
        raise ScenarioError(f"{name}: every one of 1000 draws hits the start, allowed settings that leave it free")


def _ending(*models: BaseModel) -> str:
    """What tells scenarios of unlike settings apart by name: empty for the defaults, else a hash of what differs."""
    changed = [model.model_dump(exclude_defaults=True) for model in models]
    if not any(changed):
        return ""
    return f"-{hashlib.sha256(json.dumps(changed, sort_keys=True).encode()).hexdigest()[:8]}"


def start_is_free(scenario: Scenario) -> bool:
    """Whether nothing touches the arm at its start at any instant of the observation, [-observation_s, 0]."""
    arm, q, start_s, step_s = scenario.arm, scenario.start, -scenario.observation_s, 0.05
    world = sample_world(scenario.obstacles, start_s, 0.0, step_s)
    if is_motion_valid(arm, q, start_s, q, 0.0, world):
        return True
    centers = positions(scenario.obstacles, sample_times(start_s, 0.0, step_s))
    exact = shaped_world(scenario.obstacles, start_s, step_s, centers)
    return exact is not None and exact.is_motion_valid(arm, q, start_s, q, 0.0)
