"""The folder of a run: what it holds, whose it is, and whether a run may go on in it."""

from __future__ import annotations

import json
import os
import sqlite3
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from scenarios.reading import read_json
from suite.errors import SuiteError
from suite.experiment.code import House, changes, is_house
from suite.experiment.manifest import MAX_MANIFEST_BYTES, Manifest
from suite.files import write_text
from suite.store.frames import columns_frame, joined, read_table_csv, read_trials_csv, refuse_gaps
from suite.store.growth import Standing, settle
from suite.store.journal import Journal
from suite.store.schema import is_journal
from suite.store.volume import held
from suite.trial.columns import COLUMN_NAMES
from suite.trial.lineup import Tasks
from suite.trial.task import Code

if TYPE_CHECKING:
    import pandas as pd

MANIFEST = "manifest.json"
JOURNAL = "run.db"
TRIALS = "trials.csv"
TABLE = "table.csv"
STAMP = ".finished.json"
DERIVED = (TRIALS, TABLE, "table.md", "scenarios.jsonl", "trajectories.csv")


def read_manifest(folder: Path) -> Manifest | None:
    """The manifest of the run in ``folder``, None if there is none.

    Raises:
        SuiteError, FileError: The file cannot be read, or is no manifest.
    """
    file = folder / MANIFEST
    if not os.path.lexists(file):
        return None
    manifest = read_json(file, MAX_MANIFEST_BYTES)
    if not isinstance(manifest, dict) or not isinstance(manifest.get("experiment"), dict):
        raise SuiteError(f"{file}: found no experiment in it, allowed: the manifest of a run")
    return manifest


def planner_order(folder: Path) -> tuple[str, ...]:
    """Planner labels in the order in which they were asked for; empty if unknown."""
    manifest = read_manifest(folder)
    asked = (manifest or {}).get("experiment", {}).get("planners", ())
    return tuple(present_codes(manifest)) or (tuple(map(str, asked)) if isinstance(asked, list) else ())


def present_codes(manifest: Manifest | None) -> dict[str, Code]:
    """The code of the latest command by planner; empty for runs from before that was noted."""
    code = (manifest or {}).get("code")
    if not (isinstance(code, dict) and isinstance(code.get("planners"), dict)):
        return {}
    return {label: Code(str(code.get("house")), str(planner)) for label, planner in code["planners"].items()}


def house_changes(base: Path, new: Path) -> list[str]:
    """What has changed in the suite and its libraries from one run to another, as far as their manifests say."""
    houses = [read_manifest(folder) or {} for folder in (base, new)]
    if not all(isinstance(house.get("versions"), dict) and "sources" in house for house in houses):
        return []
    return [f"the suite: {change}" for change in changes(*houses)]


def read_trials(folder: Path, names: Sequence[str] = COLUMN_NAMES) -> pd.DataFrame | None:
    """The trials so far: from the journal, or from ``trials.csv`` where only that was kept; None without either.

    Args:
        folder: The run's.
        names: Columns that are wanted; of a large run a few are read in a fraction of the time.

    Raises:
        SuiteError: They cannot be read.
    """
    if (folder / JOURNAL).exists():
        try:
            with open_journal(folder) as journal:
                return refuse_gaps(joined(map(columns_frame, journal.columns(names)), names), folder / JOURNAL)
        except (OSError, sqlite3.Error) as error:
            raise SuiteError(f"{folder / JOURNAL}: cannot be read: {error}{_damaged(error)}") from None
    return refuse_gaps(read_trials_csv(folder / TRIALS), folder / TRIALS) if (folder / TRIALS).exists() else None


def read_table(folder: Path) -> pd.DataFrame:
    """The summary in ``table.csv``, for a run of which no trials were kept.

    Raises:
        SuiteError: There is none, or it cannot be read.
    """
    if not (folder / TABLE).exists():
        raise SuiteError(f"{folder}: found no {JOURNAL}, {TRIALS} or {TABLE}, allowed: the folder of a run")
    return read_table_csv(folder / TABLE)


def open_journal(folder: Path) -> Journal:
    """The journal of a run of any version, to read.

    Raises:
        SuiteError: There is none.
        sqlite3.Error: It cannot be read.
    """
    if not (folder / JOURNAL).exists():
        raise SuiteError(f"{folder}: found no {JOURNAL}, allowed: the folder of a run with its journal")
    return Journal(folder / JOURNAL, read_only=True, old_house=_old_house(folder))


@contextmanager
def open_run(
    folder: Path, manifest: Manifest, tasks: Tasks, *, fresh: bool = False, keep_stale: bool = False
) -> Iterator[tuple[Journal, Standing]]:
    """Start or continue a run, and keep other processes out of it meanwhile.

    Args:
        folder: Made if need be.
        manifest: What is about to run.
        tasks: Its trials; passed through once, or twice where rows of the first version lack something.
        fresh: Forget what earlier commands have left there.
        keep_stale: Use rows that other code has made where there are none of the present code.

    Yields:
        The journal, in which the tasks are asked for, and how far they are.

    Raises:
        SuiteError: The rows there are of another house, or the folder holds something that is no run, is in use, or
            cannot be written. Then nothing in it has been changed.
    """
    with ExitStack() as stack:
        try:
            _refuse_strangers(folder)
            folder.mkdir(parents=True, exist_ok=True)
            stack.enter_context(held(folder))
            if fresh:
                _forget(folder, manifest)
            house = {part: manifest[part] for part in ("sources", "versions")}
            old_house = _old_house(folder)
            standing = _standing(folder, old_house, house, tasks, keep_stale=keep_stale)
            journal = stack.enter_context(Journal(folder / JOURNAL, old_house=old_house))
            journal.ask(standing.chosen, house)
            journal.complete(tasks)
            _write_manifest(folder, manifest)
        except (OSError, sqlite3.Error) as error:
            reason = getattr(error, "strerror", None) or error
            raise SuiteError(f"{folder}: cannot be read or written: {reason}{_damaged(error)}") from None
        yield journal, standing


def _damaged(error: Exception) -> str:
    """What to do about a journal of which a part is lost."""
    is_damaged = isinstance(error, sqlite3.DatabaseError) and not isinstance(error, sqlite3.OperationalError)
    return "; suite merge saves what can be read, run --fresh starts over" if is_damaged else ""


def standing_of(folder: Path, manifest: Manifest, tasks: Tasks, *, keep_stale: bool) -> Standing:
    """How far the run in ``folder`` is with ``tasks``; nothing is written.

    Raises:
        SuiteError: As ``open_run``, but for what only writing shows.
    """
    try:
        _refuse_strangers(folder)
        house = {part: manifest[part] for part in ("sources", "versions")}
        return _standing(folder, _old_house(folder), house, tasks, keep_stale=keep_stale)
    except (OSError, sqlite3.Error) as error:
        raise SuiteError(f"{folder}: cannot be read: {getattr(error, 'strerror', None) or error}") from None


def _standing(folder: Path, old_house: House | None, house: House, tasks: Tasks, *, keep_stale: bool) -> Standing:
    """How far the run is; rows of another house are for the user to decide about."""
    if not (folder / JOURNAL).exists():
        return settle(tasks, {}, keep_stale=keep_stale)
    with Journal(folder / JOURNAL, read_only=True, old_house=old_house) as journal:
        standing = settle(tasks, journal.made(), keep_stale=keep_stale)
        if standing.other_houses:
            theirs = journal.houses().get(standing.other_houses.most_common(1)[0][0])
            what = "; ".join(changes(theirs, house)[:3]) if theirs else "nothing says which"
            raise SuiteError(
                f"{folder}: {standing.other_houses.total()} of {len(standing.chosen)} trials were run by another"
                f" version of the suite ({what}); start over with --fresh, or use them as they are with --keep-stale"
            )
    return standing


def _old_house(folder: Path) -> House | None:
    """What made the rows of a run of the first version: its manifest says it, once for all of them."""
    manifest = read_manifest(folder) or {}
    house = {part: manifest.get(part) for part in ("sources", "versions")}
    return house if is_house(house) and "schema_version" not in manifest else None


def _forget(folder: Path, manifest: Manifest) -> None:
    """Delete what a run has left; the folder is that of a run at any instant, so that this may be cut short."""
    _write_manifest(folder, manifest)
    for name in (STAMP, *DERIVED, JOURNAL, f"{JOURNAL}-wal", f"{JOURNAL}-shm"):
        (folder / name).unlink(missing_ok=True)


def _write_manifest(folder: Path, manifest: Manifest) -> None:
    write_text(folder / MANIFEST, json.dumps(manifest, indent=2) + "\n")


def _refuse_strangers(folder: Path) -> None:
    """Nothing is written beside, or deleted from among, files that are not of a run."""
    if not folder.exists():
        return
    if not folder.is_dir():
        raise SuiteError(f"{folder}: found a file, allowed: a folder")
    others = [entry.name for entry in folder.iterdir() if not entry.name.startswith(".")]
    if others and MANIFEST not in others and not (JOURNAL in others and is_journal(folder / JOURNAL)):
        raise SuiteError(f"{folder}: found {others[0]} and no {MANIFEST}, allowed: an empty folder or that of a run")
