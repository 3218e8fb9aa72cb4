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
from suite.show.text import cells, pair_cells

WIDE = 240
"""Columns of text where there is no terminal to ask; a log must not lose numbers to a guessed width."""


NARROW = 80
"""Columns of a terminal that says it has none, as ``COLUMNS=0`` does."""


def print_summary(summary: pd.DataFrame, names: Sequence[str] | None = None) -> None:
    """Print conditions and summary to stdout, with a gap between numbers of obstacles; some columns where named."""
    titles, rows = cells(summary, names)
    if said := sentence(summary):
        console().print(f"{said}\n", markup=False, highlight=False)
    _print_table(titles, rows, summary.groupby(WORLDS, sort=False, dropna=False).ngroup().tolist())


def print_pairs(pairs: pd.DataFrame) -> None:
    """Print a comparison in pairs to stdout."""
    titles, rows = pair_cells(pairs)
    same = titles.index("reference")  # one for all
    console().print(f"In pairs against {rows[0][same] if rows else 'nobody'}:\n", markup=False, highlight=False)
    kept = [titles[:same] + titles[same + 1 :], *(row[:same] + row[same + 1 :] for row in rows)]
    _print_table(kept[0], kept[1:], [0] * len(rows))


def console() -> Console:
    """Standard output, as wide as it is."""
    found = Console()
    if not found.is_terminal:
        return Console(width=WIDE)
    return found if found.width > 0 else Console(width=NARROW)


def _print_table(titles: list[str], rows: list[list[str]], groups: list[int]) -> None:
    """Print what fits, and say what does not; a line between rows of unlike groups."""
    out = console()
    shown = _fitting([titles, *rows], out.width)
    table = Table(box=box.SIMPLE_HEAD, show_edge=False)
    for title in titles[:shown]:
        table.add_column(title, justify="left" if title in {"planner", "family"} else "right", no_wrap=True)
    for row, group, following in zip(rows, groups, [*groups[1:], *groups[-1:]], strict=True):
        # A spec's brackets would be read as markup.
        table.add_row(*map(escape, row[:shown]), end_section=group != following)
    out.print(table)
    if shown < len(titles):
        out.print(f"Not shown for lack of width: {', '.join(titles[shown:])}", highlight=False)


def _fitting(lines: Sequence[Sequence[str]], width: int) -> int:
    """How many of the leading columns, which matter most, fit side by side; at least three do."""
    shown, used = 0, 0
    for column in zip(*lines, strict=True):
        used += max(len(text) for text in column) + 3  # a blank at either side and one between
        if used > width and shown >= 3:
            break
        shown += 1
    return shown
