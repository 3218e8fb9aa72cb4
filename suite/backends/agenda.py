"""What a run has left to do, and in which order."""

from __future__ import annotations

from collections import deque
from collections.abc import Collection, Iterator, Sequence

from planners.failure import Failure
from suite.backends.job import Job, Part
from suite.trial.task import TrialResult, TrialTask, failed_trial

HOUSE = ""
"""Owner of the processes in which the house's own planners run."""
TRIES = 3
"""So often a trial or a part of the warm-up, in which its process died, is begun before that counts."""


class Agenda:
    """Hands out the warm-up's parts, each once, and the tasks whose planner has been warmed up somewhere.

    Tasks of a planner that is still being compiled wait, and nobody waits for a planner that hangs there: the others'
    tasks go first. Those of a planner that failed in its warm-up are never handed out, but are ``results`` at once.

    A planner from outside may leave anything behind in its process (threads, limits, closed files, other people's
    functions replaced), so a process that has run one runs no other: it has an owner from then on.
    """

    def __init__(self, job: Job, tasks: Sequence[TrialTask]) -> None:
        """Plan ``tasks``, in this order."""
        self._job = job
        self._outside = {task.spec.label for task in tasks if task.spec.code}
        self._places = {task.key: place for place, task in enumerate(tasks)}
        self._queues: dict[str, deque[TrialTask]] = {HOUSE: deque()}
        for task in tasks:
            self._queues.setdefault(self.owner(task.spec.label), deque()).append(task)
        self._held: dict[str, list[TrialTask]] = {}
        self._not_begun = deque(job.parts)
        self._begun: dict[str, Part] = {}
        self._deaths: dict[str, int] = {}
        self._failures: dict[str | None, Failure] = {}
        self._results: list[tuple[TrialTask, TrialResult]] = []
        self.n_open = len(tasks)
        """Tasks that have no result yet."""

    @property
    def not_begun(self) -> list[Part]:
        """Parts of the warm-up that nobody has begun."""
        return list(self._not_begun)

    @property
    def begun(self) -> list[Part]:
        """Parts of the warm-up that are under way for the first time."""
        return list(self._begun.values())

    def owner(self, label: str | None) -> str:
        """Whom a process belongs to that has run this planner: itself if it is from outside, else ``HOUSE``."""
        return label if label in self._outside and label is not None else HOUSE

    def next_part(self, owner: str = HOUSE) -> Part | None:
        """A part of the warm-up that nobody else is at; for the process of an owner there is none but its own."""
        for part in self._not_begun:
            if owner in {HOUSE, part.planner}:
                self._not_begun.remove(part)
                self._begun[part.name] = part
                return part
        return None

    def next_task(self, owner: str = HOUSE, served: Collection[str] = ()) -> TrialTask | None:
        """The first task whose planner is warm, for a process of ``owner``'s; None if there is none for now.

        A process that belongs to the house may take any, but those of owners who are ``served`` already come last.
        """
        there = [name for name, queue in self._queues.items() if queue and owner in {HOUSE, name}]
        there.sort(key=lambda name: (name in served, self._places[self._queues[name][0].key]))
        return next(filter(None, map(self._next_of, there)), None)

    def has_others(self, owner: str) -> bool:
        """Whether something waits that a process of ``owner``'s may not do."""
        return bool(self._not_begun) or any(queue for name, queue in self._queues.items() if name != owner)

    def _next_of(self, owner: str) -> TrialTask | None:
        cold = {part.planner for part in (*self._not_begun, *self._begun.values())} - {None}
        queue = self._queues[owner]
        while queue:
            task = queue.popleft()
            label = task.spec.label
            if failure := self._failure_of(task):
                self._fail(task, failure)
            elif label in cold:
                self._held.setdefault(label, []).append(task)
            else:
                return task
        return None

    def is_warm(self, part: Part) -> None:
        """Take note that a process has warmed up ``part``."""
        self._settle(part)

    def failed(self, part: Part, failure: Failure) -> None:
        """Take note that ``part`` cannot be warmed up: tasks that need it fail. The first failure counts."""
        if part.planner is not None or part.is_shared:
            self._failures.setdefault(part.planner, failure)
        self._settle(part)

    def died(self, part: Part, failure: Failure) -> None:
        """Take note that the process died that was at ``part``: somebody may have killed it, so it is begun again."""
        self._deaths[part.name] = self._deaths.get(part.name, 0) + 1
        if self._deaths[part.name] >= TRIES:
            self.failed(part, failure)
        elif part.name in self._begun:
            del self._begun[part.name]
            self._not_begun.appendleft(part)

    def lost(self, task: TrialTask, failure: Failure, spent_s: float) -> None:
        """Take note that a task's process died, which need not be its planner's fault: it runs again, a few times."""
        self._deaths[task.key] = self._deaths.get(task.key, 0) + 1
        if self._deaths[task.key] < TRIES:
            self.put_back(task)
        else:
            self.finish(task, failed_trial(task, failure, spent_s))

    def put_back(self, task: TrialTask) -> None:
        """Take back a task that has no result."""
        self._queues[self.owner(task.spec.label)].appendleft(task)

    def give_up_one(self, failure: Failure) -> None:
        """Let the next task fail for want of a process to run it in."""
        for queue in (*self._queues.values(), *self._held.values()):
            if queue:
                task = queue[0]
                del queue[0]
                self._fail(task, failure)
                return

    def finish(self, task: TrialTask, result: TrialResult) -> None:
        """Take the result of a task that was handed out."""
        self.n_open -= 1
        self._results.append((task, result))

    def results(self) -> Iterator[tuple[TrialTask, TrialResult]]:
        """The results since the last call."""
        results, self._results = self._results, []
        return iter(results)

    def _failure_of(self, task: TrialTask) -> Failure | None:
        return self._failures.get(None) or self._failures.get(task.spec.label)

    def _fail(self, task: TrialTask, failure: Failure) -> None:
        self.finish(task, failed_trial(task, failure, 0.0))

    def _settle(self, part: Part) -> None:
        """Let the tasks that wait for ``part`` go on, before all others."""
        self._begun.pop(part.name, None)
        held = self._held.pop(part.planner, []) if part.planner else []
        self._queues[self.owner(part.planner)].extendleft(reversed(held))
