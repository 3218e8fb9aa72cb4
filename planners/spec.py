"""The notation in which users name planners: ``name[key=value,...]``, and what is known of a planner so named.

``name`` is one of the house's, a planner of OMPL's (``ompl.KPIECE1``), a file's (``path/to/file.py:Class``), a module's
(``package.module:Class``) or one that an installed distribution offers. The key ``name`` is the same for all: what
the planner is to be called in tables. So is ``budget``, for those that have one: a factor on what they may spend.
"""

from __future__ import annotations

import re
from typing import NamedTuple

from pydantic import BaseModel

from planners import plugins
from planners.base import ArmPlanner
from planners.failure import Failure
from planners.registry import ALIASES, PLANNERS
from planners.sampling import by_name
from scenarios.spec import SpecError, known_name, parse_settings, parse_spec
from scenarios.spec import split_specs as split_texts

BUDGET = "budget"
"""Key of every planner that declares one, beside its settings."""
MAX_BUDGET = 1000.0
_LABEL = re.compile(r"[A-Za-z0-9_.+-]{1,40}")


class PlannerSpec(NamedTuple):
    """A planner with its settings; plain data, which goes to other processes without the planner's code."""

    label: str
    """What tables call it: as typed, without blanks and folders, or the name that it was given."""
    name: str
    """What ``load`` finds its class by: a house name, ``ompl.NAME``, a reference with its full path, an entry point."""
    settings: BaseModel
    """Its settings; of a planner from outside the values alone, which its own model has checked."""
    predictor: str = "cubic"
    """The predictor it works with unless a run asks for another."""
    prediction_margin: float = 0.0
    """Standard deviations by which its predicted obstacles are grown."""
    is_bound: bool = False
    """Whether it sees the true future."""
    code: str = ""
    """Hash of the planner's own sources; empty for the house's and OMPL's."""
    failure: Failure | None = None
    """Why it can't be loaded."""

    def __str__(self) -> str:
        """The label; of a house planner without a given name ``parse_planner`` makes the same spec from it."""
        return self.label

    def predictor_for(self, asked: str | None) -> str:
        """Name of the predictor it works with when a run asks for ``asked``, or for each planner's own (None)."""
        return "truth" if self.is_bound else asked or self.predictor

    def margin_for(self, asked: float | None) -> float:
        """Margin by which its predicted obstacles are grown when a run asks for ``asked``, or for its own (None)."""
        return self.prediction_margin if self.is_bound or asked is None else asked


class Typed(NamedTuple):
    """A spec taken apart; nothing is loaded."""

    label: str
    name: str
    values: dict[str, str]


def read_spec(text: str) -> Typed:
    """Take a planner's spec apart, aliases resolved.

    Raises:
        SpecError: It is of no known form, names an unknown planner, or sets what an alias fixes.
    """
    typed, values = parse_spec(text)
    given = values.pop("name", None)
    if given is not None and not _LABEL.fullmatch(given):
        raise SpecError(f"{typed}[name]: found {given!r}, allowed at most 40 letters, digits and _.+-")
    if plugins.is_reference(typed):
        short, name, preset = typed.rpartition(":")[2], plugins.resolved(typed), dict[str, str]()
    elif by_name.is_guest(typed):
        short, name, preset = typed, by_name.known_guest(typed), {}
    else:
        known_name("planner", typed, [*PLANNERS, *ALIASES, *plugins.offered(), "ompl.NAME"])
        name, preset = ALIASES.get(typed, (typed, {}))
        short = typed
    fixed = [key for key in values if key in preset]
    if fixed:
        raise SpecError(f"{typed}: found setting {fixed[0]!r}, allowed on {name}[{fixed[0]}=...] only")
    inside = ",".join(f"{key}={value}" for key, value in values.items())
    label = given or "".join((f"{short}[{inside}]" if inside else short).split())
    return Typed(label, name, {**preset, **values})


def is_outside(name: str) -> bool:
    """Whether a planner's code is not the suite's or OMPL's."""
    return plugins.is_reference(name) or not (name in PLANNERS or by_name.is_guest(name))


def planner_class(name: str) -> type[ArmPlanner]:
    """The class of a planner, by a spec's ``name``; a planner from outside is imported, and may raise anything."""
    if is_outside(name):
        return plugins.load_class(name)
    return PLANNERS[name] if name in PLANNERS else by_name.guest_planner(name)


def parse_planner(text: str) -> PlannerSpec:
    """Read ``temporal[horizon=3]``, ``t2``, ``mine.py:Mine[gain=2]``; a planner from outside is imported here.

    Raises:
        SpecError: Unknown planner or setting, or a value out of range; the message lists what is allowed.
    """
    label, name, values = read_spec(text)
    planner = planner_class(name)
    budget = values.pop(BUDGET, None) if planner.budget and BUDGET not in planner.settings_model.model_fields else None
    settings = parse_settings(label.partition("[")[0], planner.settings_model, values)
    if budget is not None:
        settings = _scaled(label.partition("[")[0], planner, settings, budget)
    code = plugins.code_hash(name) if is_outside(name) else ""
    return PlannerSpec(label, name, settings, planner.predictor, planner.prediction_margin, planner.is_bound, code)


def _scaled(name: str, planner: type[ArmPlanner], settings: BaseModel, budget: str) -> BaseModel:
    """The settings with a planner's own budget multiplied by ``budget``; counts are rounded, and never below 1."""
    try:
        factor = float(budget)
    except ValueError:
        factor = 0.0
    if not 0.0 < factor <= MAX_BUDGET:
        raise SpecError(f"{name}[{BUDGET}]: found {budget!r}, allowed a number above 0 and up to {MAX_BUDGET:g}")
    values = settings.model_dump()
    for key in planner.budget:
        value = factor * values[key]
        values[key] = max(1, round(value)) if isinstance(values[key], int) else value
    return parse_settings(f"{name}[{BUDGET}={budget}]", planner.settings_model, values)


def label_of(text: str) -> str:
    """What tables call the planner of a spec; checked as far as it can be without importing it.

    Raises:
        SpecError: As ``parse_planner``.
    """
    typed = read_spec(text)
    return typed.label if is_outside(typed.name) else parse_planner(text).label


def load(spec: PlannerSpec) -> tuple[type[ArmPlanner], BaseModel]:
    """The class of a spec and its settings as the class declares them."""
    planner = planner_class(spec.name)
    if isinstance(spec.settings, planner.settings_model):
        return planner, spec.settings
    return planner, planner.settings_model.model_validate_json(spec.settings.model_dump_json())


def split_specs(text: str) -> list[PlannerSpec]:
    """Read a comma-separated list of planners.

    Raises:
        SpecError: As ``parse_planner``, or the same planner stands twice.
    """
    specs = [parse_planner(part) for part in split_texts(text)]
    labels = [spec.label for spec in specs]
    if len(set(labels)) < len(labels):
        twice = next(label for label in labels if labels.count(label) > 1)
        raise SpecError(f"planners: found {twice!r} twice, allowed once")
    return specs
