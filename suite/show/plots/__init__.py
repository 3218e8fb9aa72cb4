"""Figures of a run for papers and pages, one kind a file; matplotlib (extra ``report``) is imported when one is drawn.

A kind is a module with ``draw(trials, planners, asked)``, which returns a figure and remarks, and a line in ``KINDS``.
"""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from scenarios.spec import known_name
from suite.errors import SuiteError
from suite.show.plots import curve, paths, profile, times, verdicts
from suite.show.plots.asked import Asked, Drawn
from suite.show.plots.style import drawing, save

KINDS = {
    "curve": curve.draw,
    "times": times.draw,
    "profile": profile.draw,
    "verdicts": verdicts.draw,
    "paths": paths.draw,
}
SUFFIXES = (".png", ".pdf", ".svg")


def plot(kind: str, trials: pd.DataFrame, planners: tuple[str, ...], asked: Asked, file: Path) -> Drawn:
    """Draw a figure into ``file``.

    Args:
        kind: A name in ``KINDS``.
        trials: Frame of trial rows.
        planners: Labels in the order in which they are to appear.
        asked: What the figure is to show.
        file: A name that ends in .png, .pdf or .svg.

    Raises:
        SpecError, SuiteError: There is no such kind or condition, or no matplotlib, or the file can't be written.
    """
    known_name("plot", kind, KINDS)
    if file.suffix not in SUFFIXES:
        raise SuiteError(f"--output: found {str(file)!r}, allowed a file that ends in {', '.join(SUFFIXES)}")
    with drawing():
        drawn = KINDS[kind](trials, planners, asked)
        save(drawn.figure, file)
    return drawn
