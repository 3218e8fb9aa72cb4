"""What there is to choose from: planners with their settings, and predictors."""

from __future__ import annotations

import textwrap
from collections import Counter
from collections.abc import Iterator

from pydantic.fields import FieldInfo
from pydantic_core import PydanticUndefined

from planners import PLANNERS, PREDICTORS, ompl_planners, ompl_refused


def planners_text() -> str:
    """Every planner with its settings (type, default, meaning), then every predictor."""
    return "\n".join(_lines()) + "\n"


def _lines() -> Iterator[str]:
    yield "Planners, as name or name[setting=value,...]:"
    for name, entry in PLANNERS.items():
        yield f"\n  {name}: {entry.summary}" + (" (sees the true future: a bound)" if entry.is_bound else "")
        yield from _settings(entry.settings_model.model_fields)
    yield from _ompl_lines()
    yield "\nPredictors:\n"
    for name, predictor in PREDICTORS.items():
        yield f"  {name}: {predictor.summary}"


def _settings(fields: dict[str, FieldInfo]) -> Iterator[str]:
    """A line each: type, default, meaning."""
    for key, field in fields.items():
        kind = getattr(field.annotation, "__name__", str(field.annotation))
        default = "" if field.default is PydanticUndefined else f" = {field.default}"
        yield f"      {key}: {kind}{default}  {field.description or ''}".rstrip()


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
