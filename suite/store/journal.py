"""The journal of a run: one SQLite file, one transaction per finished trial, the truth from which tables are made."""

from __future__ import annotations

import io
import sqlite3
from collections.abc import Iterator
from pathlib import Path
from types import TracebackType
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from suite.trial.columns import COLUMN_NAMES, COLUMNS, Row, complete_row
from suite.trial.task import TrialResult, TrialTask

_SQL_TYPES = {"string": "TEXT", "boolean": "INTEGER", "Int64": "INTEGER", "float64": "REAL"}
_NAMES = ", ".join(f'"{name}"' for name in COLUMN_NAMES)


class Executed(NamedTuple):
    """What one trial executed."""

    scenario_id: str
    planner: str
    times_s: NDArray[np.float64]
    """Shape (k,)."""
    configurations_rad: NDArray[np.float64]
    """Shape (k, dof)."""


class Journal:
    """The finished trials of a run, by (scenario hash, planner label); use it as a context manager."""

    def __init__(self, file: Path) -> None:
        self._db = sqlite3.connect(file, isolation_level=None)  # every statement is a transaction of its own
        self._db.execute("PRAGMA journal_mode = WAL")
        self._db.execute("PRAGMA synchronous = NORMAL")
        columns = ", ".join(f'"{column.name}" {_SQL_TYPES[column.dtype]}' for column in COLUMNS)
        self._db.execute(
            f"CREATE TABLE IF NOT EXISTS trials ({columns}, executed BLOB NOT NULL,"
            " PRIMARY KEY (scenario_hash, planner))"
        )

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._db.close()

    def finished(self) -> set[tuple[str, str]]:
        """Keys of the trials that need not run again."""
        return set(self._db.execute("SELECT scenario_hash, planner FROM trials"))

    def add(self, task: TrialTask, result: TrialResult) -> None:
        """Store one finished trial."""
        assert (result.row["scenario_hash"], result.row["planner"]) == task.key
        marks = ", ".join("?" * (len(COLUMNS) + 1))
        values = [*complete_row(result.row).values(), _to_bytes(result)]
        self._db.execute(f"INSERT INTO trials ({_NAMES}, executed) VALUES ({marks})", values)

    def rows(self) -> Iterator[Row]:
        """All rows, in no particular order."""
        for values in self._db.execute(f"SELECT {_NAMES} FROM trials"):
            yield complete_row(dict(zip(COLUMN_NAMES, values, strict=True)))

    def executed(self) -> Iterator[Executed]:
        """What was executed, trial by trial, sorted as in the tables."""
        selected = self._db.execute(
            "SELECT scenario_id, planner, executed FROM trials ORDER BY family, n_obstacles, scenario_id, planner"
        )
        for scenario_id, planner, blob in selected:
            timed = np.load(io.BytesIO(blob), allow_pickle=False)
            yield Executed(scenario_id, planner, timed[:, 0], timed[:, 1:])


def _to_bytes(result: TrialResult) -> bytes:
    """Times and configurations side by side, shape (k, 1 + dof), in NumPy's own format."""
    buffer = io.BytesIO()
    timed = np.column_stack([result.times_s, result.configurations_rad])
    np.save(buffer, timed.astype(np.float64), allow_pickle=False)
    return buffer.getvalue()
