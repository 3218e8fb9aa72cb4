"""The folder of a run: what it holds, whose it is, and whether a run may go on in it."""

from __future__ import annotations

import fcntl
import json
import os
import sqlite3
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from suite.errors import SuiteError
from suite.experiment.manifest import Manifest, differences
from suite.files import write_text
from suite.store.journal import Journal

if TYPE_CHECKING:
    import pandas as pd

MANIFEST = "manifest.json"
JOURNAL = "run.db"
TRIALS = "trials.csv"
DERIVED = (TRIALS, "table.csv", "table.md", "scenarios.jsonl", "trajectories.csv")


def read_manifest(folder: Path) -> Manifest | None:
    """The manifest of the run in ``folder``, None if there is none.

    Raises:
        SuiteError: The file cannot be read.
    """
    file = folder / MANIFEST
    try:
        manifest = json.loads(file.read_text(encoding="utf-8"))
    except (FileNotFoundError, NotADirectoryError):
        return None
    except (OSError, ValueError) as error:
        raise SuiteError(f"{file}: cannot be read: {error}") from None
    if not isinstance(manifest, dict) or not isinstance(manifest.get("experiment"), dict):
        raise SuiteError(f"{file}: found no experiment in it, allowed: the manifest of a run")
    return manifest


def planner_order(folder: Path) -> tuple[str, ...]:
    """Planner labels in the order in which they were asked for; empty if unknown."""
    manifest = read_manifest(folder)
    return tuple(manifest["experiment"].get("planners", ())) if manifest else ()


def read_trials(folder: Path) -> pd.DataFrame:
    """The trials so far: from the journal, or from ``trials.csv`` where only that was kept.

    Raises:
        SuiteError: There is neither, or it cannot be read.
    """
    from suite.store.frames import read_trials_csv, trials_frame

    if (folder / JOURNAL).exists():
        try:
            with Journal(folder / JOURNAL) as journal:
                return trials_frame(journal.rows())
        except sqlite3.Error as error:
            raise SuiteError(f"{folder / JOURNAL}: cannot be read: {error}") from None
    if (folder / TRIALS).exists():
        return read_trials_csv(folder / TRIALS)
    raise SuiteError(f"{folder}: found neither {JOURNAL} nor {TRIALS}, allowed: the folder of a run")


@contextmanager
def open_run(folder: Path, manifest: Manifest, *, fresh: bool) -> Iterator[Journal]:
    """Start or continue the run that ``manifest`` describes, and keep other processes out of it meanwhile.

    Args:
        folder: Made if need be.
        manifest: What is about to run.
        fresh: Forget what an earlier run has left there.

    Raises:
        SuiteError: The folder holds another run or something that is no run, is in use, or cannot be written.
    """
    with ExitStack() as stack:
        try:
            _refuse_strangers(folder)
            there = None if fresh else read_manifest(folder)
            if there is not None and (found := differences(there, manifest)):
                raise SuiteError(
                    f"{folder}: holds another run ({'; '.join(found[:3])});"
                    " start it over with --fresh, or choose another folder with --out"
                )
            folder.mkdir(parents=True, exist_ok=True)
            stack.enter_context(_held(folder))
            if fresh:
                for name in (MANIFEST, JOURNAL, f"{JOURNAL}-wal", f"{JOURNAL}-shm", *DERIVED):
                    (folder / name).unlink(missing_ok=True)
            if there is None:
                write_text(folder / MANIFEST, json.dumps(manifest, indent=2) + "\n")
            journal = stack.enter_context(Journal(folder / JOURNAL))
        except (OSError, sqlite3.Error) as error:
            raise SuiteError(f"{folder}: cannot be written: {getattr(error, 'strerror', None) or error}") from None
        yield journal


def _refuse_strangers(folder: Path) -> None:
    """Nothing is written beside, or deleted from among, files that are not of a run."""
    if not folder.exists():
        return
    if not folder.is_dir():
        raise SuiteError(f"{folder}: found a file, allowed: a folder")
    others = [entry.name for entry in folder.iterdir() if not entry.name.startswith(".")]
    if others and MANIFEST not in others:
        raise SuiteError(f"{folder}: found {others[0]} and no {MANIFEST}, allowed: an empty folder or that of a run")


@contextmanager
def _held(folder: Path) -> Iterator[None]:
    """Hold a lock on the folder itself; it goes with the process, however that ends."""
    handle = os.open(folder, os.O_RDONLY)
    try:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise SuiteError(f"{folder}: another process is running in it, allowed: one at a time") from None
        yield
    finally:
        os.close(handle)
