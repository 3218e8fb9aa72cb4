"""Trial rows as a pandas frame and as ``trials.csv``; tables as they were written."""

from __future__ import annotations

import csv
import io
import sys
import warnings
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from planners import is_bound
from scenarios import FileError
from scenarios.reading import first_twice, read_text, unreadable
from suite.auditor.verdicts import VERDICTS
from suite.errors import SuiteError
from suite.store.schema import old_margin
from suite.trial.columns import COLUMN_NAMES, COLUMNS, CONDITIONS, SORTED_BY, Row

MAX_CSV_BYTES = 1024**3

_POSSIBLE = {f"scenarios_{answer}": "Int64" for answer in ("possible", "open", "impossible")}
_NEW_IN_TABLES = {column.name: column.dtype for column in CONDITIONS} | {"stale": "int64"} | _POSSIBLE

TABLE_TYPES: dict[str, str] = {
    "family": "string",
    "n_obstacles": "Int64",
    "planner": "string",
    **{column.name: column.dtype for column in CONDITIONS},
    "stale": "int64",
    "is_bound": "bool",
    "trials": "int64",
    **{f"success_{verdict}_{part}": "float64" for verdict in VERDICTS for part in ("percent", "low", "high")},
    **{f"success_{verdict}_of_bound_percent": "float64" for verdict in VERDICTS},
    **_POSSIBLE,
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

_DTYPES = {column.name: column.dtype for column in COLUMNS}
_REPEATING = {name for name, dtype in _DTYPES.items() if dtype == "string"} - {"scenario_id", "scenario_hash"}

FLOAT_FORMAT = "%.9g"
"""How every number is written, so that equal rows give equal bytes."""


def trials_frame(rows: Iterable[Row]) -> pd.DataFrame:
    """The rows as a sorted frame with the declared columns and types.

    Numbers are rounded as they are written: what is computed from the frame can be computed from ``trials.csv``.
    """
    values: dict[str, list[Any]] = {name: [] for name in COLUMN_NAMES}
    for row in rows:
        for name, value in row.items():
            values[name].append(value)
    return columns_frame(values).sort_values(list(SORTED_BY), ignore_index=True)


def columns_frame(columns: Mapping[str, Sequence[Any]]) -> pd.DataFrame:
    """The same of rows that come as columns, in the order in which they come."""
    return pd.DataFrame(
        {name: pd.Series(_as_written(_DTYPES[name], columns[name]), dtype=_DTYPES[name]) for name in columns}
    )


def joined(frames: Iterable[pd.DataFrame], names: Sequence[str]) -> pd.DataFrame:
    """Frames with the columns ``names``, one below the other; there may be none."""
    return pd.concat([columns_frame(dict.fromkeys(names, ())), *frames], ignore_index=True)


def compact(parts: Iterable[Mapping[str, Sequence[Any]]], names: Sequence[str]) -> pd.DataFrame:
    """What ``joined`` makes of rows that come as columns, part by part; texts that repeat are categories.

    Whatever is computed from the rows copies them: of a hundred thousand they must be small.
    """
    known: dict[str, dict[Any, int]] = {name: {} for name in names if name in _REPEATING}
    frames = [columns_frame(dict.fromkeys(names, ()))]
    for columns in parts:
        plain = columns_frame({name: values for name, values in columns.items() if name not in known})
        codes = {
            name: [-1 if value is None else texts.setdefault(value, len(texts)) for value in columns[name]]
            for name, texts in known.items()
        }
        frames.append(plain.assign(**{name: np.array(values, np.int32) for name, values in codes.items()})[list(names)])
    frame = pd.concat([frame.astype(dict.fromkeys(known, "int32")) for frame in frames], ignore_index=True)
    categories = {
        name: pd.Categorical.from_codes(frame[name], pd.Index(list(texts), dtype="string"))
        for name, texts in known.items()
    }
    return frame.assign(**categories)


def _as_written(dtype: str, values: Sequence[Any]) -> Sequence[Any]:
    """Numbers rounded; names and settings, which repeat in thousands of rows, each held once."""
    if dtype == "float64":
        return [None if value is None else float(FLOAT_FORMAT % value) for value in values]
    return [None if value is None else sys.intern(value) for value in values] if dtype == "string" else values


def trials_csv(trials: pd.DataFrame, *, header: bool = True) -> str:
    """The text of ``trials.csv``, or of some of its lines."""
    return trials.to_csv(index=False, header=header, float_format=FLOAT_FORMAT, lineterminator="\n")


def read_trials_csv(file: Path) -> pd.DataFrame:
    """Read what ``trials_csv`` wrote, now or before rows said as much as they do.

    Raises:
        FileError: The file cannot be read, or a column holds something else than it should.
        SuiteError: A column is missing.
    """
    frame = read_columns(file, {column.name: column.dtype for column in COLUMNS})
    version = max((column.since for column in COLUMNS if column.name in frame), default=1)
    missing = [column.name for column in COLUMNS if column.name not in frame and column.since <= version]
    if missing:
        raise SuiteError(f"{file}: found no column {missing[0]}, a table of trials has one")
    frame = _with_unknown(frame, {column.name: column.dtype for column in COLUMNS if column.since > version})
    if version == 1:
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
    types = {column.name: column.dtype for column in CONDITIONS} | _POSSIBLE
    frame = _with_unknown(frame if "stale" in frame else frame.assign(stale=0), types)
    return frame[[*TABLE_TYPES, *(name for name in frame if name not in TABLE_TYPES)]]


def _with_unknown(frame: pd.DataFrame, types: Mapping[str, str]) -> pd.DataFrame:
    """Add, empty, those of the columns, given with their types, that are not there."""
    empty = [None] * len(frame)
    lacking = {name: dtype for name, dtype in types.items() if name not in frame}
    return frame.assign(**{name: pd.Series(empty, frame.index, dtype) for name, dtype in lacking.items()})


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
            warnings.simplefilter("error")  # lines that are too long, or whole numbers, would be cut
            return pd.read_csv(
                io.StringIO(text), dtype=dict(types), keep_default_na=False, na_values=[""], index_col=False
            )
    except FileError:
        raise
    except (csv.Error, ValueError, TypeError, OverflowError, Warning) as error:
        raise unreadable(file, error) from None


def refuse_gaps(trials: pd.DataFrame, file: Path) -> pd.DataFrame:
    """Return ``trials`` if every one says which it is; a file may have been written by anyone.

    Raises:
        SuiteError: Scenario, planner or outcome is missing somewhere.
    """
    for name in ("scenario_id", "scenario_hash", "family", "n_obstacles", "planner", "outcome"):
        if name in trials and trials[name].isna().any():
            raise SuiteError(f"{file}: found a trial without {name}, allowed: every trial has one")
    return trials
