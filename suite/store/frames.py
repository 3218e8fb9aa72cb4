"""Trial rows as a pandas frame and as ``trials.csv``; tables as they were written."""

from __future__ import annotations

import csv
import io
import sys
import warnings
from collections.abc import Iterable, Mapping
from pathlib import Path

import pandas as pd

from planners import is_bound
from scenarios import FileError
from scenarios.reading import first_twice, read_text, unreadable
from suite.auditor.verdicts import VERDICTS
from suite.errors import SuiteError
from suite.store.schema import old_margin
from suite.trial.columns import COLUMN_NAMES, COLUMNS, CONDITIONS, Column, Row

MAX_CSV_BYTES = 1024**3

SORTED_BY = ["family", "n_obstacles", "scenario_id", "planner", *(column.name for column in CONDITIONS)]
"""The order of rows in files, which does not depend on the order in which trials finished."""

_NEW_IN_TABLES = {column.name: column.dtype for column in CONDITIONS} | {"stale": "int64"}

TABLE_TYPES: dict[str, str] = {
    "family": "string",
    "n_obstacles": "int64",
    "planner": "string",
    **_NEW_IN_TABLES,
    "is_bound": "bool",
    "trials": "int64",
    **{f"success_{verdict}_{part}": "float64" for verdict in VERDICTS for part in ("percent", "low", "high")},
    **{f"success_{verdict}_of_bound_percent": "float64" for verdict in VERDICTS},
    "planning_time_mean_s": "float64",
    "planning_time_median_s": "float64",
    "solve_median_s": "float64",
    "reached": "int64",
    "arrival_median_s": "float64",
    "tip_path_length_median_m": "float64",
    "smoothness_paper_median_rad": "float64",
    "errors": "int64",
}
"""Columns of ``table.csv`` and their types."""

FLOAT_FORMAT = "%.9g"
"""How every number is written, so that equal rows give equal bytes."""


def trials_frame(rows: Iterable[Row]) -> pd.DataFrame:
    """The rows as a sorted frame with the declared columns and types.

    Numbers are rounded as they are written: what is computed from the frame can be computed from ``trials.csv``.
    """
    # Column by column: a list of rows as dictionaries would take several times the frame's memory.
    values: dict[str, list[object]] = {name: [] for name in COLUMN_NAMES}
    for row in rows:
        for name, value in row.items():
            values[name].append(_as_written(value))
    frame = pd.DataFrame({column.name: pd.Series(values.pop(column.name), dtype=column.dtype) for column in COLUMNS})
    return frame.sort_values(SORTED_BY, ignore_index=True)


def _as_written(value: object) -> object:
    if isinstance(value, float):
        return float(FLOAT_FORMAT % value)
    return sys.intern(value) if isinstance(value, str) else value  # names and settings repeat in thousands of rows


def trials_csv(trials: pd.DataFrame) -> str:
    """The text of ``trials.csv``."""
    return trials.to_csv(index=False, float_format=FLOAT_FORMAT, lineterminator="\n")


def read_trials_csv(file: Path) -> pd.DataFrame:
    """Read what ``trials_csv`` wrote, now or before rows said as much as they do.

    Raises:
        FileError: The file cannot be read, or a column holds something else than it should.
        SuiteError: A column is missing.
    """
    frame = read_columns(file, {column.name: column.dtype for column in COLUMNS})
    is_old = not any(column.since > 1 and column.name in frame for column in COLUMNS)
    missing = [column.name for column in COLUMNS if column.name not in frame and not (is_old and column.since > 1)]
    if missing:
        raise SuiteError(f"{file}: found no column {missing[0]}, a table of trials has one")
    if is_old:
        frame = _with_unknown(frame, [column for column in COLUMNS if column.since > 1])
        planner = frame["planner"].fillna("")
        frame = frame.assign(
            prediction_margin=planner.map(old_margin).astype("float64"),
            is_bound=planner.map(is_bound).astype("boolean"),
        )
    return frame[list(COLUMN_NAMES)]


def read_table_csv(file: Path) -> pd.DataFrame:
    """Read a summary as it was written, now or before tables said under which conditions.

    Raises:
        FileError: The file cannot be read.
        SuiteError: It is no summary.
    """
    frame = read_columns(file, TABLE_TYPES)
    missing = [name for name in TABLE_TYPES if name not in frame and name not in _NEW_IN_TABLES]
    if missing:
        raise SuiteError(f"{file}: found no column {missing[0]}, a table has one")
    return _with_unknown(frame if "stale" in frame else frame.assign(stale=0), CONDITIONS)


def _with_unknown(frame: pd.DataFrame, columns: Iterable[Column]) -> pd.DataFrame:
    """Add, empty, those of the columns that are not there."""
    empty = [None] * len(frame)
    return frame.assign(**{c.name: pd.Series(empty, frame.index, c.dtype) for c in columns if c.name not in frame})


def read_columns(file: Path, types: Mapping[str, str]) -> pd.DataFrame:
    """Read a CSV; its columns that ``types`` names have these types, an empty cell is a missing value.

    Raises:
        FileError: The file cannot be read, is larger than ``MAX_CSV_BYTES``, has a column twice or a line that does
            not fit the header, or a value is not of its column's type.
    """
    text = read_text(file, MAX_CSV_BYTES)
    try:
        twice = first_twice(next(csv.reader(io.StringIO(text)), []))
        if twice is not None:
            raise FileError(f"{file}: found the column {twice!r} twice, allowed once")
        with warnings.catch_warnings():
            warnings.simplefilter("error", pd.errors.ParserWarning)  # lines that are too long would be cut
            return pd.read_csv(
                io.StringIO(text), dtype=dict(types), keep_default_na=False, na_values=[""], index_col=False
            )
    except FileError:
        raise
    except (csv.Error, ValueError, TypeError, OverflowError, pd.errors.ParserWarning) as error:
        raise unreadable(file, error) from None


def refuse_gaps(trials: pd.DataFrame, file: Path) -> pd.DataFrame:
    """Return ``trials`` if every one says which it is; a file may have been written by anyone.

    Raises:
        SuiteError: Scenario, planner or outcome is missing somewhere.
    """
    for name in ("scenario_id", "scenario_hash", "family", "n_obstacles", "planner", "outcome"):
        if trials[name].isna().any():
            raise SuiteError(f"{file}: found a trial without {name}, allowed: every trial has one")
    return trials
