"""What there is to choose from: planners with their settings, and predictors."""

from __future__ import annotations

from collections.abc import Iterator

from pydantic_core import PydanticUndefined

from planners import PLANNERS, PREDICTORS


def planners_text() -> str:
    """Every planner with its settings (type, default, meaning), then every predictor."""
    return "\n".join(_lines()) + "\n"


def _lines() -> Iterator[str]:
    yield "Planners, as name or name[setting=value,...]:"
    for name, entry in PLANNERS.items():
        yield f"\n  {name}: {entry.summary}" + (" (sees the true future: a bound)" if entry.is_bound else "")
        for key, field in entry.settings_model.model_fields.items():
            kind = getattr(field.annotation, "__name__", str(field.annotation))
            default = "" if field.default is PydanticUndefined else f" = {field.default}"
            yield f"      {key}: {kind}{default}  {field.description or ''}".rstrip()
    yield "\nPredictors:\n"
    for name, predictor in PREDICTORS.items():
        yield f"  {name}: {predictor.summary}"
