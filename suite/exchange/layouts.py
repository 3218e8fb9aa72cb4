"""Layouts of recorded tracks: a table of our own, TUM, ETH/UCY and Motive, told apart by what stands in them."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import NamedTuple

from scenarios.reading import read_text
from suite.errors import SuiteError
from suite.exchange.text import MAX_FILE_BYTES, number

MAX_BODIES = 1000
UNITS_M = {"mm": 1e-3, "cm": 1e-2, "m": 1.0}


class Sample(NamedTuple):
    """Where a body was seen; NaN in ``point`` where it was looked for and not seen."""

    body: str
    time_s: float
    point: tuple[float, float, float]
    """In the file's unit."""
    radius: float = math.nan
    """In the file's unit; NaN where the file does not say."""


class Recording(NamedTuple):
    """What a file holds."""

    layout: str
    samples: list[Sample]
    unit: str | None
    """Unit that the file itself names, a key of ``UNITS_M``."""


Reader = Callable[[Path, str, float], Recording]


def read_recording(file: Path, layout: str, fps: float) -> Recording:
    """Read the samples of a file.

    Args:
        file: The file.
        layout: A key of ``LAYOUTS``, or ``auto``.
        fps: Frames per second of layouts that count frames.

    Raises:
        FileError: The file cannot be read.
        SuiteError: A line does not fit its layout.
    """
    text = read_text(file, MAX_FILE_BYTES)
    reader = LAYOUTS[recognised(file, text) if layout == "auto" else layout]
    try:
        recording = reader(file, text, fps)
    except csv.Error as error:
        raise SuiteError(f"{file}: not valid CSV: {error}") from None
    if not any(math.isfinite(sample.point[0]) for sample in recording.samples):
        raise SuiteError(f"{file}: found no position in it, allowed one per line")
    return recording


def recognised(file: Path, text: str) -> str:
    """The layout's name, from the first lines that say anything.

    Raises:
        SuiteError: It is none that is known.
    """
    lines = [line for line in text.splitlines()[:200] if line.strip() and not line.lstrip().startswith("#")]
    first = lines[0] if lines else ""
    if first.startswith("Format Version"):
        return "motive"
    if "," in first and {"id", "t", "x", "y", "z"} <= {cell.strip().lower() for cell in first.split(",")}:
        return "table"
    cells = first.split()
    if len(cells) == 8 and _is_unit([float(cell) for cell in cells[4:] if _is_number(cell)]):
        return "tum"
    if len(cells) in (4, 8) and all(map(_is_number, cells)):
        return "eth"
    raise SuiteError(
        f"{file}: found {first[:60]!r}, allowed a header with id,t,x,y,z or the layouts {', '.join(LAYOUTS)}"
    )


def _table(file: Path, text: str, fps: float) -> Recording:
    """A CSV with columns id, t, x, y, z and perhaps radius, in any order; t in seconds."""
    reader = csv.reader(io.StringIO(text))
    header = [cell.strip().lower() for cell in next(reader, [])]
    missing = [name for name in ("id", "t", "x", "y", "z") if name not in header]
    if missing:
        raise SuiteError(f"{file}: line 1: found no column {missing[0]}, allowed id,t,x,y,z and perhaps radius")
    at = {name: header.index(name) for name in ("id", "t", "x", "y", "z", "radius") if name in header}
    samples = []
    for cells in reader:
        if any(map(str.strip, cells)):
            where = f"{file}: line {reader.line_num}"
            if len(cells) != len(header):
                raise SuiteError(f"{where}: found {len(cells)} cells, allowed {len(header)} as in the header")
            value = {name: number(f"{where}: {name}", cells[k]) for name, k in at.items() if name != "id"}
            point = value["x"], value["y"], value["z"]
            samples.append(Sample(cells[at["id"]].strip(), value["t"], point, value.get("radius", math.nan)))
    return Recording("table", samples, None)


def _tum(file: Path, text: str, fps: float) -> Recording:
    """``timestamp tx ty tz qx qy qz qw`` of one body, called like the file."""
    found = [Sample(file.stem, t, (x, y, z)) for _, (t, x, y, z, *_) in _columns(file, text, (8,))]
    return Recording("tum", found, None)


def _eth(file: Path, text: str, fps: float) -> Recording:
    """``frame id x y``, or as in obsmat.txt ``frame id x z y vx vz vy`` with z upward."""
    samples = []
    for _, values in _columns(file, text, (4, 8)):
        x, y, z = (values[2], values[3], 0.0) if len(values) == 4 else (values[2], values[4], values[3])
        samples.append(Sample(f"{values[1]:g}", values[0] / fps, (x, y, z)))
    return Recording("eth", samples, None)


def _motive(file: Path, text: str, fps: float) -> Recording:
    """Rigid bodies of an export from Motive, or its markers where there are none; a frame without numbers is unseen."""
    lines = list(csv.reader(io.StringIO(text)))
    about = dict(zip(lines[0][::2], lines[0][1::2], strict=False)) if lines else {}
    start = next((k for k, cells in enumerate(lines) if cells and cells[0].strip() == "Frame"), None)
    kinds = next((cells for cells in lines[:start] if {"Rigid Body", "Marker"} & set(cells)), None)
    if start is None or kinds is None or start < 2:
        raise SuiteError(f"{file}: found no header with Rigid Body or Marker and Frame, allowed an export from Motive")
    names, what, axes = lines[lines.index(kinds) + 1], lines[start - 1], lines[start]
    kind = "Rigid Body" if "Rigid Body" in kinds else "Marker"
    bodies: dict[str, dict[str, int]] = {}
    for k, axis in enumerate(axes):
        if k < min(len(kinds), len(names), len(what)) and kinds[k] == kind and what[k] == "Position":
            bodies.setdefault(names[k], {})[axis] = k
    whole = {name: at for name, at in bodies.items() if set(at) >= {"X", "Y", "Z"}}
    samples = []
    for line, cells in enumerate(lines[start + 1 :], start=start + 2):
        if any(map(str.strip, cells)):
            where = f"{file}: line {line}"
            if len(cells) < 2 or not cells[1].strip():
                raise SuiteError(f"{where}: found no time, allowed Frame, Time (Seconds), ...")
            t = number(f"{where}: time", cells[1])
            for name, at in whole.items():
                x, y, z = (number(f"{where}: {name}", cells[k]) if k < len(cells) else math.nan for k in at.values())
                samples.append(Sample(name, t, (x, y, z)))
    unit = {"Meters": "m", "Centimeters": "cm", "Millimeters": "mm"}.get(about.get("Length Units", ""))
    return Recording("motive", samples, unit)


LAYOUTS: dict[str, Reader] = {"table": _table, "tum": _tum, "eth": _eth, "motive": _motive}


def _columns(file: Path, text: str, allowed: Iterable[int]) -> Iterator[tuple[int, list[float]]]:
    """Numbers in columns parted by blanks, as many in every line; lines that begin with # say nothing."""
    count = None
    for line, content in enumerate(text.splitlines(), start=1):
        cells = content.split()
        if not cells or cells[0].startswith("#"):
            continue
        count = count or len(cells)
        if len(cells) != count or count not in allowed:
            raise SuiteError(
                f"{file}: line {line}: found {len(cells)} columns, allowed {' or '.join(map(str, allowed))}"
            )
        yield line, [number(f"{file}: line {line}", cell) for cell in cells]


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _is_unit(quaternion: list[float]) -> bool:
    return len(quaternion) == 4 and abs(math.hypot(*quaternion) - 1.0) < 1e-3
