"""The tables of a journal: how they are made, how those of the first version are read and brought up to date."""

from __future__ import annotations

import json
import shutil
import sqlite3
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import closing, contextmanager
from pathlib import Path

from planners import is_bound
from scenarios import UserError
from scenarios.reading import open_regular
from suite.errors import SuiteError
from suite.experiment.code import House, house_code
from suite.store.volume import is_held, is_remote
from suite.trial.columns import COLUMN_NAMES, COLUMNS, KEY_NAMES, SCHEMA_VERSION, trial_key
from suite.trial.task import UNKNOWN

APPLICATION_ID = 0x41524D53
"""What a database says in its header that is a journal of this suite; those of the first version say nothing."""

MAX_FILE_BYTES = 1024**4

_SQL_TYPES = {"string": "TEXT", "boolean": "INTEGER", "Int64": "INTEGER", "float64": "REAL"}
_OLD_NAMES = {column.name for column in COLUMNS if column.since == 1} | {"executed"}
_MARGIN_ONE = {"rrt", "rrtconnect", "strrt", "prm", "temporal-ct"}

# A row stays where it is for good; what the latest command asks for, and which code's row stands for it, is `asked`.
_COLUMNS = ", ".join(f'"{column.name}" {_SQL_TYPES[column.dtype]}' for column in COLUMNS)
_SHOWN = "CREATE VIEW shown AS SELECT trials.* FROM asked JOIN trials USING (key, house_code, planner_code)"
_TABLES = (
    f"""CREATE TABLE trials (
        number INTEGER PRIMARY KEY, key TEXT NOT NULL, {_COLUMNS}, executed BLOB NOT NULL, traceback TEXT NOT NULL,
        UNIQUE (key, house_code, planner_code))""",
    """CREATE TABLE asked (
        position INTEGER PRIMARY KEY, key TEXT NOT NULL UNIQUE,
        house_code TEXT NOT NULL, planner_code TEXT NOT NULL)""",
    "CREATE TABLE houses (house_code TEXT PRIMARY KEY, description TEXT NOT NULL)",
    _SHOWN,
)


def open_to_read(file: Path, old_house: House | None = None) -> sqlite3.Connection:
    """Open a journal of any version, without writing or making any file.

    Args:
        file: The database.
        old_house: What made the rows of a journal of the first version, which do not say it themselves.

    Raises:
        SuiteError: It is no journal, or one of a newer version.
        sqlite3.Error: It cannot be read.
    """
    db = _read_only(file)
    try:
        version = _version(file, db)
        db.execute("PRAGMA temp_store = MEMORY")
        if version == 0:
            for table in _TABLES:
                db.execute(table.replace("CREATE", "CREATE TEMP"))
        elif version < SCHEMA_VERSION:
            # Under the names of the present tables, which hide the one that is there.
            _define_functions(db)
            db.execute(f"CREATE TEMP VIEW trials AS SELECT {_as_present(version, old_house)} FROM main.trials")
            if version == 1:
                db.execute("CREATE TEMP VIEW shown AS SELECT * FROM trials")
                db.execute("CREATE TEMP TABLE houses (house_code TEXT, description TEXT)")
                remember_house(db, old_house)
            else:
                db.execute(_SHOWN.replace("CREATE", "CREATE TEMP"))
    except BaseException:
        db.close()
        raise
    return db


def is_journal(file: Path) -> bool:
    """Whether the file is a journal, or will be one when a run that was killed at once goes on."""
    try:
        with closing(_read_only(file)) as db:
            return _version(file, db) >= 0
    except (UserError, sqlite3.Error):
        return False


def open_to_write(file: Path, old_house: House | None = None) -> sqlite3.Connection:
    """Open a journal to add to it: a new one is made, one of the first version brought up to date.

    Raises:
        SuiteError, sqlite3.Error: As ``open_to_read``; then nothing has been changed.
    """
    version = 0
    if file.exists():
        with closing(_read_only(file)) as there:
            version = _version(file, there)
    else:
        for rest in ("-wal", "-shm"):  # of a journal that was deleted, by a process that was killed before it got here
            file.with_name(file.name + rest).unlink(missing_ok=True)
    db = sqlite3.connect(file, isolation_level=None)  # every statement is a transaction of its own
    # A log of changes is shared through memory, which machines do not share.
    mode, sync = ("DELETE", "FULL") if is_remote(file.parent) else ("WAL", "NORMAL")
    db.execute(f"PRAGMA journal_mode = {mode}")
    db.execute(f"PRAGMA synchronous = {sync}")
    if version < SCHEMA_VERSION:
        with transaction(db):
            if version == 1:
                db.execute("ALTER TABLE trials RENAME TO old")
            for table in _TABLES if version < 2 else ():
                db.execute(table)
            for column in COLUMNS if version >= 2 else ():
                if column.since > version:
                    db.execute(f'ALTER TABLE trials ADD COLUMN "{column.name}" {_SQL_TYPES[column.dtype]}')
            if version == 1:
                _define_functions(db)
                names = ", ".join(f'"{name}"' for name in ("number", "key", *COLUMN_NAMES, "executed", "traceback"))
                db.execute(f"INSERT INTO trials ({names}) SELECT {_as_present(1, old_house)} FROM old")
                db.execute("DROP TABLE old")
                remember_house(db, old_house)
            db.execute(f"PRAGMA application_id = {APPLICATION_ID}")
            db.execute(f"PRAGMA user_version = {SCHEMA_VERSION}")
    return db


@contextmanager
def transaction(db: sqlite3.Connection) -> Iterator[None]:
    """All of a block or nothing of it."""
    db.execute("BEGIN IMMEDIATE")
    try:
        yield
    except BaseException:
        db.execute("ROLLBACK")
        raise
    db.execute("COMMIT")


def remember_house(db: sqlite3.Connection, house: House | None) -> None:
    """Keep what stands behind a house's hash, so that it can be said what has changed."""
    if house is not None:
        db.execute("INSERT OR IGNORE INTO houses VALUES (?, ?)", (house_code(house), json.dumps(dict(house))))


def old_margin(planner: str) -> float:
    """Margin that a planner had before rows said so."""
    return 1.0 if planner.partition("[")[0] in _MARGIN_ONE else 0.0


def _read_only(file: Path) -> sqlite3.Connection:
    """Open a database as it is; SQLite would otherwise make files beside it, or change what is in them."""
    open_regular(file, MAX_FILE_BYTES).close()
    log = file.with_name(f"{file.name}-wal")
    if not (log.exists() and log.stat().st_size > 0):
        return _connect(file, "mode=ro&immutable=1")
    if is_held(file.parent):  # whoever writes it shares it
        return _connect(file, "mode=ro")
    with tempfile.TemporaryDirectory() as folder:  # left by a run that was killed: SQLite would clear up
        for there in (file, log):
            shutil.copyfile(there, Path(folder, there.name))
        db = _connect(Path(folder, file.name), "mode=rw")
        db.execute("PRAGMA user_version").fetchone()  # opens what is about to lose its name
        return db


def _connect(file: Path, how: str) -> sqlite3.Connection:
    return sqlite3.connect(f"{file.resolve().as_uri()}?{how}", uri=True, isolation_level=None)


def _version(file: Path, db: sqlite3.Connection) -> int:
    """Version of a journal, 0 for a database in which there is nothing yet."""
    (application,), (version,) = (
        db.execute(f"PRAGMA {name}").fetchone() for name in ("application_id", "user_version")
    )
    if application == APPLICATION_ID and version > SCHEMA_VERSION:
        raise SuiteError(f"{file}: found a journal of version {version}, allowed up to {SCHEMA_VERSION}: update suite")
    try:
        names = {name for _, name, *_ in db.execute("PRAGMA table_info(trials)")}
    except UnicodeDecodeError:  # damaged, and not what SQLite looks for
        names = set()
    if application == APPLICATION_ID and version >= 2 and {c.name for c in COLUMNS if c.since <= version} < names:
        return int(version)
    if application == version == 0:
        if names == _OLD_NAMES:
            return 1
        if db.execute("SELECT count(*) FROM sqlite_master").fetchone() == (0,):
            return 0
    raise SuiteError(f"{file}: found no journal of a run in it, allowed one of version 1 to {SCHEMA_VERSION}")


def _define_functions(db: sqlite3.Connection) -> None:
    """What the SQL of ``_as_present`` needs."""

    def key(*values: object) -> str:
        return trial_key(dict(zip(KEY_NAMES, values, strict=True)))

    db.create_function("trial_key", len(KEY_NAMES), key, deterministic=True)
    db.create_function("old_margin", 1, old_margin, deterministic=True)
    db.create_function("old_is_bound", 1, is_bound, deterministic=True)


def _as_present(version: int, old_house: House | None) -> str:
    """What to select from a table of an earlier version to get rows of the present one."""
    if version > 1:
        known = (f'"{c.name}"' if c.since <= version else f'NULL AS "{c.name}"' for c in COLUMNS)
        return ", ".join(["number", "key", *known, "executed", "traceback"])
    code = f"'{UNKNOWN if old_house is None else house_code(old_house)}'"
    made: Mapping[str, str] = {
        "house_code": code,
        "planner_code": code,
        "prediction_margin": "old_margin(planner)",
        "is_bound": "old_is_bound(planner)",
    }
    names = ", ".join(made.get(name, f'"{name}"') for name in KEY_NAMES)
    selected = ["rowid AS number", f"trial_key({names}) AS key"]
    for column in COLUMNS:
        value = f'"{column.name}"' if column.since == 1 else made.get(column.name, "NULL")
        selected.append(f'{value} AS "{column.name}"')
    return ", ".join([*selected, "executed", "'' AS traceback"])
