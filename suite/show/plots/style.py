"""How figures look: a column of a paper wide, in colours that the colour-blind can tell apart and a marker for each."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from suite.errors import SuiteError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

COLUMN_IN = 3.4
"""Width of a column [inch]."""

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000", "#8C6D31")
"""Okabe and Ito's palette (2008) with a brown in place of its yellow, which is too light for lines."""
MARKERS = "os^Dv<>PX*hp"

_RC: dict[Any, Any] = {
    "font.size": 8,
    "axes.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.linewidth": 0.3,
    "grid.alpha": 0.5,
    "lines.linewidth": 1.0,
    "lines.markersize": 4,
    "errorbar.capsize": 2,
    "legend.frameon": False,
    "pdf.fonttype": 42,  # journals refuse the default's fonts
    "svg.hashsalt": "suite",  # equal figures, equal bytes
}

_SHORT = 14
"""Characters of a name of which three stand side by side in the legend."""
_LEGEND_ROW_IN = 0.16

_UNITS = {"m_s": "m/s", "mm": "mm", "rad_s": "rad/s", "rad": "rad", "m": "m", "s": "s"}
_WORDS = {"n_obstacles": "obstacles", "budget": "share of the planner's own budget", "experiment_seed": "seed"}


def words(name: str) -> tuple[str, str]:
    """A condition's name and unit, for people: ``max_speed_m_s`` is ``max speed`` in ``m/s``."""
    unit = next((unit for unit in _UNITS if name.endswith(f"_{unit}")), "")
    return _WORDS.get(name) or name.removesuffix(f"_{unit}").replace("_", " "), _UNITS.get(unit, "")


def axis_label(name: str) -> str:
    """``max speed [m/s]``."""
    text, unit = words(name)
    return f"{text} [{unit}]" if unit else text


def named(name: str, value: object) -> str:
    """``max speed 0.03 m/s``."""
    text, unit = words(name)
    shown = f"{value:g}" if isinstance(value, float) else str(value)
    return f"{text} {shown} {unit}".rstrip()


class Look(NamedTuple):
    """Of a line: no two of the first 24 are alike."""

    color: str
    marker: str
    linestyle: str


def look(position: int) -> Look:
    """Of the line at ``position``, counted from 0."""
    rounds = position // len(COLOURS)
    return Look(COLOURS[position % len(COLOURS)], MARKERS[position % len(MARKERS)], ("-", "--", ":")[rounds % 3])


def legend(figure: Figure, **options: Any) -> None:
    """Name the lines above the panels, in as many columns as their names leave room for; the figure grows by it."""
    handles, labels = figure.axes[0].get_legend_handles_labels()
    longest = max(map(len, labels), default=0)
    columns = 3 if longest <= _SHORT else 2 if longest <= 1.7 * _SHORT else 1
    width_in, height_in = figure.get_size_inches()
    figure.set_size_inches(width_in, height_in + _LEGEND_ROW_IN * math.ceil(len(labels) / columns))
    figure.legend(handles, labels, loc="outside upper center", ncols=columns, fontsize="small", **options)


@contextmanager
def drawing() -> Iterator[None]:
    """Figures made in the block look alike.

    Raises:
        SuiteError: matplotlib is not installed.
    """
    try:
        import matplotlib as mpl
    except ModuleNotFoundError:
        raise SuiteError(
            "plot: found no matplotlib, needed to draw: pip install 'continuum-arm-suite[report]'"
        ) from None
    with mpl.rc_context(_RC):
        yield


def save(figure: Figure, file: Path) -> None:
    """Write a figure in the format of the file's suffix; equal figures give equal bytes.

    Raises:
        SuiteError: The file cannot be written.
    """
    dates = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}}
    draft = file.with_name(f".{file.stem}.draft{file.suffix}")
    try:
        figure.savefig(draft, dpi=200, metadata=dates.get(file.suffix))
        draft.replace(file)
    except OSError as error:
        raise SuiteError(f"{file}: cannot be written: {error.strerror or error}") from None
    finally:
        draft.unlink(missing_ok=True)
