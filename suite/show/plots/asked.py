"""What a figure is asked to show, and what comes of it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Literal, NamedTuple

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Spent = Literal["checks", "time"]


class Asked(NamedTuple):
    """The same for every kind; a kind uses what concerns it."""

    over: str | None = None
    """Condition on the axis; the one with most values when None."""
    by: tuple[str, ...] | None = None
    """Conditions that are told apart, all others being pooled; all that vary when None."""
    verdict: str = "swept"
    spent: Spent | None = None
    """Put points where their median trial's checks or planning time is, in place of the condition's value; what a
    profile compares."""
    run: Path | None = None
    """Folder of the run, for kinds that look at more than its rows."""
    scenario: str | None = None
    """Which scenario, for kinds that show one; the first that somebody failed on when None."""


class Drawn(NamedTuple):
    """A figure, and what stands beside it."""

    figure: Figure
    remarks: list[str]
    """What a reader has to know, a sentence each."""
