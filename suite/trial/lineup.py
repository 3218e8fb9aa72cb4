"""Trials to run, too many to be held in memory at once."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Protocol

from suite.trial.task import TrialTask


class Tasks(Protocol):
    """Tasks in a fixed order: a list, or a ``Lineup``."""

    def __len__(self) -> int:
        """How many there are."""

    def __iter__(self) -> Iterator[TrialTask]:
        """All of them."""


class Lineup:
    """Tasks that are made anew in every pass: with its scenario, a task takes some 8 KiB for as long as it is held."""

    def __init__(self, make: Callable[[], Iterable[TrialTask]], places: Sequence[int]) -> None:
        """Of the tasks that ``make`` makes those at ``places``, which ascend from 0."""
        self._make, self._places = make, places

    def __len__(self) -> int:
        """How many there are."""
        return len(self._places)

    def __iter__(self) -> Iterator[TrialTask]:
        """All of them, made as the iterator goes on."""
        places = iter(self._places)
        wanted = next(places, None)
        for place, task in enumerate(self._make()):
            if place == wanted:
                yield task
                wanted = next(places, None)

    def at(self, places: Sequence[int]) -> Lineup:
        """Those at ``places`` among these."""
        return Lineup(self._make, [self._places[place] for place in places])
