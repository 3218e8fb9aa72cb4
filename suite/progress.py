"""How far a run has come, on stderr: a bar on a terminal, a line now and then elsewhere."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Protocol

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

LINE_EVERY_S = 10.0


class Advance(Protocol):
    """Called after each finished trial with what it was."""

    def __call__(self, what: str) -> None:
        """Count one more."""


@contextmanager
def progress(total: int) -> Iterator[Advance]:
    """Show progress towards ``total`` trials while the block runs."""
    console = Console(stderr=True)
    if not console.is_terminal:
        yield _Lines(console, total)
        return
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TextColumn("ETA"),
    )
    with Progress(*columns, TimeRemainingColumn(), console=console, transient=True) as bar:
        task = bar.add_task("trials", total=total)

        def advance(what: str) -> None:
            bar.update(task, advance=1, description=what)

        yield advance


class _Lines:
    """Progress for log files."""

    def __init__(self, console: Console, total: int) -> None:
        self._console = console
        self._total = total
        self._done = 0
        self._started_s = self._last_s = time.monotonic()

    def __call__(self, what: str) -> None:
        self._done += 1
        now_s = time.monotonic()
        if now_s - self._last_s < LINE_EVERY_S and self._done < self._total:
            return
        self._last_s = now_s
        left_s = (now_s - self._started_s) / self._done * (self._total - self._done)
        self._console.print(f"{self._done}/{self._total} trials, {left_s:.0f} s to go", highlight=False)
