"""Whether a run is finished and all its files are made, found out without a look at its trials.

A hundred thousand trials take minutes to be drawn again and their tables to be made. So a run that ends leaves a
stamp: what was asked for, which rows the journal shows for it, and size and time of every file. If all of it still
holds, there is nothing to do; whatever else is found, everything is looked at again.
"""

from __future__ import annotations

import json
import sqlite3
from pathlib import Path

from scenarios import UserError
from suite.files import write_text
from suite.store.journal import Journal
from suite.store.run_folder import DERIVED, JOURNAL, MANIFEST, STAMP

MAX_BYTES = 10_000


def is_finished(folder: Path, asked: str) -> bool:
    """Whether ``folder`` holds all trials of the experiment with this fingerprint, and their tables."""
    try:
        file = folder / STAMP
        if not file.is_file() or file.stat().st_size > MAX_BYTES:
            return False
        with Journal(folder / JOURNAL, read_only=True) as journal:
            return bool(file.read_text(encoding="utf-8") == _text(folder, asked, journal))
    except (OSError, UnicodeDecodeError, UserError, sqlite3.Error):
        return False  # the long way round says what is wrong


def stamp(folder: Path, asked: str, journal: Journal) -> None:
    """Leave the stamp of a run that has come to its end."""
    write_text(folder / STAMP, _text(folder, asked, journal))


def _text(folder: Path, asked: str, journal: Journal) -> str:
    """What the stamp says if all is well; it is compared as it stands, so nothing in it needs to be trusted."""
    states = {name: (folder / name).stat() for name in (MANIFEST, *DERIVED)}
    files = {name: [state.st_size, state.st_mtime_ns] for name, state in states.items()}
    return json.dumps({"asked": asked, "shown": journal.shown_digest(), "files": files}, indent=1) + "\n"
