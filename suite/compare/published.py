"""Results published elsewhere, to stand beside ours."""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from planners import parse_planner
from scenarios import SpecError
from suite.errors import SuiteError
from suite.store.frames import read_columns

COLUMNS = {
    "planner": "string",
    "n_obstacles": "int64",
    "time_s": "float64",
    "success_percent": "float64",
    "trials": "int64",
}
"""Columns of a file of published results, and their types."""

RANGES = {
    "n_obstacles": (0, 1000),
    "time_s": (0, float("inf")),
    "success_percent": (0, 100),
    "trials": (1, 1_000_000_000),
}


def published_file(name: str) -> Path:
    """The file behind ``--against``: ``published`` is the paper's Table I, anything else a path."""
    return Path(__file__).with_name("published_table1.csv") if name == "published" else Path(name)


def read_published(file: Path) -> pd.DataFrame:
    """Read a file of published results, one row per planner and number of obstacles.

    Raises:
        FileError: The file cannot be read, or a value is not of its column's type.
        SuiteError: It lacks a column, a value is missing or out of range, or two rows are for one planner, whatever
            they call it, and number of obstacles.
    """
    published = read_columns(file, COLUMNS)
    missing = [name for name in COLUMNS if name not in published.columns]
    if missing:
        raise SuiteError(f"{file}: found no column {missing[0]}, allowed: {', '.join(COLUMNS)}")
    if published["planner"].isna().any():
        raise SuiteError(f"{file}: planner: found nothing, allowed: a name in every row")
    for name, (low, high) in RANGES.items():
        wrong = published[name][(published[name] < low) | (published[name] > high)]
        if len(wrong):
            raise SuiteError(f"{file}: {name}: found {wrong.iloc[0]:g}, allowed: {low:g} to {high:g}")
    same = published.assign(planner=published["planner"].map(_identity)).duplicated(["planner", "n_obstacles"])
    if same.any():
        name, n = published.loc[same, ["planner", "n_obstacles"]].iloc[0]
        raise SuiteError(f"{file}: found two rows for {name} and n_obstacles {n}, allowed: one")
    return published[list(COLUMNS)]


def beside(summary: pd.DataFrame, published: pd.DataFrame) -> pd.DataFrame:
    """Put published success and time beside ours, where number of obstacles and planner agree.

    Planners agree when they have the same settings, whatever they are called: ``temporal`` is ``t3``.
    """
    names = {name: f"published_{name}" for name in COLUMNS if name not in ("planner", "n_obstacles")}
    theirs = published.assign(same=published["planner"].map(_identity)).drop(columns="planner").rename(columns=names)
    ours = summary.assign(same=summary["planner"].map(_identity))
    return ours.merge(theirs, how="left", on=["same", "n_obstacles"]).drop(columns="same")


def _identity(label: str) -> str:
    """Equal for labels of equal planners; a planner that is not ours goes by its name."""
    try:
        spec = parse_planner(label.lower())
    except SpecError:
        return label.lower()
    return f"{spec.name}{spec.settings.model_dump_json()}"
