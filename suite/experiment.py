"""An experiment: which planners meet which scenarios, and every choice that decides the rows."""

from __future__ import annotations

import hashlib
from collections import Counter
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator

from planners import PREDICTORS, PlannerSpec, parse_spec
from scenarios.families import FAMILIES, generate
from scenarios.scenario import Scenario, load_scenarios
from suite.errors import SuiteError, describe
from suite.trial import TrialTask

MAX_TRIALS_IN_ALL = 1_000_000


class Experiment(BaseModel):
    """Planners, scenarios and the conditions under which they meet; equal experiments give equal rows."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    planners: Annotated[tuple[str, ...], Field(min_length=1)]
    """Planner specs, such as ``temporal[horizon=3]``."""
    family: str = "orbit"
    obstacles: Annotated[tuple[Annotated[int, Field(ge=0, le=100)], ...], Field(min_length=1)] = (1, 3, 5, 6)
    """Numbers of obstacles; each gets ``trials`` scenarios."""
    trials: Annotated[int, Field(ge=1, le=100_000)] = 10
    seed: Annotated[int, Field(ge=0, lt=2**63)] = 0
    predictor: str = "cubic"
    limits: bool = False
    """Whether planners have to keep to the arm's bending rate and tip speed."""
    noise_mm: Annotated[float, Field(ge=0, le=1000, allow_inf_nan=False)] = 0.0
    """Standard deviation of the noise on observed positions [mm]."""
    dropout: Annotated[float, Field(ge=0, lt=1, allow_inf_nan=False)] = 0.0
    """Probability that an observation is lost."""
    scenario_files: tuple[str, ...] = ()
    """Files to take the scenarios from, in place of ``family``, ``obstacles``, ``trials`` and ``seed``."""

    @field_validator("planners")
    @classmethod
    def _known_planners(cls, planners: tuple[str, ...]) -> tuple[str, ...]:
        labels = [parse_spec(text).label for text in planners]
        _refuse_repeats(labels)
        return planners

    @field_validator("family")
    @classmethod
    def _known_family(cls, family: str) -> str:
        return _one_of(family, FAMILIES)

    @field_validator("predictor")
    @classmethod
    def _known_predictor(cls, predictor: str) -> str:
        return _one_of(predictor, PREDICTORS)

    @field_validator("obstacles")
    @classmethod
    def _different_obstacles(cls, obstacles: tuple[int, ...]) -> tuple[int, ...]:
        _refuse_repeats(obstacles)
        return obstacles

    def specs(self) -> list[PlannerSpec]:
        """The planners, in the order they were asked for."""
        return [parse_spec(text) for text in self.planners]

    def scenarios(self) -> list[Scenario]:
        """Load or generate the scenarios, in a fixed order.

        Raises:
            ScenarioError: A scenario file is broken.
            SuiteError: Two scenarios are the same, or there are too many trials.
        """
        if self.scenario_files:
            scenarios = [scenario for file in self.scenario_files for scenario in load_scenarios(Path(file))]
            _refuse_twins(scenarios)
            count = len(scenarios)
        else:
            count = len(self.obstacles) * self.trials
        if count * len(self.planners) > MAX_TRIALS_IN_ALL:
            raise SuiteError(f"experiment: found {count * len(self.planners)} trials, allowed {MAX_TRIALS_IN_ALL}")
        if self.scenario_files:
            return scenarios
        return [s for n in self.obstacles for s in generate(self.family, n, self.trials, self.seed)]

    def tasks(self, scenarios: Iterable[Scenario]) -> Iterator[TrialTask]:
        """Every planner on every scenario: scenario by scenario, so that an unfinished run compares like with like."""
        specs = self.specs()
        for scenario in scenarios:
            for spec in specs:
                yield TrialTask(
                    scenario, spec, self.predictor, self.limits, self.seed, self.noise_mm, self.dropout
                )

    @property
    def digest(self) -> str:
        """Eight hex digits that name the experiment; scenario files count by their path."""
        return hashlib.sha256(self.model_dump_json().encode()).hexdigest()[:8]


def make_experiment(of: str = "", **values: Any) -> Experiment:
    """Validate ``values`` into an experiment.

    Args:
        of: Where the values come from, for the error line.
        values: Fields of ``Experiment``.

    Raises:
        SuiteError: A value is not allowed; one line that names field, what was found and what is allowed.
    """
    try:
        return Experiment(**values)
    except ValidationError as error:
        raise SuiteError(describe(error, of)) from error


PRESETS: dict[str, dict[str, Any]] = {
    "table1": {"planners": ("t2", "t3", "h", "hs", "pf"), "obstacles": (1, 3, 5, 6), "trials": 100, "seed": 0},
}
"""Named experiments, as fields of ``Experiment``; ``table1`` is Table I of the paper."""


def _one_of(name: str, known: Iterable[str]) -> str:
    if name not in known:
        raise ValueError(f"unknown, known: {', '.join(known)}")
    return name


def _refuse_repeats(values: Iterable[object]) -> None:
    value, times = Counter(values).most_common(1)[0]
    if times > 1:
        raise ValueError(f"each may be given once, {value} is given {times} times")


def _refuse_twins(scenarios: list[Scenario]) -> None:
    seen: dict[str, Scenario] = {}
    for scenario in scenarios:
        twin = seen.setdefault(scenario.content_hash, scenario)
        if twin is not scenario:
            raise SuiteError(f"scenario files: {scenario.id} is the same scenario as {twin.id}")
