"""An experiment: which planners meet which scenarios, and every choice that decides the rows."""

from __future__ import annotations

import hashlib
import json
from collections import Counter
from collections.abc import Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator

from planners import PREDICTORS, PlannerSpec, describe, label_of
from scenarios import ContinuumArm, PackedScenarios, Scenario, drawn, load_scenarios
from scenarios.families import parse_family
from scenarios.reading import read_json
from scenarios.spec import known_name
from suite.errors import SuiteError, one_line
from suite.experiment.code import house, house_code
from suite.trial.task import Code, TrialTask

MAX_TRIALS_IN_ALL = 1_000_000
MAX_MANIFEST_BYTES = 4 * 1024 * 1024


class Experiment(BaseModel):
    """Planners, scenarios and the conditions under which they meet; equal experiments give equal rows."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    planners: Annotated[tuple[str, ...], Field(min_length=1)]
    """Planner specs, such as ``temporal[horizon=3]``."""
    family: str = "orbit"
    arm: str = ""
    """Settings in which the arm differs from the default one, such as ``radius_m=0.015``."""
    obstacles: Annotated[tuple[Annotated[int, Field(ge=0, le=100)], ...], Field(min_length=1)] = (1, 3, 5, 6)
    """Numbers of obstacles; each gets ``trials`` scenarios."""
    trials: Annotated[int, Field(ge=1, le=100_000)] = 10
    seed: Annotated[int, Field(ge=0, lt=2**63)] = 0
    predictor: str | None = None
    """Predictor for every planner; each planner's own if None."""
    margin: Annotated[float | None, Field(ge=0, le=10, allow_inf_nan=False)] = None
    """Standard deviations by which predicted obstacles are grown for every planner; each planner's own if None."""
    limits: bool = False
    """Whether planners have to keep to the arm's bending rate and tip speed."""
    noise_mm: Annotated[float, Field(ge=0, le=1000, allow_inf_nan=False)] = 0.0
    """Standard deviation of the noise on observed positions [mm]."""
    dropout: Annotated[float, Field(ge=0, lt=1, allow_inf_nan=False)] = 0.0
    """Probability that an observation is lost."""
    scenario_files: tuple[str, ...] = ()
    """Files to take the scenarios from, in place of ``family``, ``arm``, ``obstacles``, ``trials`` and ``seed``."""

    @field_validator("planners")
    @classmethod
    def _known_planners(cls, planners: tuple[str, ...]) -> tuple[str, ...]:
        labels = [label_of(text) for text in planners]
        _refuse_repeats("planners", labels)
        return tuple(text.strip() if ":" in text else "".join(text.split()) for text in planners)

    @field_validator("family")
    @classmethod
    def _known_family(cls, family: str) -> str:
        parse_family(family)
        return family

    @field_validator("arm")
    @classmethod
    def _known_arm(cls, arm: str) -> str:
        ContinuumArm.from_text(arm)
        return arm

    @field_validator("predictor")
    @classmethod
    def _known_predictor(cls, predictor: str | None) -> str | None:
        return None if predictor is None else known_name("predictor", predictor, PREDICTORS)

    @field_validator("obstacles")
    @classmethod
    def _different_obstacles(cls, obstacles: tuple[int, ...]) -> tuple[int, ...]:
        _refuse_repeats("obstacles", obstacles)
        return obstacles

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
            loaded = (scenario for file in self.scenario_files for scenario in load_scenarios(file))
            scenarios = PackedScenarios(_each_once(loaded))
            self._refuse_too_many(len(scenarios))
            return scenarios
        self._refuse_too_many(len(self.obstacles) * self.trials)  # before they are generated
        arm = ContinuumArm.from_text(self.arm)
        return PackedScenarios(s for n in self.obstacles for s in drawn(self.family, n, self.trials, self.seed, arm))

    def _refuse_too_many(self, n_scenarios: int) -> None:
        n_trials = n_scenarios * len(self.planners)
        if n_trials > MAX_TRIALS_IN_ALL:
            raise SuiteError(f"experiment: found {n_trials} trials in all, allowed {MAX_TRIALS_IN_ALL}")

    def tasks(self, scenarios: Iterable[Scenario]) -> Iterator[TrialTask]:
        """Every planner on every scenario: scenario by scenario, so that an unfinished run compares like with like."""
        codes = self.codes()
        lineup = [(spec, codes[spec.label]) for spec in self.specs()]
        for scenario in scenarios:
            for spec, code in lineup:
                yield TrialTask(
                    scenario,
                    spec,
                    spec.predictor_for(self.predictor),
                    self.limits,
                    self.seed,
                    self.noise_mm,
                    self.dropout,
                    self.margin,
                    code,
                )

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
        """A folder name that more planners, scenarios or numbers of obstacles leave as it is: the run there grows."""
        source = Path(self.scenario_files[0]).stem if self.scenario_files else self.family.partition("[")[0]
        conditions = self.model_dump_json(exclude={"planners", "obstacles", "trials"})
        digest = hashlib.sha256(conditions.encode()).hexdigest()
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


PRESETS: dict[str, dict[str, Any]] = {
    "table1": {
        "planners": ("t2", "t3", "temporal-best", "h", "hs", "pf"),
        "obstacles": (1, 3, 5, 6),
        "trials": 100,
        "seed": 0,
    },
}
"""Named experiments, as fields of ``Experiment``; ``table1`` is Table I of the paper, and its idea at its best."""


def preset_fields(preset: str) -> dict[str, Any]:
    """Fields of a named experiment, or of the one in a manifest.

    Args:
        preset: A name in ``PRESETS``, or a file ``manifest.json`` of a run.

    Raises:
        SuiteError, FileError: There is no such name or file, or no experiment in it.
    """
    if preset in PRESETS:
        return PRESETS[preset]
    if not preset.endswith(".json"):
        raise SuiteError(f"preset: found {preset!r}, allowed {', '.join(PRESETS)} or the manifest.json of a run")
    manifest = read_json(Path(preset), MAX_MANIFEST_BYTES)
    fields = manifest.get("experiment") if isinstance(manifest, dict) else None
    if not isinstance(fields, dict):
        raise SuiteError(f"{preset}: found no experiment in it, allowed the manifest.json of a run")
    return fields


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
