"""How far a run has come, on stderr: a bar on a terminal, a line now and then elsewhere."""

from __future__ import annotations

import sys
import time
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from rich.progress import Progress, TaskID

LINE_EVERY_S = 10.0
SOON_S = 2.0
"""A wait shorter than this is not talked about."""
LOADED_SHARE = 0.1
"""A part that took less than this share of its typical time had been compiled before."""
LEAST_SHARE = 0.2
"""Parts under way that have taken long already are taken to need this share of their time still."""


LATE = 5.0
"""Parts that take more than so many times what they should are said to be late."""


class Warming(Protocol):
    """A part of the warm-up."""

    @property
    def name(self) -> str:
        """As shown while it is under way."""

    @property
    def typical_s(self) -> float:
        """What it takes to compile, about [s]."""


class Reporter(Protocol):
    """Told how a run goes on."""

    def __call__(self, label: str) -> None:
        """A trial of this planner has finished."""

    def warm_up(self, running: Collection[Warming], waiting: Collection[Warming]) -> None:
        """These parts of the warm-up are under way, and these not yet begun; called now and then until all are done."""


@contextmanager
def progress(total: int, *, quiet: bool = False) -> Iterator[Reporter]:
    """Show progress towards ``total`` trials while the block runs, unless it is to be ``quiet``."""
    if quiet:
        yield _Silence()
        return
    if not sys.stderr.isatty():
        yield _Lines(total)
        return
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )

    with Progress(
        TextColumn("{task.description}", markup=False),  # the brackets of a spec are no markup
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TextColumn("ETA"),
        TimeRemainingColumn(),
        console=Console(stderr=True, highlight=False),
        transient=True,
    ) as bar:
        yield _Bar(bar, bar.add_task("loading", total=total, start=False))


class Compilation:
    """How long the warm-up still takes, from what its parts typically take and how fast compiling has been here."""

    def __init__(self) -> None:
        """Begin now."""
        self._started_s = time.monotonic()
        self._running: dict[str, tuple[float, float]] = {}
        self._spent_s = self._typical_s = 0.0

    def sentence(self, running: Collection[Warming], waiting: Collection[Warming]) -> str:
        """What is being compiled and for how long; empty as long as it may be a matter of loading."""
        now_s = time.monotonic()
        names = [part.name for part in running]
        for name, (begun_s, typical_s) in list(self._running.items()):
            if name not in names:
                del self._running[name]
                if now_s - begun_s > LOADED_SHARE * typical_s:
                    self._spent_s, self._typical_s = self._spent_s + now_s - begun_s, self._typical_s + typical_s
        for part in running:
            self._running.setdefault(part.name, (now_s, part.typical_s))
        if not running or now_s - self._started_s < SOON_S:
            return ""
        pace = self._spent_s / self._typical_s if self._typical_s else 1.0
        left_s = sum(max(pace * t - (now_s - begun_s), LEAST_SHARE * pace * t) for begun_s, t in self._running.values())
        left_s += sum(pace * part.typical_s for part in waiting)
        late_s = min(now_s - begun_s for begun_s, _ in self._running.values())
        if not waiting and late_s > LATE * max(pace * typical_s for _, typical_s in self._running.values()):
            return f"warming up: {', '.join(names)}; {late_s:.0f} s so far, longer than usual: it may hang"
        others = f" and {len(waiting)} more" if waiting else ""
        return f"compiling, once: {', '.join(names)}{others}; about {left_s / len(running):.0f} s to go"


class _Silence:
    """No progress."""

    def __call__(self, label: str) -> None:
        pass

    def warm_up(self, running: Collection[Warming], waiting: Collection[Warming]) -> None:
        pass


class _Bar:
    """Progress on a terminal."""

    def __init__(self, bar: Progress, task: TaskID) -> None:
        self._bar, self._task = bar, task
        self._compilation = Compilation()

    def __call__(self, label: str) -> None:
        self._bar.start_task(self._task)
        self._bar.update(self._task, advance=1, description=label)

    def warm_up(self, running: Collection[Warming], waiting: Collection[Warming]) -> None:
        if sentence := self._compilation.sentence(running, waiting):
            self._bar.update(self._task, description=sentence)


def note(line: str) -> None:
    """Say something about the run that is no progress."""
    sys.stderr.write(f"suite: {line}\n")


class _Lines:
    """Progress for log files."""

    def __init__(self, total: int) -> None:
        self._total = total
        self._done = 0
        self._first_s = 0.0
        self._last_s = time.monotonic() - LINE_EVERY_S
        self._compilation = Compilation()
        _say(f"{total} trials to run")

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
        _say(f"{self._done}/{self._total} trials, about {left_s:.0f} s to go")

    def warm_up(self, running: Collection[Warming], waiting: Collection[Warming]) -> None:
        sentence = self._compilation.sentence(running, waiting)
        if sentence and time.monotonic() - self._last_s >= LINE_EVERY_S:
            self._last_s = time.monotonic()
            _say(sentence)


def _say(line: str) -> None:
    sys.stderr.write(line + "\n")
    sys.stderr.flush()
