"""What there is to choose from: planners with their settings, and predictors."""

from __future__ import annotations

import json
import textwrap
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from pydantic.fields import FieldInfo
from pydantic_core import PydanticUndefined

from planners import ALIASES, PLANNERS, PREDICTORS, ArmPlanner, ompl_planners, ompl_refused, plugins
from planners.isolation import Facts, facts_of
from scenarios import SpecError

WIDTH = 80


def planners_text() -> str:
    """Every planner with its settings (type, default, meaning), then every predictor."""
    return "\n".join(_folded(line) for line in _lines()) + "\n"


def planners_json() -> str:
    """The same as an object: ``planners``, ``aliases``, ``ompl``, ``offered``, ``predictors``."""
    listed = {
        "planners": {name: _as_values(planner) for name, planner in PLANNERS.items()},
        "aliases": {alias: {"planner": name, "settings": values} for alias, (name, values) in ALIASES.items()},
        "ompl": {name: _as_values(planner) for name, planner in ompl_planners().items()},
        "offered": list(plugins.offered()),
        "predictors": {name: predictor.summary for name, predictor in PREDICTORS.items()},
    }
    return json.dumps(listed, indent=1) + "\n"


def _as_values(planner: type[ArmPlanner]) -> dict[str, Any]:
    settings = {
        key: {
            "type": _kind(field),
            "default": None if field.default is PydanticUndefined else field.default,
            "meaning": field.description or "",
        }
        for key, field in planner.settings_model.model_fields.items()
    }
    return {
        "summary": planner.summary,
        "source": planner.source,
        "is_bound": planner.is_bound,
        "budget": list(planner.budget),
        "settings": settings,
    }


def _kind(field: FieldInfo) -> str:
    return getattr(field.annotation, "__name__", str(field.annotation))


def _folded(line: str) -> str:
    """A line in 80 columns, the rest of it further in."""
    if len(line) <= WIDTH:
        return line
    inset = " " * (4 + len(line) - len(line.lstrip()))
    return "\n".join(
        textwrap.wrap(line, WIDTH, subsequent_indent=inset, break_on_hyphens=False, break_long_words=False)
    )


def _lines() -> Iterator[str]:
    yield "Planners, as name or name[setting=value,...]:"
    for name, entry in PLANNERS.items():
        yield f"\n  {name}: {entry.summary}" + (" (sees the true future: a bound)" if entry.is_bound else "")
        yield from _settings(entry.settings_model.model_fields)
    for alias, (name, values) in ALIASES.items():
        yield f"\n  {alias}: {name}[{','.join(f'{key}={value}' for key, value in values.items())}]"
    yield from _ompl_lines()
    yield from _plugin_lines()
    yield "\nPredictors:\n"
    for name, predictor in PREDICTORS.items():
        yield f"  {name}: {predictor.summary}"


def _settings(fields: dict[str, FieldInfo]) -> Iterator[str]:
    """A line each: type, default, meaning."""
    for key, field in fields.items():
        default = "" if field.default is PydanticUndefined else f" = {field.default}"
        yield f"      {key}: {_kind(field)}{default}  {field.description or ''}".rstrip()


def _ompl_lines() -> Iterator[str]:
    """OMPL's own: what all share at length, then for each its settings in short and where it differs."""
    fields = {name: planner.settings_model.model_fields for name, planner in ompl_planners().items()}
    taken = Counter(key for each in fields.values() for key in each)
    first = next(iter(fields.values()))
    shared = {key: field for key, field in first.items() if taken[key] == len(fields)}
    yield "\nOMPL's own, as ompl.NAME or ompl.NAME[setting=value,...]; all have these settings:"
    yield from _settings(shared)
    yield "  and each what OMPL lets one set (see docs/ompl-planners.md):"
    for name, planner in ompl_planners().items():
        own = " ".join(
            f"{key}={str(field.default).lower()}"
            for key, field in fields[name].items()
            if key not in shared or field.default != shared[key].default
        )
        yield f"  {name}: {planner.source}"
        yield from textwrap.wrap(own, 80, initial_indent=" " * 6, subsequent_indent=" " * 6, break_on_hyphens=False)
    yield "  not here:"
    for name, reason in ompl_refused().items():
        yield f"  {name}: {reason}"


def _plugin_lines() -> Iterator[str]:
    """What installed distributions offer; each is looked at in a process of its own, so one that fails is a line."""
    names = list(plugins.offered())
    if not names:
        return
    yield f"\nOffered by installed distributions (entry points of {plugins.GROUP}):"
    with ThreadPoolExecutor(8) as pool:
        for name, facts in zip(names, pool.map(_look_at, names), strict=True):
            problem = facts.mistake or (facts.failure.message if facts.failure else "")
            yield f"  {name}: unavailable: {problem}" if problem else f"  {name}: {facts.summary}".rstrip(": ")
            for key, value in facts.settings.items():
                yield f"      {key} = {value}"


def _look_at(name: str) -> Facts:
    if name in (*PLANNERS, *ALIASES):
        return Facts(mistake="the house has a planner of this name")
    try:
        return facts_of(name, plugins.code_hash(name))
    except SpecError as mistake:
        return Facts(mistake=str(mistake))
