"""Trial rows as a pandas frame and as ``trials.csv``."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from pathlib import Path

import pandas as pd

from suite.errors import SuiteError
from suite.trial.columns import COLUMN_NAMES, COLUMNS, Row

SORTED_BY = ["family", "n_obstacles", "scenario_id", "planner"]
"""The order of rows in files, which does not depend on the order in which trials finished."""

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
    """Read what ``trials_csv`` wrote.

    Raises:
        SuiteError: The file cannot be read, or a column is missing or holds something else than it should.
    """
    dtypes = {column.name: column.dtype for column in COLUMNS}
    try:
        frame = pd.read_csv(file, dtype=dtypes, keep_default_na=False, na_values=[""])
    except (OSError, ValueError) as error:
        raise SuiteError(f"{file}: cannot be read: {error}") from None
    missing = [name for name in COLUMN_NAMES if name not in frame.columns]
    if missing:
        raise SuiteError(f"{file}: found no column {missing[0]}, a table of trials has one")
    return frame[list(COLUMN_NAMES)]
