"""The comparison on a terminal."""

from __future__ import annotations

from collections.abc import Sequence

import pandas as pd
from rich import box
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from suite.compare.tables import WORLDS
from suite.show.conditions import sentence
from suite.show.text import cells

WIDE = 240
"""Columns of text where there is no terminal to ask; a log must not lose numbers to a guessed width."""


def print_summary(summary: pd.DataFrame) -> None:
    """Print conditions and summary to stdout, with a gap between numbers of obstacles."""
    console = Console()
    if not console.is_terminal or console.width < 1:  # COLUMNS=0
        console = Console(width=WIDE)
    if said := sentence(summary):
        console.print(f"{said}\n", markup=False, highlight=False)
    titles, rows = cells(summary)
    shown = _fitting([titles, *rows], console.width)
    table = Table(box=box.SIMPLE_HEAD, show_edge=False)
    for title in titles[:shown]:
        table.add_column(title, justify="left" if title in {"planner", "family"} else "right", no_wrap=True)
    groups = summary.groupby(WORLDS, sort=False, dropna=False).ngroup().tolist()
    for row, group, following in zip(rows, groups, [*groups[1:], groups[-1]], strict=True):
        # A spec's brackets would be read as markup.
        table.add_row(*map(escape, row[:shown]), end_section=group != following)
    console.print(table)
    if shown < len(titles):
        console.print(f"Not shown for lack of width: {', '.join(titles[shown:])}", highlight=False)


def _fitting(lines: Sequence[Sequence[str]], width: int) -> int:
    """How many of the leading columns, which matter most, fit side by side; at least three do."""
    shown, used = 0, 0
    for column in zip(*lines, strict=True):
        used += max(len(text) for text in column) + 2
        if used > width and shown >= 3:
            break
        shown += 1
    return shown
