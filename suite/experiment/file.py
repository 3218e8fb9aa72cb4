"""Experiment files: YAML or JSON with the fields of an experiment, ``preset`` and ``sweep``; manifests are such files.

Untrusted, so read as scenario files are: bounded, plain values, no key twice.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from pathlib import Path
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from scenarios.files import read_entries
from scenarios.spec import parse_spec
from suite.errors import SuiteError
from suite.experiment.experiment import Experiment, make_experiment
from suite.experiment.presets import preset_of
from suite.experiment.values import arms_of, specs_of, with_setting

Scalar = str | float | int | bool | None
Values = Scalar | list[Scalar]
"""One value, a list, or a text such as ``1..10``."""
Settings = dict[str, Values]
"""Settings by name; those of a family, or a planner, with its ``name``."""
Specs = str | Settings | list[str | Settings]

SWEPT = ("family", "arm", "obstacles", "seed", "predictor", "margin", "limits", "noise_mm", "dropout")
SUFFIXES = (".yaml", ".yml", ".json")


class ExperimentFile(BaseModel):
    """What stands in an experiment file; only planners, or a preset, must be there."""

    model_config = ConfigDict(extra="forbid")

    schema_version: Literal[1] = 1
    preset: str | None = Field(None, description="named experiment whose fields hold where none are given here")
    planners: Specs = Field([], description="planners: name[key=value,...], or name and settings")
    family: Specs = Field("orbit", description="families: name[key=value,...], or name and settings")
    arm: Specs = Field("", description="settings in which the arm differs from the default one")
    obstacles: Values = Field("1,3,5,6", description="numbers of obstacles")
    trials: int = Field(10, ge=1, le=100_000, description="scenarios per family, arm, seed and number of obstacles")
    seed: Values = Field(0, description="seeds of the experiment")
    predictor: Values = Field(None, description="predictors; each planner's own when null")
    margin: Values = Field(None, description="margins of predicted obstacles; each planner's own when null")
    limits: Values = Field(False, description="whether planners have to keep to the arm's motion limits")
    noise_mm: Values = Field(0.0, description="standard deviation of the noise on observed positions [mm]")
    dropout: Values = Field(0.0, description="share of observations lost")
    scenario_files: list[str] = Field([], description="scenario files in place of families")
    sweep: dict[str, Values] = Field(
        {}, description="several values of a field, of family.SETTING, of arm.SETTING or of PLANNER.SETTING"
    )

    def fields(self) -> dict[str, Any]:
        """Those of the experiment, with the sweep in them.

        Raises:
            SuiteError, SpecError: The preset or something swept is not known.
        """
        given = self.model_dump(exclude_unset=True, exclude={"schema_version", "preset", "sweep"})
        fields = (preset_of(self.preset) if self.preset else {}) | given
        for key, values in self.sweep.items():
            _sweep(fields, key, values)
        return fields


def is_experiment_file(name: str | Path) -> bool:
    """Whether a file that is there holds an experiment, or something that was to be one, and no scenarios.

    Raises:
        ScenarioError: It can't be read.
    """
    entries = read_entries(Path(name))
    if len(entries) != 1 or not isinstance(entries[0], dict):
        return False
    keys = set(entries[0])
    return bool(keys & {"planners", "preset", "sweep", "experiment"}) and not keys & {"start_rad", "goal_m"}


def read_experiment_file(name: str | Path) -> dict[str, Any]:
    """Fields of the experiment in a file, a manifest included.

    Raises:
        ScenarioError, SuiteError, SpecError: The file cannot be read, or something in it is not allowed; one line that
            names the file.
    """
    file = Path(name)
    if file.suffix not in SUFFIXES:
        raise SuiteError(f"{file}: found suffix {file.suffix!r}, allowed {', '.join(SUFFIXES)}")
    entries = read_entries(file)
    entry = entries[0] if len(entries) == 1 else entries
    if isinstance(entry, dict) and "experiment" in entry:  # a manifest
        entry = entry["experiment"]
    if not isinstance(entry, dict):
        raise SuiteError(f"{file}: found no experiment in it, allowed a mapping with planners and conditions")
    try:
        return ExperimentFile.model_validate(entry).fields()
    except ValidationError as error:
        raise SuiteError(f"{file}: {_line(error)}") from None
    except ValueError as error:
        raise SuiteError(f"{file}: {error}") from None


def preset_fields(preset: str) -> dict[str, Any]:
    """Fields of a named experiment, or of the one in a file, such as the ``manifest.json`` of a run.

    Raises:
        ScenarioError, SuiteError, SpecError: There is no such name, or as ``read_experiment_file``.
    """
    return read_experiment_file(preset) if preset.endswith(SUFFIXES) else preset_of(preset)


def check_experiment_file(name: str | Path) -> Experiment:
    """The experiment in a file, every field of it looked at.

    Raises:
        ScenarioError, SuiteError, SpecError: As ``read_experiment_file``.
    """
    fields = read_experiment_file(name)
    try:
        return make_experiment(**fields)
    except ValueError as error:
        raise SuiteError(f"{name}: {error}") from None


def nearest(name: str, known: Iterable[str]) -> str:
    """``; nearest: KNOWN`` where a known name is like the one found."""
    found = difflib.get_close_matches(name[:100], list(known), 1)
    return f"; nearest: {found[0]}" if found else ""


def _line(error: ValidationError) -> str:
    finding = error.errors(include_url=False)[0]
    field = str(finding["loc"][0]) if finding["loc"] else "experiment"
    if finding["type"] == "extra_forbidden":
        known = list(ExperimentFile.model_fields)
        return f"found {field[:60]!r}, allowed {', '.join(known)}{nearest(field, known)}"
    return f"{field}: found {repr(finding['input'])[:60]}, allowed: {finding['msg']}"


def _sweep(fields: dict[str, Any], key: str, values: Values) -> None:
    """Put several values of one condition into the experiment's fields."""
    if key in SWEPT:
        fields[key] = values
        return
    owner, _, setting = key.rpartition(".")
    if owner == "family":
        fields["family"] = _with(specs_of(fields.get("family", "orbit")), setting, values)
    elif owner == "arm":
        arms = [f"arm[{text}]" for text in arms_of(fields.get("arm", ""))]
        fields["arm"] = [text.partition("[")[2].removesuffix("]") for text in _with(arms, setting, values)]
    else:
        planners = list(specs_of(fields.get("planners", ())))
        names = list(dict.fromkeys(parse_spec(text)[0] for text in planners))
        if owner not in names:
            known = [*SWEPT, "family.SETTING", "arm.SETTING", *(f"{name}.SETTING" for name in names)]
            raise SuiteError(f"sweep: found {key!r}, allowed {', '.join(known)}{nearest(key, known)}")
        fields["planners"] = [
            text
            for each in planners
            for text in (_with([each], setting, values) if parse_spec(each)[0] == owner else [each])
        ]


def _with(specs: Iterable[str], setting: str, values: Values) -> list[str]:
    return [with_setting(spec, setting, values) for spec in specs]
