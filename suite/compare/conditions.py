"""Conditions as values: one by one, although families, arms and planners keep theirs together in a text.

``n_obstacles``, ``noise_mm`` and their like are columns of a trial; ``max_speed_m_s`` stands among the parameters
of the family, ``radius_m`` among those of the arm, ``horizon`` among a planner's settings, ``budget`` in its spec.
"""

from __future__ import annotations

import functools
import json
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import pandas as pd

from scenarios import ContinuumArm, SpecError
from scenarios.families import FAMILIES
from scenarios.spec import known_name, parse_spec
from suite.experiment.values import spec_text
from suite.trial.columns import CONDITIONS, OWN, WORLD

PLAIN = ("family", "n_obstacles", *(column.name for column in CONDITIONS))
"""Conditions that are columns."""
BUDGET = "budget"
TEXTS = ("family_parameters", "arm")
"""Columns whose text holds several conditions of the world."""


def telling_apart(trials: pd.DataFrame) -> list[str]:
    """Conditions that tell trials of one planner on one scenario apart; empty when there is one trial of each."""
    trial = ["scenario_id", "planner"]
    again = trials[trials.duplicated(trial, keep=False)]
    names = [column.name for column in CONDITIONS if column.name != "settings"]
    counts = again.groupby(trial)[names].nunique(dropna=False)
    return [name for name in names if not again.empty and counts[name].max() > 1]


def known_conditions(trials: pd.DataFrame) -> list[str]:
    """Names of all conditions that trials have: columns, and what stands in texts."""
    inside = [key for values in _inner_values(trials).values() for each in values for key in each]
    return list(dict.fromkeys([*PLAIN, *inside, BUDGET]))


def values_of(trials: pd.DataFrame, name: str) -> pd.Series[Any]:
    """The value of a condition in every trial; missing where it does not apply, as a planner's setting to others.

    Raises:
        SpecError: No trial has a condition of that name.
    """
    known_name("condition", name, known_conditions(trials))
    if name in PLAIN:
        return trials[name]
    if name == BUDGET:
        return _budgets(trials["planner"])
    inside = next(each for each in _inner_values(trials).values() if any(name in values for values in each))
    return pd.Series([values.get(name) for values in inside], trials.index, dtype=object).infer_objects()


def varying_world(trials: pd.DataFrame) -> list[str]:
    """Conditions of the world in which trials differ, those in texts one by one."""
    inside = _inner_values(trials)
    inner = list(dict.fromkeys(key for text in TEXTS for each in inside[text] for key in each))
    names = ["family", "n_obstacles", *(column.name for column in WORLD if column.name not in TEXTS), *inner]
    return [name for name in names if len(values_of(trials, name).unique()) > 1]


class Pooled(NamedTuple):
    """Trials in which some conditions are no longer told apart."""

    trials: pd.DataFrame
    over: Mapping[str, Sequence[Any]]
    """What was pooled, with the values that were there."""

    def __str__(self) -> str:
        """In words; empty when nothing was pooled."""
        parts = [f"{name} ({', '.join(map(str, values))})" for name, values in self.over.items()]
        return f"Pooled, as asked, over {', '.join(parts)}." if parts else ""


def pool(trials: pd.DataFrame, by: Sequence[str]) -> Pooled:
    """Forget all conditions but ``by``, so that trials under unlike others are summed up together.

    Raises:
        SpecError: No trial has a condition of that name.
    """
    for name in by:
        known_name("by", name, known_conditions(trials))
    kept, over = trials.copy(), dict[str, list[Any]]()
    for name in varying_world(trials):
        if name not in by:
            over[name] = sorted(values_of(trials, name).dropna().unique().tolist(), key=str)
            if name in PLAIN:
                kept[name] = pd.Series([None] * len(kept), kept.index, kept[name].dtype)
    for text in TEXTS:
        if text not in by and len(trials[text].unique()) > 1:
            cut = [_only(values, by) for values in _inner_values(trials)[text]]
            kept[text] = pd.Series(cut, kept.index, "string")
    for column in OWN:
        name = column.name
        several = trials.groupby("planner")[name].transform(lambda each: each.nunique(dropna=False)) > 1
        if name not in by and several.any():
            if name != "settings":
                over[name] = sorted(trials.loc[several, name].dropna().unique().tolist(), key=str)
            kept[name] = kept[name].mask(several)
    return Pooled(kept, over)


def line_of(planner: str, name: str) -> str:
    """A planner's label without the setting ``name``: the points of a curve over it are one planner."""
    try:
        kind, settings = parse_spec(planner)
    except SpecError:  # a plugin's label may look otherwise
        return planner
    return spec_text(kind, {key: value for key, value in settings.items() if key != name})


def _only(values: Mapping[str, Any], by: Sequence[str]) -> str | None:
    """What is told apart of a text's values, in its notation; None when nothing is."""
    kept = {key: value for key, value in values.items() if key in by}
    return spec_text("values", kept).partition("[")[2].removesuffix("]") or None


def _inner_values(trials: pd.DataFrame) -> dict[str, list[dict[str, Any]]]:
    """For every trial what its texts hold, by the column of the text."""
    families = zip(trials["family"].tolist(), trials["family_parameters"].tolist(), strict=True)
    return {
        "family_parameters": [_family_values(family, text) for family, text in families],
        "arm": [_arm_values(text) for text in trials["arm"].tolist()],
        "settings": [_settings_values(text) for text in trials["settings"].tolist()],
    }


def _cached(function: Callable[..., dict[str, Any]]) -> Callable[..., dict[str, Any]]:
    return functools.lru_cache(maxsize=4096)(function)


@_cached
def _family_values(family: str, text: Any) -> dict[str, Any]:
    if pd.isna(text):
        return {}
    defaults = {}
    if family in FAMILIES:
        defaults = {key: field.default for key, field in FAMILIES[family].model_fields.items()}
    return {**defaults, **_parsed(text)}


@_cached
def _arm_values(text: Any) -> dict[str, Any]:
    return {} if pd.isna(text) else ContinuumArm().model_dump() | _parsed(text)


@_cached
def _settings_values(text: Any) -> dict[str, Any]:
    try:
        found = json.loads(text)
    except (TypeError, ValueError):
        return {}
    return {key: value for key, value in found.items() if not isinstance(value, list | dict)}


def _parsed(text: str) -> dict[str, Any]:
    """Values of ``max_speed_m_s=0.03,redraw=False``; nothing of ``default``, or of what a stranger has written."""
    if text == "default":
        return {}
    try:
        settings = parse_spec(f"settings[{text}]")[1]
    except SpecError:
        return {}
    return {key: _number(value) for key, value in settings.items()}


def _number(text: str) -> Any:
    try:
        value = float(text)
    except ValueError:
        return {"True": True, "False": False}.get(text, text)
    return int(value) if value.is_integer() and "." not in text and "e" not in text else value


def _budgets(planners: pd.Series[str]) -> pd.Series[Any]:
    """A planner without one in its spec has its whole budget, if the same planner stands there with another one."""
    given = {label: _budget(label) for label in planners.unique()}
    scaled = {line_of(label, BUDGET) for label, budget in given.items() if budget is not None}
    whole = {label: 1.0 if label in scaled and budget is None else budget for label, budget in given.items()}
    return planners.map(whole).astype("float64")


def _budget(label: str) -> float | None:
    try:
        return float(parse_spec(label)[1][BUDGET])
    except (SpecError, KeyError, ValueError):
        return None
