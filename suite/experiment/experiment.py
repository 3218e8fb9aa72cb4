"""An experiment: which planners meet which scenarios, and every choice that decides the rows."""

from __future__ import annotations

import hashlib
import itertools
import json
import math
from collections import Counter
from collections.abc import Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Annotated, Any, NamedTuple, Self, TypeVar

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    PlainSerializer,
    ValidationError,
    ValidationInfo,
    field_validator,
    model_validator,
)

from planners import PREDICTORS, PlannerSpec, describe, label_of, parse_planner
from scenarios import ContinuumArm, PackedScenarios, Scenario, drawn, read_scenarios
from scenarios.families import parse_family
from scenarios.spec import known_name
from suite.errors import SuiteError, one_line
from suite.experiment.code import house, house_code
from suite.experiment.values import arms_of, listed, specs_of
from suite.trial.task import Code, TrialTask

MAX_TRIALS_IN_ALL = 1_000_000

_Value = TypeVar("_Value")


def _several(value: Any, info: ValidationInfo) -> Any:
    try:
        return value if info.field_name in _NOTATED else listed(value)
    except SuiteError as error:
        raise SuiteError(f"{info.field_name}: {error}") from None


def _as_given(values: tuple[Any, ...]) -> Any:
    """One value as itself: a sweep can be told from what is none."""
    return values[0] if len(values) == 1 else list(values)


Several = Annotated[
    tuple[_Value, ...], BeforeValidator(_several), Field(min_length=1), PlainSerializer(_as_given, when_used="json")
]
"""A condition that has one value, or is swept."""

_NOTATED = ("family", "arm")
"""Conditions in a notation of their own, in which commas part settings."""
_SENSED = ("predictor", "margin", "limits", "noise_mm", "dropout")
"""Conditions under which one scenario may be met again."""


class _Meeting(NamedTuple):
    """A planner and the conditions under which it meets every scenario."""

    spec: PlannerSpec
    code: Code
    predictor: str | None
    margin: float | None
    limits: bool
    noise_mm: float
    dropout: float

    @property
    def identity(self) -> tuple[object, ...]:
        """Equal where trials would be: another margin, say, makes no difference to a bound."""
        had = self.spec.predictor_for(self.predictor), self.spec.margin_for(self.margin)
        return self.spec.label, *had, self.limits, self.noise_mm, self.dropout

    def task(self, scenario: Scenario, seed: int) -> TrialTask:
        had = self.spec.predictor_for(self.predictor)
        return TrialTask(
            scenario, self.spec, had, self.limits, seed, self.noise_mm, self.dropout, self.margin, self.code
        )


class Experiment(BaseModel):
    """Planners, scenarios and the conditions under which they meet; equal experiments give equal rows.

    Wherever a condition may have several values, every combination is run: a sweep.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    planners: Annotated[tuple[str, ...], Field(min_length=1)]
    """Planner specs, such as ``temporal[horizon=3]``; ``temporal[horizon=2..5]`` is four."""
    family: Several[str] = ("orbit",)
    """Families with the settings in which they differ from their defaults, such as ``orbit[max_speed_m_s=0.03]``."""
    arm: Several[str] = ("",)
    """Settings in which the arm differs from the default one, such as ``radius_m=0.015``."""
    obstacles: Annotated[
        tuple[Annotated[int, Field(ge=0, le=100)], ...], BeforeValidator(_several), Field(min_length=1)
    ] = (1, 3, 5, 6)
    """Numbers of obstacles; each gets ``trials`` scenarios."""
    trials: Annotated[int, Field(ge=1, le=100_000)] = 10
    seed: Several[Annotated[int, Field(ge=0, lt=2**63)]] = (0,)
    predictor: Several[str | None] = (None,)
    """Predictor for every planner; each planner's own if None."""
    margin: Several[Annotated[float | None, Field(ge=0, le=10, allow_inf_nan=False)]] = (None,)
    """Standard deviations by which predicted obstacles are grown for every planner; each planner's own if None."""
    limits: Several[bool] = (False,)
    """Whether planners have to keep to the arm's bending rate and tip speed."""
    noise_mm: Several[Annotated[float, Field(ge=0, le=1000, allow_inf_nan=False)]] = (0.0,)
    """Standard deviation of the noise on observed positions [mm]."""
    dropout: Several[Annotated[float, Field(ge=0, lt=1, allow_inf_nan=False)]] = (0.0,)
    """Probability that an observation is lost."""
    scenario_files: tuple[str, ...] = ()
    """Files to take the scenarios from, in place of ``family``, ``arm``, ``obstacles``, ``trials`` and ``seed``."""

    @field_validator("planners", mode="before")
    @classmethod
    def _each_planner(cls, planners: Any) -> Any:
        return specs_of(planners)

    @field_validator("planners")
    @classmethod
    def _known_planners(cls, planners: tuple[str, ...]) -> tuple[str, ...]:
        labels = [label_of(text) for text in planners]
        _refuse_repeats("planners", labels)
        return tuple(text.strip() if ":" in text else "".join(text.split()) for text in planners)

    @field_validator("family", mode="before")
    @classmethod
    def _each_family(cls, family: Any) -> Any:
        return specs_of(family)

    @field_validator("family")
    @classmethod
    def _known_families(cls, families: tuple[str, ...]) -> tuple[str, ...]:
        for family in families:
            parse_family(family)
        return families

    @field_validator("arm", mode="before")
    @classmethod
    def _each_arm(cls, arm: Any) -> Any:
        return arms_of(arm)

    @field_validator("arm")
    @classmethod
    def _known_arms(cls, arms: tuple[str, ...]) -> tuple[str, ...]:
        for arm in arms:
            ContinuumArm.from_text(arm)
        return arms

    @field_validator("predictor")
    @classmethod
    def _known_predictors(cls, predictors: tuple[str | None, ...]) -> tuple[str | None, ...]:
        own = [None if name in {None, "own"} else name for name in predictors]
        return tuple(None if name is None else known_name("predictor", name, PREDICTORS) for name in own)

    @model_validator(mode="after")
    def _different_values(self) -> Self:
        for field in ("family", "arm", "obstacles", *_SENSED, "seed"):
            _refuse_repeats(field, getattr(self, field))
        return self

    def with_bound(self, effort: int = 1) -> Self:
        """The same with ``clairvoyant`` among the planners, which says what is possible (docs/possible.md).

        Args:
            effort: How many times its usual number of searches it makes before it gives a scenario up.
        """
        usual: Any = parse_planner("clairvoyant").settings
        spec = "clairvoyant" if effort == 1 else f"clairvoyant[restarts={effort * usual.restarts}]"
        return self.model_copy(update={"planners": tuple(dict.fromkeys([*self.planners, spec]))})

    def specs(self) -> list[PlannerSpec]:
        """The planners, in the order they were asked for."""
        with ThreadPoolExecutor(8) as pool:  # each planner from outside is looked at by a process of its own
            return list(pool.map(describe, self.planners))

    def scenarios(self) -> PackedScenarios:
        """Load or generate the scenarios, in a fixed order.

        Raises:
            ScenarioError: A scenario file is broken.
            SuiteError: Two scenarios are the same, or there are too many trials.
        """
        if self.scenario_files:
            loaded = (scenario for file in self.scenario_files for scenario in read_scenarios(file))
            scenarios = PackedScenarios(_each_once(loaded))
            self._refuse_too_many(len(scenarios) * len(self.seed))
            return scenarios
        draws = list(itertools.product(self.arm, self.family, self.seed, self.obstacles))
        self._refuse_too_many(len(draws) * self.trials)  # before they are generated
        arms = {text: ContinuumArm.from_text(text) for text in self.arm}
        generated = (s for arm, family, seed, n in draws for s in drawn(family, n, self.trials, seed, arms[arm]))
        return PackedScenarios(_each_name_once(generated))

    def _refuse_too_many(self, n_scenarios: int) -> None:
        sensed = math.prod(len(getattr(self, field)) for field in _SENSED)
        n_trials = n_scenarios * len(self.planners) * sensed
        if n_trials > MAX_TRIALS_IN_ALL:
            raise SuiteError(f"experiment: found {n_trials} trials in all, allowed {MAX_TRIALS_IN_ALL}")

    def tasks(self, scenarios: Iterable[Scenario]) -> Iterator[TrialTask]:
        """Every planner on every scenario: scenario by scenario, so that an unfinished run compares like with like."""
        meetings = self._meetings()
        for scenario in scenarios:
            for seed in self._seeds(scenario.seed):
                for meeting in meetings:
                    yield meeting.task(scenario, seed)

    def count(self, n_scenarios: int) -> int:
        """How many tasks there are with so many scenarios."""
        return n_scenarios * len(self._seeds(0)) * len(self._meetings())

    def _seeds(self, drawn: int) -> tuple[int, ...]:
        """Seeds under which a scenario is met: the one it was drawn with, or all where it comes from a file."""
        return self.seed if self.scenario_files else (drawn,)

    def _meetings(self) -> list[_Meeting]:
        """What happens on every scenario; conditions that come to the same for a planner are one."""
        codes = self.codes()
        lineup = [(spec, codes[spec.label]) for spec in self.specs()]
        sensed = itertools.product(*(getattr(self, field) for field in _SENSED))
        every = [_Meeting(spec, code, *conditions) for conditions in sensed for spec, code in lineup]
        return list({meeting.identity: meeting for meeting in every[::-1]}.values())[::-1]

    def codes(self) -> dict[str, Code]:
        """Which code runs each planner, by label."""
        ours = house_code(house())
        return {spec.label: Code(ours, spec.code or ours) for spec in self.specs()}

    def fingerprint(self) -> str:
        """16 hexadecimal digits of all that decides which rows are asked for, scenario files and code included."""
        digest = hashlib.sha256(json.dumps([self.model_dump(mode="json"), self.codes()]).encode())
        for file in map(Path, self.scenario_files):
            if file.is_file():  # reading it as scenarios will say what is wrong with another
                digest.update(file.read_bytes())
        return digest.hexdigest()[:16]

    @property
    def name(self) -> str:
        """A folder name that more planners, scenarios or values of what is swept leave as it is: runs grow."""
        source = Path(self.scenario_files[0]).stem if self.scenario_files else self.family[0].partition("[")[0]
        conditions = self.model_dump(mode="json", exclude={"planners", "obstacles", "trials"})
        swept = [field for field, value in conditions.items() if field != "scenario_files" and isinstance(value, list)]
        digest = hashlib.sha256(json.dumps(conditions | dict.fromkeys(swept, "swept")).encode()).hexdigest()
        return f"{source}-{digest[:8]}"


def make_experiment(**values: Any) -> Experiment:
    """Validate the fields of an experiment.

    Raises:
        SuiteError: A value is not allowed; one line that names the field, what was found and what is allowed.
    """
    try:
        return Experiment(**values)
    except ValidationError as error:
        raise SuiteError(one_line(error)) from None


def _each_name_once(scenarios: Iterable[Scenario]) -> Iterator[Scenario]:
    """Refuse families that are the same, such as ``orbit`` and ``orbit[max_speed_m_s=0.015]``."""
    names = set[str]()
    for scenario in scenarios:
        if scenario.id in names:
            raise SuiteError(f"family: found {scenario.id} 2 times, allowed families and arms that differ")
        names.add(scenario.id)
        yield scenario


def _refuse_repeats(field: str, values: Iterable[object]) -> None:
    value, times = Counter(values).most_common(1)[0]
    if times > 1:
        raise SuiteError(f"{field}: found {value} {times} times, allowed once")


def _each_once(scenarios: Iterable[Scenario]) -> Iterator[Scenario]:
    """Refuse twins: a trial is known by its scenario's content, and its seed and row by the scenario's name.

    Raises:
        SuiteError: A content or a name is there twice.
    """
    by_hash: dict[str, str] = {}
    names = set[str]()
    for scenario in scenarios:
        twin = by_hash.setdefault(scenario.content_hash, scenario.id)
        if twin != scenario.id:
            raise SuiteError(f"scenario files: found {scenario.id}, the same problem as {twin}, allowed once")
        if scenario.id in names:
            raise SuiteError(f"scenario files: found {scenario.id} 2 times, allowed once")
        names.add(scenario.id)
        yield scenario
