"""The columns of a trial row, declared once.

The journal's table, ``trials.csv``, the frames read back from either and the documentation are all made from
``COLUMNS``. A value that a trial does not have (the arrival time of an arm that never arrived) is None in Python and an
empty cell in files.
"""

from __future__ import annotations

import hashlib
import json
import reprlib
from collections.abc import Callable, Iterable, Mapping
from typing import Any, Literal, NamedTuple

from suite.auditor.verdicts import VERDICTS

DType = Literal["string", "boolean", "Int64", "float64"]
"""Names of the pandas types that can hold a missing value."""

LONGEST_TEXT = 1000
"""Characters of a text that was measured."""

SCHEMA_VERSION = 3
"""Version of the columns below; what an older version lacks is None when its rows are read."""

OUTCOMES = (
    "reached", "collided", "timeout", "stuck", "planner_error", "planner_hung", "planner_memory", "worker_lost",
    "invalid_scenario",
)  # fmt: skip


class Column(NamedTuple):
    """One column of a trial row."""

    name: str
    dtype: DType
    unit: str
    """Physical unit, empty for names, flags and counts."""
    meaning: str
    is_timing: bool = False
    """True for wall-clock readings, the only columns that may differ between two runs of one experiment."""
    since: int = 1
    """Version of the columns in which it appeared."""


WORLD = (
    Column("family_parameters", "string", "", "settings in which the family differs from its defaults", since=2),
    Column("arm", "string", "", "settings in which the arm differs from the default one", since=2),
    Column("limits", "boolean", "", "whether planners had to keep to the arm's motion limits"),
    Column("noise_mm", "float64", "mm", "standard deviation of the noise on observed positions"),
    Column("dropout", "float64", "", "share of observations that were lost"),
    Column("experiment_seed", "Int64", "", "seed of the experiment"),
)
"""Conditions under which every planner of a comparison works."""

OWN = (
    Column("settings", "string", "", "every setting of the planner, as JSON"),
    Column("predictor", "string", "", "predictor of the obstacles' motion that the planner had"),
    Column(
        "prediction_margin", "float64", "", "standard deviations by which its predicted obstacles were grown", since=2
    ),
)
"""Conditions that may differ from planner to planner."""

CONDITIONS = WORLD + OWN
"""What keeps rows of one planner apart in every table."""

SORTED_BY = ("family", "n_obstacles", "scenario_id", "planner", *(column.name for column in CONDITIONS))
"""The order of rows in files, which does not depend on the order in which trials finished."""

IDENTITY = (
    Column("scenario_id", "string", "", "name of the scenario"),
    Column("scenario_hash", "string", "", "hash of the scenario's content"),
    Column("family", "string", "", "generator family of the scenario"),
    Column("n_obstacles", "Int64", "", "number of moving obstacles"),
    Column("planner", "string", "", "planner as it was asked for"),
    *OWN,
    *WORLD,
    Column("trial_seed", "Int64", "", "seed of this trial, derived from experiment seed, scenario and planner"),
    Column("house_code", "string", "", "hash of the suite's sources and of its libraries' versions", since=2),
    Column("planner_code", "string", "", "hash of the planner's own code; house_code for the house's", since=2),
    Column("is_bound", "boolean", "", "whether the planner sees the true future and is no competitor", since=2),
)

VIOLATIONS = tuple(
    column
    for verdict in VERDICTS
    for column in (
        Column(f"violation_{verdict}_time_s", "float64", "s", f"time of the first {verdict} violation"),
        Column(f"violation_{verdict}_kind", "string", "", f"kind of the first {verdict} violation"),
    )
)

MEASURED = (
    Column("outcome", "string", "", "how the trial ended: " + ", ".join(OUTCOMES)),
    Column("success_per_step", "boolean", "", "goal reached with no collision at a whole second"),
    Column("success_swept", "boolean", "", "goal reached with no collision at any instant"),
    Column("success_executable", "boolean", "", "swept, and within the arm's bending rate and tip speed"),
    *VIOLATIONS,
    Column("contact_obstacle", "Int64", "", "obstacle that was touched first at any instant, counted from 1", since=2),
    Column("contact_section", "Int64", "", "section that touched it, counted from 1 at the base", since=2),
    Column("contact_while", "string", "", "whether the arm was moving or holding then", since=2),
    Column("arrival_time_s", "float64", "s", "first timed state with the tip within the goal tolerance"),
    Column("planning_time_s", "float64", "s", "wall time of all solves of the trial", is_timing=True),
    Column("n_solves", "Int64", "", "number of solves"),
    Column("solve_p50_s", "float64", "s", "median wall time of a solve", is_timing=True),
    Column("solve_p95_s", "float64", "s", "95th percentile of the wall time of a solve", is_timing=True),
    Column("solve_max_s", "float64", "s", "longest wall time of a solve", is_timing=True),
    Column("tip_path_length_m", "float64", "m", "length of the executed tip path"),
    Column("smoothness_paper_rad", "float64", "rad", "the paper's smoothness S of what was executed, theta wrapped"),
    Column("smoothness_bending_rad", "float64", "rad", "sum of the changes of the bending vectors"),
    Column("min_clearance_m", "float64", "m", "smallest clearance to a true obstacle, negative in contact"),
    Column("state_checks", "Int64", "", "states checked for validity while planning"),
    Column("motion_checks", "Int64", "", "motions checked for validity while planning"),
    Column("impossible_reason", "string", "", "why nobody can solve the scenario, where a bound failed", since=3),
    Column("impossible_from_s", "float64", "s", "from when on nobody can arrive, where that is why", since=3),
    Column("message", "string", "", "what went wrong, when something did"),
    Column("audit_time_s", "float64", "s", "wall time of the audit", is_timing=True),
    Column("trial_wall_s", "float64", "s", "wall time of the whole trial", is_timing=True),
)

COLUMNS: tuple[Column, ...] = IDENTITY + MEASURED
COLUMN_NAMES = tuple(column.name for column in COLUMNS)
_DTYPES = {column.name: column.dtype for column in COLUMNS}
TIMING_NAMES = frozenset(column.name for column in COLUMNS if column.is_timing)

KEY_NAMES = (
    "scenario_hash",
    "scenario_id",
    "planner",
    "settings",
    "predictor",
    "prediction_margin",
    "limits",
    "noise_mm",
    "dropout",
    "experiment_seed",
)
"""What one trial differs in from another: everything that decides its row, but for the code that makes it."""

Row = dict[str, Any]
"""One trial: a value, or None, for every name in ``COLUMN_NAMES``, in that order."""


def complete_row(values: Mapping[str, Any]) -> Row:
    """Put ``values`` into the order of ``COLUMNS``, with None for what is missing and for NaN.

    Raises:
        KeyError: ``values`` has a name that no column has.
    """
    unknown = sorted(set(values) - set(COLUMN_NAMES))
    if unknown:
        raise KeyError(f"no such column: {', '.join(unknown)}")
    return {column.name: _plain(column.dtype, values.get(column.name)) for column in COLUMNS}


def checked_measurements(values: Mapping[str, Any]) -> Row:
    """The measured columns, if every value is one that its column can hold; counts are not negative.

    Raises:
        ValueError: One is not; the message names the column, what was found and what is allowed.
    """
    if values.get("outcome") not in OUTCOMES:
        raise ValueError(f"outcome: found {reprlib.repr(values.get('outcome'))}, allowed {', '.join(OUTCOMES)}")
    for column in MEASURED:
        value = values.get(column.name)
        if not (value is None or value != value or _IS_HELD[column.dtype](value)):
            raise ValueError(f"{column.name}: found {reprlib.repr(value)}, allowed {_ALLOWED[column.dtype]}")
    return {column.name: _plain(column.dtype, values.get(column.name)) for column in MEASURED}


def _is_storable(value: Any) -> bool:
    if not isinstance(value, str) or len(value) > LONGEST_TEXT or "\0" in value:
        return False
    try:
        value.encode()
    except UnicodeEncodeError:
        return False
    return True


def plain_values(name: str, values: Iterable[Any]) -> list[Any]:
    """Values of the column ``name`` as ``complete_row`` makes them, many rows at once.

    Raises:
        ValueError, TypeError: A value is not of the column's type.
    """
    kind = _PLAIN_TYPES[_DTYPES[name]]
    return [None if value is None or value != value else kind(value) for value in values]


def trial_key(row: Mapping[str, Any]) -> str:
    """32 hexadecimal digits that stand for ``KEY_NAMES`` of a row."""
    values = [_plain(_DTYPES[name], row[name]) for name in KEY_NAMES]
    return hashlib.sha256(json.dumps(values).encode()).hexdigest()[:32]


def _plain(dtype: DType, value: Any) -> str | bool | int | float | None:
    """Turn a NumPy or Python scalar into the plain Python value that a column of this type holds."""
    if value is None or value != value:  # NaN is the only value that differs from itself
        return None
    return _PLAIN_TYPES[dtype](value)


_IS_HELD: dict[DType, Callable[[Any], bool]] = {
    "string": _is_storable,
    "boolean": lambda value: isinstance(value, bool),
    "Int64": lambda value: type(value) is int and 0 <= value < 2**63,
    "float64": lambda value: isinstance(value, int | float),
}
_ALLOWED: dict[DType, str] = {
    "string": f"at most {LONGEST_TEXT} characters that can be stored",
    "boolean": "true or false",
    "Int64": "a whole number from 0 to 2**63 - 1",
    "float64": "a number",
}

_PLAIN_TYPES: dict[DType, Callable[[Any], str | bool | int | float]] = {
    "string": str,
    "boolean": bool,
    "Int64": int,
    "float64": float,
}
