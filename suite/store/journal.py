"""The journal of a run: one SQLite file, one transaction per finished trial, the truth from which tables are made."""

from __future__ import annotations

import hashlib
import io
import json
import re
import sqlite3
from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Any, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from suite.errors import SuiteError
from suite.experiment.code import House, is_house
from suite.store.schema import open_to_read, open_to_write, remember_house, transaction
from suite.trial.columns import COLUMN_NAMES, COLUMNS, CONDITIONS, SORTED_BY, Row, complete_row, plain_values
from suite.trial.task import Code, TrialResult, TrialTask

_HEADER = re.compile(rb"\{'descr': '<f8', 'fortran_order': (True|False), 'shape': \((\d{1,9}), (\d{1,9})\), \}")
_NAMES = ", ".join(f'"{name}"' for name in COLUMN_NAMES)
_SORTED = ", ".join(f'"{name}" NULLS LAST' for name in SORTED_BY)
_LEAST_BYTES = 256  # of a row with its names, hashes and trajectory
CHUNK = 2_000
"""Rows that are read together."""


class Executed(NamedTuple):
    """What one trial executed."""

    scenario_id: str
    planner: str
    times_s: NDArray[np.float64]
    """Shape (k,)."""
    configurations_rad: NDArray[np.float64]
    """Shape (k, dof)."""
    conditions: Row
    """Under which conditions, by the names in ``CONDITIONS``."""


class Stored(NamedTuple):
    """One trial as it stands in a journal, whatever is asked for."""

    key: str
    row: Row
    executed: bytes
    traceback: str

    @property
    def code(self) -> Code:
        """What made it."""
        return Code(self.row["house_code"], self.row["planner_code"])


class Journal:
    """Every trial that ever finished in a run, and which of them its latest command asks for; a context manager.

    No row is ever replaced or deleted: run again by other code, a trial has another row.
    """

    def __init__(self, file: Path, *, read_only: bool = False, old_house: House | None = None) -> None:
        """Open, or make, the journal in ``file``; ``old_house`` made the rows of one that does not say it itself.

        Raises:
            SuiteError: The file is no journal, or of a newer version.
            sqlite3.Error: It cannot be read or written.
        """
        self._file = file
        self._db = (open_to_read if read_only else open_to_write)(file, old_house)
        self._inode = file.stat().st_ino

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._db.close()

    def made(self) -> dict[str, list[Code]]:
        """Which code has made rows of which trial, by the trial's key, the latest last."""
        made: dict[str, list[Code]] = {}
        for key, *code in self._db.execute("SELECT key, house_code, planner_code FROM trials ORDER BY number"):
            made.setdefault(key, []).append(Code(*code))
        return made

    def stored(self, lost: list[int] | None = None) -> Iterator[Stored]:
        """Every trial, in the order in which they finished, or those of a damaged journal that can be read.

        Args:
            lost: Takes the numbers of trials that cannot be read; such a trial is an error when None.

        Raises:
            SuiteError: A value is not of its column's type.
            sqlite3.Error: The journal cannot be read.
        """
        query = f"SELECT key, {_NAMES}, executed, traceback FROM trials WHERE number = ?"
        for number in range(1, self._last_number(lost) + 1):
            try:
                for key, *values, executed, traceback in self._db.execute(query, [number]):
                    yield Stored(key, self._complete(values), executed, traceback)
            except (sqlite3.DatabaseError, SuiteError):
                if lost is None:
                    raise
                lost.append(number)

    def _last_number(self, lost: list[int] | None) -> int:
        """The last trial's number; where that cannot be read, as many as could stand in the file."""
        try:
            (last,) = self._db.execute("SELECT max(number) FROM trials").fetchone()
            return int(last or 0)
        except sqlite3.DatabaseError:
            if lost is None:
                raise
            return self._file.stat().st_size // _LEAST_BYTES

    def shown_codes(self) -> dict[str, Code]:
        """Which code's row stands for each trial that is asked for and there, by the trial's key."""
        selected = self._db.execute("SELECT key, house_code, planner_code FROM shown ORDER BY number")
        return {key: Code(*code) for key, *code in selected}

    def planners(self) -> Iterator[tuple[str, str, Code]]:
        """Planner, key and code of every trial."""
        for planner, key, *code in self._db.execute("SELECT planner, key, house_code, planner_code FROM trials"):
            yield planner, key, Code(*code)

    def keep(self, trials: Iterable[Stored], houses: Mapping[str, House]) -> None:
        """Store trials of another journal; all or none."""
        marks = ", ".join("?" * (len(COLUMNS) + 3))
        with transaction(self._db):
            for house in houses.values():
                remember_house(self._db, house)
            self._db.executemany(
                f"INSERT INTO trials (key, {_NAMES}, executed, traceback) VALUES ({marks})",
                ([one.key, *one.row.values(), one.executed, one.traceback] for one in trials),
            )

    def houses(self) -> dict[str, House]:
        """What stands behind the hashes of houses."""
        houses = {}
        for code, text in self._db.execute("SELECT * FROM houses"):
            with suppress(ValueError, TypeError, RecursionError):  # damaged: nobody knows what it was
                houses[code] = json.loads(text)
        return {code: house for code, house in houses.items() if is_house(house)}

    def ask(self, chosen: Mapping[str, Code], house: House | None) -> None:
        """Note what the present command asks for: keys of trials, and the code whose rows stand for them."""
        rows = [(position, key, *code) for position, (key, code) in enumerate(chosen.items())]
        with transaction(self._db):
            remember_house(self._db, house)
            self._db.execute("DELETE FROM asked")
            self._db.executemany("INSERT INTO asked VALUES (?, ?, ?, ?)", rows)

    def complete(self, tasks: Iterable[TrialTask]) -> None:
        """Fill in what rows of the first version do not say of their scenarios, as far as these are known by now."""
        lacking = {key for (key,) in self._db.execute("SELECT key FROM trials WHERE arm IS NULL")}
        if not lacking:
            return
        known = ((task.identity["arm"], task.identity["family_parameters"], task.key) for task in tasks)
        with transaction(self._db):
            self._db.executemany(
                "UPDATE trials SET arm = ?, family_parameters = ? WHERE key = ? AND arm IS NULL",
                (values for values in known if values[-1] in lacking),
            )

    def finished(self) -> set[str]:
        """Keys of the trials that are asked for and need not run again."""
        return {key for (key,) in self._db.execute("SELECT key FROM shown")}

    def shown_digest(self) -> str:
        """16 hexadecimal digits of which rows are asked for and there; a row never changes."""
        digest = hashlib.sha256()
        for number, key in self._db.execute("SELECT number, key FROM shown ORDER BY number"):
            digest.update(f"{number} {key}\n".encode())
        return digest.hexdigest()[:16]

    def add(self, task: TrialTask, result: TrialResult) -> None:
        """Store one finished trial.

        Raises:
            SuiteError: The file has been deleted: what is written into it now will be lost.
            sqlite3.Error: It cannot be written, as on a full disk.
        """
        if not (self._file.exists() and self._file.stat().st_ino == self._inode):
            raise SuiteError(f"{self._file}: found it deleted or replaced while the run went on, allowed to stay")
        row = complete_row(result.row)
        assert all(row[name] == value for name, value in task.identity.items())
        marks = ", ".join("?" * (len(COLUMNS) + 3))
        values = [task.key, *row.values(), _to_bytes(result), result.traceback]
        self._db.execute(f"INSERT INTO trials (key, {_NAMES}, executed, traceback) VALUES ({marks})", values)

    def rows(self) -> Iterator[Row]:
        """All rows that are asked for, in no particular order.

        Raises:
            SuiteError: A value is not of its column's type.
        """
        for values in self._db.execute(f"SELECT {_NAMES} FROM shown"):
            yield self._complete(values)

    def _complete(self, values: Sequence[Any]) -> Row:
        try:
            return complete_row(dict(zip(COLUMN_NAMES, values, strict=True)))
        except (ValueError, TypeError) as error:
            raise SuiteError(f"{self._file}: found a row with a value that fits no trial: {error}"[:300]) from None

    def columns(self, names: Sequence[str] = COLUMN_NAMES) -> Iterator[dict[str, list[Any]]]:
        """The rows that are asked for, sorted, some thousands at a time: the values of each column in ``names``.

        Raises:
            SuiteError: A value is not of its column's type.
        """
        selected = self._db.execute(f"SELECT {', '.join(names)} FROM shown ORDER BY {_SORTED}")
        while rows := selected.fetchmany(CHUNK):
            try:
                yield {
                    name: plain_values(name, values)
                    for name, values in zip(names, zip(*rows, strict=True), strict=True)
                }
            except (ValueError, TypeError) as error:
                raise SuiteError(f"{self._file}: found a row with a value that fits no trial: {error}"[:300]) from None

    def executed(self) -> Iterator[Executed]:
        """What was executed in the trials that are asked for, sorted as in the tables.

        Raises:
            SuiteError: What is stored is no trajectory.
        """
        names = [column.name for column in CONDITIONS]
        row = f"SELECT scenario_id, planner, executed, {', '.join(names)} FROM trials WHERE number = ?"
        # Sorted by number first: trajectories, sorted as they are, would go through gigabytes of temporary files.
        numbers = self._db.execute(f"SELECT number FROM shown ORDER BY {_SORTED}").fetchall()
        for number in numbers:
            scenario_id, planner, blob, *values = self._db.execute(row, number).fetchone()
            yield self._executed(scenario_id, planner, blob, dict(zip(names, values, strict=True)))

    def kept(self, scenarios: Container[str]) -> Iterator[tuple[Row, Executed]]:
        """Rows that are asked for of ``scenarios``, given by id, with what was executed, sorted as in the tables.

        Raises:
            SuiteError: A value is not of its column's type, or what is stored is no trajectory.
        """
        found = self._db.execute(f"SELECT number, scenario_id FROM shown ORDER BY {_SORTED}").fetchall()
        for number in (number for number, scenario_id in found if scenario_id in scenarios):
            one = self._db.execute(f"SELECT {_NAMES}, executed FROM trials WHERE number = ?", [number])
            *values, blob = one.fetchone()
            row = self._complete(values)
            conditions = {column.name: row[column.name] for column in CONDITIONS}
            yield row, self._executed(row["scenario_id"], row["planner"], blob, conditions)

    def _executed(self, scenario_id: str, planner: str, blob: bytes, conditions: Row) -> Executed:
        try:
            timed = _from_bytes(blob)
            return Executed(scenario_id, planner, timed[:, 0], timed[:, 1:], conditions)
        except (ValueError, TypeError, EOFError, IndexError):
            raise SuiteError(f"{self._file}: {scenario_id} {planner}: found no trajectory in it") from None


def _to_bytes(result: TrialResult) -> bytes:
    """Times and configurations side by side, shape (k, 1 + dof), in NumPy's own format."""
    buffer = io.BytesIO()
    timed = np.column_stack([result.times_s, result.configurations_rad])
    np.save(buffer, timed.astype(np.float64), allow_pickle=False)
    return buffer.getvalue()


def _from_bytes(blob: bytes) -> NDArray[np.float64]:
    """The same again; by hand, since what NumPy raises over a damaged header, or allocates for it, knows no bounds.

    Raises:
        ValueError, TypeError: It is something else.
    """
    start = 10 + int.from_bytes(blob[8:10], "little")
    header = _HEADER.match(blob[10:start])
    if header is None:
        raise ValueError("found no header of an array")
    order, *shape = header.groups()
    return np.frombuffer(blob[start:], "<f8").reshape([int(n) for n in shape], order="F" if order == b"True" else "C")
