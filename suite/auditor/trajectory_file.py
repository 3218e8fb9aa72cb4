"""Trajectory files from anywhere: untrusted, so checked and bounded."""

from __future__ import annotations

import csv
import io
import re
from array import array
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from scenarios import Scenario
from scenarios.reading import read_text
from suite.auditor.engine import FloatArray
from suite.errors import SuiteError

MAX_FILE_BYTES = 256 * 1024 * 1024
MAX_SECTIONS = 12
NAMES = ("scenario_id", "planner", "time_s")
CONDITION = "condition"
"""A column after the planner's, where one planner has met one scenario under several conditions."""


class Trajectory(NamedTuple):
    """What one planner did on one scenario, as a file claims."""

    scenario: Scenario
    planner: str
    times_s: FloatArray
    """In the order of the file, shape (k,), [s]."""
    configurations_rad: FloatArray
    """Shape (k, dof), [rad]."""


def read_trajectories(file: Path, scenarios: Sequence[Scenario]) -> list[Trajectory]:
    """Read a CSV with columns scenario_id, planner, time_s, u1_rad, v1_rad, ..., one line per timed state.

    Where one planner met one scenario several times, a column ``condition`` after ``planner`` tells them apart.

    Lines of different trajectories may be mixed; within one their order is kept, whatever their times say. ``nan`` and
    ``inf`` are numbers here: judging them is the audit's business. Blank lines are passed over.

    Raises:
        FileError: The file cannot be read or is too large.
        SuiteError: A line does not fit the header or its scenario, or a trajectory begins again.
    """
    known = {scenario.id: scenario for scenario in scenarios}
    numbers: dict[tuple[str, str], array[float]] = {}
    reader = csv.reader(io.StringIO(read_text(file, MAX_FILE_BYTES), newline=""))
    try:
        first = next(reader, [])
        has_condition = first[2:3] == [CONDITION]
        header = _checked_header(file, first[:2] + first[3:] if has_condition else first)
        for cells in reader:
            if not any(map(str.strip, cells)):
                continue
            where = f"{file}: line {reader.line_num}"
            if has_condition and len(cells) > 2:
                cells[1:3] = [f"{cells[1]} {cells[2]}".strip()]
            scenario = _scenario(where, header, cells, known)
            state = _numbers(where, header[2:], cells[2:], 1 + scenario.arm.dof)
            so_far = numbers.setdefault((scenario.id, cells[1]), array("d"))
            if _begins_again(so_far, state):
                name = f"{scenario.id} {cells[1]}"
                raise SuiteError(f"{where}: found {_short(name)} beginning again, allowed once per file")
            so_far.extend(state)
    except csv.Error as error:
        raise SuiteError(f"{file}: not valid CSV: {error}") from None
    if not numbers:
        raise SuiteError(f"{file}: found no timed state, allowed one line per state below the header")
    return [_trajectory(known[name], planner, flat) for (name, planner), flat in numbers.items()]


def _begins_again(so_far: array[float], state: list[float]) -> bool:
    """Whether ``state`` is, after later ones or as a copy, what the trajectory so far began with: it stands twice.

    Time that runs backward to anywhere else is a lie, which is for the audit to date.
    """
    size = len(state)
    is_first_time = len(so_far) > 0 and state[0] == so_far[0]
    return is_first_time and (so_far[-size] > state[0] or so_far[:size] == array("d", state))


def _trajectory(scenario: Scenario, planner: str, flat: array[float]) -> Trajectory:
    table = np.array(flat).reshape(-1, 1 + scenario.arm.dof)
    return Trajectory(scenario, planner, table[:, 0], table[:, 1:])


def _checked_header(file: Path, header: list[str]) -> list[str]:
    sections = (len(header) - len(NAMES)) // 2
    bends = [f"{axis}{section}_rad" for section in range(1, sections + 1) for axis in "uv"]
    if not 1 <= sections <= MAX_SECTIONS or header != [*NAMES, *bends]:
        shown = _short(",".join(header))
        raise SuiteError(f"{file}: line 1: found columns {shown}, allowed {','.join(NAMES)},u1_rad,v1_rad,...")
    return header


def _scenario(where: str, header: list[str], cells: list[str], known: Mapping[str, Scenario]) -> Scenario:
    if len(cells) != len(header):
        raise SuiteError(f"{where}: found {len(cells)} cells, allowed {len(header)} as in the header")
    if cells[0] not in known:
        names = ", ".join([*known][:5]) + (", ..." if len(known) > 5 else "")
        raise SuiteError(f"{where}: scenario_id: found {_short(cells[0])}, allowed a scenario of the file: {names}")
    if not re.fullmatch(r"[ -~]{1,200}", cells[1]):
        raise SuiteError(f"{where}: planner: found {_short(cells[1])}, allowed 1 to 200 plain characters")
    scenario = known[cells[0]]
    if len(NAMES) + scenario.arm.dof > len(header):
        raise SuiteError(
            f"{where}: found columns for {(len(header) - len(NAMES)) // 2} sections, "
            f"allowed at least the {scenario.arm.n_sections} of {scenario.id}"
        )
    return scenario


def _numbers(where: str, names: list[str], cells: list[str], count: int) -> list[float]:
    """The first ``count`` cells; those of sections that the arm does not have must be empty."""
    numbers: list[float] = []
    for name, cell in zip(names, cells, strict=True):
        if len(numbers) == count:
            if cell:
                raise SuiteError(f"{where}: {name}: found {_short(cell)}, allowed nothing: the arm has no such section")
            continue
        try:
            numbers.append(float(cell))
        except ValueError:
            raise SuiteError(f"{where}: {name}: found {_short(cell)}, allowed a number") from None
    return numbers


def _short(text: str) -> str:
    return repr(text if len(text) <= 60 else f"{text[:57]}...")
