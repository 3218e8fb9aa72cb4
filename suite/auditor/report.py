"""What the audit of a file found, in words or as rows with full numbers; the names are those of ``trials.csv``."""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Callable, Iterable, Iterator
from typing import Any

from suite.auditor.command import Judged, JudgedPoints
from suite.auditor.verdicts import VERDICTS, Contact, Verdict, contact_columns

COLUMNS = (
    "scenario_id",
    "scenario_hash",
    "planner",
    *(f"success_{name}" for name in VERDICTS),
    *(f"violation_{name}_{what}" for name in VERDICTS for what in ("time_s", "kind")),
    "arrival_time_s",
    "min_clearance_m",
    "contact_obstacle",
    "contact_section",
    "contact_while",
    "end_time_s",
)


def as_text(found: Iterable[Judged]) -> Iterator[str]:
    """A line for people per trajectory."""
    for one in found:
        verdicts = ", ".join(f"{name.replace('_', ' ')} {_words(verdict)}" for name, verdict in one.verdicts.items())
        arrival_s = one.audit.arrival_time_s
        arrival = "never arrives" if math.isnan(arrival_s) else f"arrives at {arrival_s:.3f} s"
        clearance = f"clearance {1000.0 * one.audit.min_clearance_m:.2f} mm"
        touch = _touch(one.audit.contact)
        yield f"{one.trajectory.scenario.id} {one.trajectory.planner}: {verdicts}; {arrival}; {clearance}{touch}"


def as_csv(found: Iterable[Judged]) -> Iterator[str]:
    """A header and a row per trajectory; cells of what there is not are empty."""
    yield _csv_line(COLUMNS)
    for one in found:
        yield _csv_line(["" if value is None else value for value in _row(one).values()])


def as_json(found: Iterable[Judged]) -> Iterator[str]:
    """A list of objects, one a line; null for what there is not, and for the clearance where there are no obstacles."""
    before = "["
    for one in found:
        row = {name: None if value == math.inf else value for name, value in _row(one).items()}
        yield before + json.dumps(row, allow_nan=False)
        before = ","
    yield "]"


FORMATS: dict[str, Callable[[Iterable[Judged]], Iterator[str]]] = {"text": as_text, "json": as_json, "csv": as_csv}


def points_as_text(one: JudgedPoints) -> Iterator[str]:
    """A line for people."""
    found = one.audit
    verdicts = f"per step {_words(found.per_step)}, swept {_words(found.swept)}"
    arrival_s = found.arrival_time_s
    arrival = "never arrives" if math.isnan(arrival_s) else f"arrives at {arrival_s:.3f} s"
    touch = f"; segment {found.contact_segment} touches obstacle {found.contact_obstacle} first"
    clearance = f"clearance {1000.0 * found.min_clearance_m:.2f} mm"
    yield f"{one.scenario.id}: {verdicts}; {arrival}; {clearance}{touch if found.contact_obstacle else ''}"


def points_as_csv(one: JudgedPoints) -> Iterator[str]:
    """A header and a row; cells of what there is not are empty."""
    row = _points_row(one)
    yield _csv_line(row)
    yield _csv_line(["" if value is None else value for value in row.values()])


def points_as_json(one: JudgedPoints) -> Iterator[str]:
    """One object; null for what there is not, and for the clearance where there are no obstacles."""
    row = {name: None if value == math.inf else value for name, value in _points_row(one).items()}
    yield json.dumps(row, allow_nan=False)


POINTS_FORMATS: dict[str, Callable[[JudgedPoints], Iterator[str]]] = {
    "text": points_as_text,
    "json": points_as_json,
    "csv": points_as_csv,
}


def _points_row(one: JudgedPoints) -> dict[str, Any]:
    found = one.audit
    values: dict[str, Any] = {"scenario_id": one.scenario.id, "scenario_hash": one.scenario.content_hash}
    for name, verdict in (("per_step", found.per_step), ("swept", found.swept)):
        values[f"success_{name}"] = verdict.success
        values[f"violation_{name}_time_s"] = verdict.violation_time_s
        values[f"violation_{name}_kind"] = str(verdict.violation_kind) or None
    for name in ("arrival_time_s", "min_clearance_m", "contact_obstacle", "contact_segment", "end_time_s"):
        values[name] = getattr(found, name)
    return {name: None if value != value else value for name, value in values.items()}


def _row(one: Judged) -> dict[str, Any]:
    """Values in the order of ``COLUMNS``, None for nan and for no violation."""
    verdicts = one.verdicts
    values: dict[str, Any] = {
        "scenario_id": one.trajectory.scenario.id,
        "scenario_hash": one.trajectory.scenario.content_hash,
        "planner": one.trajectory.planner,
        "arrival_time_s": one.audit.arrival_time_s,
        "min_clearance_m": one.audit.min_clearance_m,
        "end_time_s": one.audit.end_time_s,
        **contact_columns(one.audit.contact),
    }
    for name, verdict in verdicts.items():
        values[f"success_{name}"] = verdict.success
        values[f"violation_{name}_time_s"] = verdict.violation_time_s
        values[f"violation_{name}_kind"] = str(verdict.violation_kind) or None
    return {name: None if values[name] != values[name] else values[name] for name in COLUMNS}


def _touch(contact: Contact | None) -> str:
    if contact is None:
        return ""
    return f"; section {contact.section} touches obstacle {contact.obstacle} first, while {contact.how}"


def _csv_line(cells: Iterable[object]) -> str:
    line = io.StringIO()
    csv.writer(line, lineterminator="").writerow(cells)
    return line.getvalue()


def _words(verdict: Verdict) -> str:
    return "ok" if verdict.success else f"{verdict.violation_kind} at {verdict.violation_time_s:.3f} s"
