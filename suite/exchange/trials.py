"""Trials of a run as tables of other tools."""

from __future__ import annotations

import os
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import pandas as pd

from suite.errors import SuiteError
from suite.exchange.planner_arena import write_planner_arena
from suite.experiment.code import DISTRIBUTION
from suite.store.run_folder import read_manifest


def write_planner_arena_of(folder: Path, trials: pd.DataFrame, file: Path) -> None:
    """Write a database of OMPL's benchmarks; it takes its place when it is whole.

    Raises:
        SuiteError: The file cannot be written.
    """
    draft = file.with_name(f".{file.name}.{os.getpid()}.tmp")
    try:
        write_planner_arena(draft, trials, read_manifest(folder) or {}, _version())
        draft.replace(file)
    except OSError as error:
        raise SuiteError(f"{file}: cannot be written: {error.strerror}") from None
    finally:
        draft.unlink(missing_ok=True)


def write_parquet(trials: pd.DataFrame, file: Path) -> None:
    """Write trials as parquet, with the columns and types of ``trials.csv``.

    Raises:
        SuiteError: No library for parquet is installed, or the file cannot be written.
    """
    try:
        trials.to_parquet(file, index=False)
    except ImportError:
        raise SuiteError(
            "parquet: found neither pyarrow nor fastparquet, allowed with one: pip install pyarrow"
        ) from None
    except OSError as error:
        raise SuiteError(f"{file}: cannot be written: {error.strerror}") from None


def _version() -> str:
    try:
        return version(DISTRIBUTION)
    except PackageNotFoundError:
        return "0.0.0"
