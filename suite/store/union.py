"""Several journals as one: every trial of each, none twice, and what does not go together by name."""

from __future__ import annotations

import hashlib
import json
import sqlite3
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from suite.errors import SuiteError
from suite.experiment.code import House, changes
from suite.store.journal import Journal, Stored
from suite.store.run_folder import JOURNAL, open_journal
from suite.trial.columns import COLUMNS
from suite.trial.task import Code


@dataclass
class Union:
    """What a union of journals has found."""

    chosen: dict[str, Code] = field(default_factory=dict)
    """By the trials' keys: the code whose row stands for each; of several that of the run named last."""
    houses: dict[str, House] = field(default_factory=dict)
    outcomes: dict[tuple[str, Code], tuple[Path, str]] = field(default_factory=dict)
    """By key and code of every trial: the first run that has it, and a digest of its row."""
    planner_codes: dict[str, Counter[Code]] = field(default_factory=dict)
    """Trials that stand by planner and code."""
    conflicts: list[str] = field(default_factory=list)
    """Trials of which two runs have different rows by the same code, a line each."""
    notes: list[str] = field(default_factory=list)
    """What else there is to say, a line each."""

    def code_notes(self) -> Iterator[str]:
        """Which planners' rows are of several codes."""
        for planner, codes in self.planner_codes.items():
            (main, _), *others = codes.most_common()
            for other, count in others:
                ours, theirs = self.houses.get(main.house), self.houses.get(other.house)
                what = "; ".join(changes(theirs, ours)[:3]) if ours and theirs and ours != theirs else ""
                said = what or ("its own code differs" if main.house == other.house else "nothing says what differs")
                yield f"{planner}: {count} of {codes.total()} trials were run by other code ({said})"


def unite(folders: Sequence[Path], out: Path) -> Union:
    """Put the journals of runs together in a new one; those are read only.

    A journal that is damaged gives what can be read of it.

    Args:
        folders: Of the runs; where rows differ by the same code, that of the first stands.
        out: File of the new journal.

    Raises:
        SuiteError: A folder has no journal, or one that cannot be read at all.
    """
    union, several = Union(), 0
    with Journal(out) as journal:
        for folder in folders:
            there = len(union.outcomes)
            shown = _take(folder, journal, union)
            several += sum(union.chosen.get(key, code) != code for key, code in shown.items())
            union.chosen |= shown
            if len(union.outcomes) == there:
                union.notes.append(f"{folder}: found no trial that the runs named before do not have")
        for planner, key, code in journal.planners():
            if union.chosen.get(key) == code:
                union.planner_codes.setdefault(planner, Counter())[code] += 1
    if several:
        union.notes.append(f"{several} trials were run by several codes: the rows of the run named last stand")
    return union


def _take(folder: Path, journal: Journal, union: Union) -> dict[str, Code]:
    """Take what is new from one run, and return which of its rows stand for its trials."""
    lost: list[int] = []
    taken: dict[str, Code] = {}
    try:
        with open_journal(folder) as theirs:
            houses = _readable_houses(theirs)
            union.houses |= houses or {}
            journal.keep(_new(folder, theirs.stored(lost), union, taken), houses or {})
            if lost or houses is None:
                union.notes.append(f"{folder / JOURNAL}: damaged; {len(taken)} trials of it could be read")
                return taken
            return theirs.shown_codes()
    except sqlite3.Error as error:
        raise SuiteError(f"{folder / JOURNAL}: cannot be read: {error}"[:300]) from None


def _new(folder: Path, trials: Iterable[Stored], union: Union, taken: dict[str, Code]) -> Iterator[Stored]:
    """Those that no run before had; conflicts with runs before are noted, and so is what was ``taken``."""
    for one in trials:
        taken[one.key] = one.code
        outcome = _outcome(one)
        before = union.outcomes.setdefault((one.key, one.code), (folder, outcome))
        if before[0] == folder:
            yield one
        elif before[1] != outcome:
            row = one.row
            union.conflicts.append(f"{row['scenario_id']}, {row['planner']}: {before[0]} and {folder} differ")


def _readable_houses(journal: Journal) -> dict[str, House] | None:
    """The houses that a journal names; None where it is damaged, there or where it says what is asked for."""
    try:
        journal.shown_codes()
        return journal.houses()
    except (sqlite3.DatabaseError, ValueError):
        return None


def _outcome(one: Stored) -> str:
    """16 hexadecimal digits of all of a trial but its timings."""
    values = [one.row[column.name] for column in COLUMNS if not column.is_timing]
    return hashlib.sha256(json.dumps(values).encode() + one.executed).hexdigest()[:16]
