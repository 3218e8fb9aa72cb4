"""Conditions in words: what all rows of a table have in common stands above it, the rest in columns of it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import pandas as pd

from suite.trial.columns import OWN, WORLD


class _Words(NamedTuple):
    """How a condition is written."""

    title: str
    """Above a column of the table."""
    phrase: str
    """In a sentence, around the value."""


_WORDS = {
    "family_parameters": _Words("parameters", "family parameters {}"),
    "arm": _Words("arm", "arm {}"),
    "limits": _Words("limits", "motion limits {}"),
    "noise_mm": _Words("noise mm", "observation noise {} mm"),
    "dropout": _Words("dropout", "dropout {}"),
    "experiment_seed": _Words("seed", "seed {}"),
    "settings": _Words("settings", ""),
    "predictor": _Words("predictor", "predictor {}"),
    "prediction_margin": _Words("margin", "prediction margin {}"),
}


def sentence(table: pd.DataFrame) -> str:
    """What is the same for all rows, or for all of each planner; what is not known is left out."""
    parts, varied = [], varying(table)
    for name in ("predictor", "prediction_margin", *(column.name for column in WORLD)):
        known = table.dropna(subset=[name])
        if not known.empty and name not in varied:
            parts.append(_WORDS[name].phrase.format(_values(known, name)))
    text = "; ".join(parts)
    return text[:1].upper() + text[1:] + "." if text else ""


def varying(table: pd.DataFrame) -> list[str]:
    """Conditions in which rows differ; a planner's own ones only where they differ for one planner."""
    world = [column.name for column in WORLD if len(table[column.name].unique()) > 1]
    planners = [rows for _, rows in table.groupby("planner")]
    return world + [column.name for column in OWN if any(len(rows[column.name].unique()) > 1 for rows in planners)]


def column(table: pd.DataFrame, name: str) -> tuple[str, Callable[[Any], str]]:
    """Title of a condition's column, and what makes the text of its cell from a row."""
    if name == "settings":
        told = _told_apart(table[name])
        return _WORDS[name].title, lambda row: told[str(getattr(row, name))]
    return _WORDS[name].title, lambda row: _text(getattr(row, name))


def _values(known: pd.DataFrame, name: str) -> str:
    """The one value, or each with the planners that have it."""
    if len(known[name].unique()) == 1:
        return _text(known[name].iloc[0])
    groups = known.groupby(name, sort=False)["planner"].unique()
    return ", ".join(f"{_text(value)} ({', '.join(planners)})" for value, planners in groups.items())


def _told_apart(texts: pd.Series[str]) -> dict[str, str]:
    """Long texts of settings, cut down to the settings in which they differ."""
    parts = {str(text): str(text).strip("{}").replace('"', "").replace(":", "=").split(",") for text in texts}
    common = set.intersection(*map(set, parts.values()))
    return {text: ",".join(part for part in each if part not in common) or "-" for text, each in parts.items()}


def _text(value: Any) -> str:
    if pd.isna(value):
        return "-"
    if isinstance(value, str):
        return value
    if str(value) in {"True", "False"}:
        return "on" if value else "off"
    return f"{value:g}" if isinstance(value, float) else str(value)
