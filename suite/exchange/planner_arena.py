"""A run as a database of OMPL's benchmarks, which Planner Arena and its relatives draw.

The schema is OMPL's (doc/markdown/benchmark.md): experiments, plannerConfigs, enums, runs, progress. Readers go by the
order of columns, so those that every such database has come first, named as there, and what the suite adds comes after.
An experiment is a family and number of obstacles under one set of conditions; a run is a trial.
"""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Mapping
from contextlib import closing
from pathlib import Path
from typing import Any

import pandas as pd

from suite.compare.tables import WORLDS
from suite.errors import SuiteError
from suite.experiment.manifest import Manifest
from suite.trial.columns import COLUMNS, CONDITIONS

_EXPERIMENT = (
    "id INTEGER PRIMARY KEY AUTOINCREMENT, name VARCHAR(512), totaltime REAL, timelimit REAL, memorylimit REAL,"
    " runcount INTEGER, version VARCHAR(128), hostname VARCHAR(1024), cpuinfo TEXT, date DATETIME, seed VARCHAR(24),"
    " setup TEXT"
)
_STATUSES = (
    "Unknown status",
    "Invalid start",
    "Invalid goal",
    "Unrecognized goal type",
    "Timeout",
    "Approximate solution",
    "Exact solution",
    "Crash",
)
_STATUS_OF = {"reached": 6, "timeout": 4, "stuck": 4, "collided": 0, "invalid_scenario": 1}
"""Outcomes in OMPL's words; what failed as a program is a crash."""

_PARAMETERS = {"n_obstacles": "INTEGER", "noise_mm": "REAL", "dropout": "REAL", "limits": "INTEGER"}
"""Conditions by which Planner Arena can group and facet."""

_SQL = {"boolean": "BOOLEAN", "Int64": "INTEGER", "float64": "REAL"}
_MEASURED = {
    column.name: _SQL[column.dtype]
    for column in COLUMNS
    if column.dtype in _SQL and column not in CONDITIONS and column.name not in ("trial_seed", "n_obstacles")
}


def write_planner_arena(file: Path, trials: pd.DataFrame, manifest: Manifest, version: str) -> None:
    """Write trials as a database of OMPL's benchmarks.

    Args:
        file: Database to make.
        trials: Frame of trial rows.
        manifest: Of their run.
        version: Of the suite; Planner Arena compares versions.

    Raises:
        SuiteError: The file cannot be written.
    """
    try:
        with closing(sqlite3.connect(file)) as db, db:
            _create(db)
            for key, group in trials.groupby(WORLDS, sort=False, dropna=False):
                world = dict(zip(WORLDS, key, strict=True))
                experiment = _add_experiment(db, world, group, manifest, f"suite {version}")
                _add_runs(db, experiment, group)
    except (OSError, sqlite3.Error) as error:
        raise SuiteError(f"{file}: cannot be written: {error}") from None


def _create(db: sqlite3.Connection) -> None:
    parameters = ", ".join(f"{name} {kind}" for name, kind in _PARAMETERS.items())
    measured = ", ".join(f"{name} {kind}" for name, kind in _MEASURED.items())
    db.execute(f"CREATE TABLE experiments ({_EXPERIMENT}, {parameters})")
    db.execute(
        "CREATE TABLE plannerConfigs (id INTEGER PRIMARY KEY AUTOINCREMENT, name VARCHAR(512) NOT NULL, settings TEXT)"
    )
    db.execute("CREATE TABLE enums (name VARCHAR(512), value INTEGER, description TEXT, PRIMARY KEY (name, value))")
    db.execute(
        "CREATE TABLE runs (id INTEGER PRIMARY KEY AUTOINCREMENT,"
        " experimentid INTEGER, plannerid INTEGER, time REAL, status ENUM, solved BOOLEAN, simplification_time REAL,"
        f" {measured},"
        " FOREIGN KEY (experimentid) REFERENCES experiments(id) ON DELETE CASCADE,"
        " FOREIGN KEY (plannerid) REFERENCES plannerConfigs(id) ON DELETE CASCADE)"
    )
    db.execute(
        "CREATE TABLE progress (runid INTEGER, time REAL, PRIMARY KEY (runid, time),"
        " FOREIGN KEY (runid) REFERENCES runs(id) ON DELETE CASCADE)"
    )
    db.executemany("INSERT INTO enums VALUES ('status', ?, ?)", enumerate(_STATUSES))


def _add_experiment(
    db: sqlite3.Connection, world: Mapping[str, Any], group: pd.DataFrame, manifest: Manifest, version: str
) -> int:
    """Its id."""
    conditions = {name: _plain(value) for name, value in world.items()}
    machine = manifest.get("machine") or {}
    said = [conditions["family"], conditions["family_parameters"], conditions["arm"]]
    values = [
        " ".join(str(part) for part in said if part and part != "default"),
        float(group["trial_wall_s"].sum()),
        0.0,  # planners have budgets of counts, and none of memory
        0.0,
        len(group),
        version,
        str(machine.get("system", "")),
        str(machine.get("processor", "")),
        "1970-01-01 00:00:00",  # rows do not say when they were made
        str(conditions["experiment_seed"]),
        json.dumps({"conditions": conditions, "experiment": manifest.get("experiment")}),
        *(conditions[name] for name in _PARAMETERS),
    ]
    names = "name, totaltime, timelimit, memorylimit, runcount, version, hostname, cpuinfo, date, seed, setup"
    marks = ", ".join("?" * len(values))
    added = db.execute(f"INSERT INTO experiments ({names}, {', '.join(_PARAMETERS)}) VALUES ({marks})", values)
    return int(added.lastrowid or 0)


def _add_runs(db: sqlite3.Connection, experiment: int, group: pd.DataFrame) -> None:
    """A run for each trial, and a configuration for each planner with its settings."""
    names = ", ".join(_MEASURED)
    marks = ", ".join("?" * (6 + len(_MEASURED)))
    for record in group.to_dict("records"):
        row = {str(name): value for name, value in record.items()}
        values = [
            experiment,
            _planner(db, str(row["planner"]), row),
            _plain(row["planning_time_s"]),
            _STATUS_OF.get(str(row["outcome"]), 7),
            row["outcome"] == "reached",
            0.0,
            *(_plain(row[name]) for name in _MEASURED),
        ]
        db.execute(
            f"INSERT INTO runs (experimentid, plannerid, time, status, solved, simplification_time, {names})"
            f" VALUES ({marks})",
            values,
        )


def _planner(db: sqlite3.Connection, label: str, row: Mapping[str, Any]) -> int:
    """Id of the planner's configuration, made if need be."""
    own = json.loads(_plain(row["settings"]) or "{}")
    own |= {"predictor": _plain(row["predictor"]), "prediction_margin": _plain(row["prediction_margin"])}
    settings = "".join(f"{name} = {value}\n;" for name, value in own.items())
    found = db.execute("SELECT id FROM plannerConfigs WHERE name = ? AND settings = ?", [label, settings]).fetchone()
    if found:
        return int(found[0])
    return int(
        db.execute("INSERT INTO plannerConfigs (name, settings) VALUES (?, ?)", [label, settings]).lastrowid or 0
    )


def _plain(value: Any) -> Any:
    """A value that SQLite knows; None for a missing one."""
    if value is None or pd.isna(value):
        return None
    return value.item() if hasattr(value, "item") else value
