"""Which trials go to a cluster together, and what becomes of those that do not come back."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterator, Mapping
from itertools import count
from typing import NamedTuple

from planners.failure import Failure
from suite.backends.agenda import TRIES
from suite.trial.lineup import Tasks
from suite.trial.task import TrialResult, TrialTask, failed_trial

AIM_S = 45.0
"""A chunk is made to take about as long: short beside a run, long beside what handing it out takes."""
FIRST = 4
"""Trials in a chunk as long as nobody knows how long one takes."""
MOST = 2_000
"""Trials in a chunk, however short they are."""
PACE_SHARE = 0.3
"""Weight of the latest chunk in the time that a trial is taken to need."""


class Chunk(NamedTuple):
    """Trials that are handed out together."""

    number: int
    """A new one each time that something is handed out."""
    tasks: tuple[TrialTask, ...]


class Chunks:
    """Hands out tasks in chunks and takes back what has come of them.

    A chunk that is lost, with its node or by a planner that takes more than its own process down, goes again trial by
    trial, so that a killer does not condemn its neighbours. A trial that is lost a few times is ``worker_lost``.
    """

    def __init__(self, tasks: Tasks) -> None:
        """Plan ``tasks``, in this order; they are taken as they are needed."""
        self._coming = iter(tasks)
        self._again: deque[TrialTask] = deque()
        self._alone: deque[TrialTask] = deque()
        self._losses: dict[str, int] = {}
        self._results: list[tuple[TrialTask, TrialResult]] = []
        self._numbers = count()
        self._trial_s: float | None = None
        self._out = 0
        self.n_open = len(tasks)
        """Tasks that have no result yet."""

    def next_chunk(self, slots: int) -> Chunk | None:
        """The next tasks for one of so many slots of the cluster; None when all are handed out."""
        if self._alone:
            return self._handed_out([self._alone.popleft()])
        tasks: list[TrialTask] = []
        size = self._size(slots)
        while len(tasks) < size and (task := self._again.popleft() if self._again else next(self._coming, None)):
            if task.spec.failure:
                self._finish(task, failed_trial(task, task.spec.failure, 0.0))
            else:
                tasks.append(task)
        return self._handed_out(tasks) if tasks else None

    def came_back(self, chunk: Chunk, results: Mapping[int, TrialResult]) -> None:
        """Take the results of a chunk by their tasks' places in it; what was not begun is handed out again."""
        self._out -= len(chunk.tasks)
        if not results:
            self._lose(chunk, "nothing came back")
            return
        for place, task in enumerate(chunk.tasks):
            if place in results:
                self._finish(task, results[place])
            else:
                self._again.append(task)
        times = [result.row["trial_wall_s"] or 0.0 for result in results.values()]
        mean_s, before_s = sum(times) / len(times), self._trial_s
        self._trial_s = mean_s if before_s is None else before_s + PACE_SHARE * (mean_s - before_s)

    def lost(self, chunk: Chunk, why: str) -> None:
        """Take note that nothing will come back."""
        self._out -= len(chunk.tasks)
        self._lose(chunk, why)

    def results(self) -> Iterator[tuple[TrialTask, TrialResult]]:
        """The results since the last call."""
        results, self._results = self._results, []
        return iter(results)

    def _size(self, slots: int) -> int:
        """How many tasks take as long as a chunk is to take; towards the end fewer, so that all slots end together."""
        if self._trial_s is None:
            return FIRST
        share = math.ceil((self.n_open - self._out) / (2 * slots))
        return max(1, min(MOST, share, int(AIM_S / max(self._trial_s, 1e-3))))

    def _handed_out(self, tasks: list[TrialTask]) -> Chunk:
        self._out += len(tasks)
        return Chunk(next(self._numbers), tuple(tasks))

    def _lose(self, chunk: Chunk, why: str) -> None:
        if len(chunk.tasks) > 1:
            self._alone.extend(chunk.tasks)
            return
        (task,) = chunk.tasks
        self._losses[task.key] = self._losses.get(task.key, 0) + 1
        if self._losses[task.key] < TRIES:
            self._alone.append(task)
        else:
            self._finish(task, failed_trial(task, Failure("worker_lost", f"{TRIES} times: {why}"), 0.0))

    def _finish(self, task: TrialTask, result: TrialResult) -> None:
        self.n_open -= 1
        self._results.append((task, result))
