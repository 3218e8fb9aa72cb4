"""How far a run has come, on stderr: a bar on a terminal, a line now and then elsewhere."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

LINE_EVERY_S = 10.0

Advance = Callable[[str], None]
"""Called after each finished trial with the planner's label."""


@contextmanager
def progress(total: int) -> Iterator[Advance]:
    """Show progress towards ``total`` trials while the block runs; until the first has finished, it warms up."""
    console = Console(stderr=True, highlight=False)
    if not console.is_terminal:
        yield _Lines(console, total)
        return
    with Progress(
        TextColumn("{task.description}", markup=False),  # the brackets of a spec are no markup
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TextColumn("ETA"),
        TimeRemainingColumn(),
        console=console,
        transient=True,
    ) as bar:
        task = bar.add_task("warming up (compiles on first use)", total=total, start=False)

        def advance(label: str) -> None:
            bar.start_task(task)
            bar.update(task, advance=1, description=label)

        yield advance


def note(line: str) -> None:
    """Say something about the run that is no progress."""
    Console(stderr=True).print(f"suite: {line}", markup=False, highlight=False, soft_wrap=True)


class _Lines:
    """Progress for log files."""

    def __init__(self, console: Console, total: int) -> None:
        self._console = console
        self._total = total
        self._done = 0
        self._first_s = self._last_s = 0.0
        console.print(f"{total} trials to run; warming up (compiles on first use)")

    def __call__(self, label: str) -> None:
        del label  # a bar has room for it
        self._done += 1
        now_s = time.monotonic()
        if self._done == 1:
            self._first_s = self._last_s = now_s
        if now_s - self._last_s < LINE_EVERY_S and self._done < self._total:
            return
        self._last_s = now_s
        left_s = (now_s - self._first_s) / max(1, self._done - 1) * (self._total - self._done)
        self._console.print(f"{self._done}/{self._total} trials, about {left_s:.0f} s to go")
