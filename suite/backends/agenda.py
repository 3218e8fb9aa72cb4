"""What a run has left to do, and in which order."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Collection, Iterator
from itertools import chain

from planners.failure import Failure
from suite.backends.job import Job, Part
from suite.trial.lineup import Tasks
from suite.trial.task import TrialResult, TrialTask, failed_trial

HOUSE = ""
"""Owner of the processes in which the house's own planners run."""
TRIES = 3
"""So often a trial or a part of the warm-up, in which its process died, is begun before that counts; a part one time
after the other, with no trial that needs it finished in between."""
LOOK_AHEAD = 5_000
"""So many tasks may wait for warm-ups, or for processes of their own; each takes some 8 KiB of memory."""


class Agenda:
    """Hands out the warm-up's parts, each once, and the tasks whose planner has been warmed up somewhere.

    Tasks of a planner that is still being compiled wait, and nobody waits for a planner that hangs there: the others'
    tasks go first. Those of a planner that failed in its warm-up, or that can't even be imported, are never handed out,
    but are ``results`` at once.

    A planner from outside may leave anything behind in its process (threads, limits, closed files, other people's
    functions replaced), so a process that has run one runs no other: that planner is its owner from then on.
    """

    def __init__(self, job: Job, tasks: Tasks) -> None:
        """Plan ``tasks``, in this order; they are taken one by one, as they are needed."""
        self._job = job
        self._coming: Iterator[TrialTask] = iter(tasks)
        self._aside: dict[str, deque[TrialTask]] = {HOUSE: deque()}
        self._held: dict[str, list[TrialTask]] = {}
        self._not_begun = deque(job.parts)
        self._begun: dict[str, Part] = {}
        self._deaths: dict[str, int] = {}
        self._deaths_in_warm_up: dict[str | None, dict[str, int]] = {}
        """By planner and part."""
        self._failures: dict[str | None, Failure] = {}
        self._results: list[tuple[TrialTask, TrialResult]] = []
        self.n_open = len(tasks)
        """Tasks that have no result yet."""

    def add(self, tasks: Tasks) -> None:
        """Plan more, after all others."""
        self._coming = chain(self._coming, tasks)
        self.n_open += len(tasks)

    @property
    def not_begun(self) -> list[Part]:
        """Parts of the warm-up that nobody has begun."""
        return list(self._not_begun)

    @property
    def begun(self) -> list[Part]:
        """Parts of the warm-up that are under way for the first time."""
        return list(self._begun.values())

    def next_part(self, owner: str = HOUSE) -> Part | None:
        """A part of the warm-up that nobody else is at; for the process of an owner there is none but its own."""
        for part in self._not_begun:
            if owner in {HOUSE, part.owner}:
                self._not_begun.remove(part)
                self._begun[part.name] = part
                return part
        return None

    def next_task(self, owner: str = HOUSE, served: Collection[str] = ()) -> TrialTask | None:
        """The first task whose planner is warm, for a process of ``owner``'s; None if there is none for now.

        A process of the house's may take any, but those of owners who are ``served`` already come last.
        """
        cold = {part.planner for part in (*self._not_begun, *self._begun.values())} - {None}

        def suits(whose: str) -> bool:
            return whose not in served if owner == HOUSE else whose == owner

        while task := self._take(suits) or (self._take(lambda _: True) if owner == HOUSE else None):
            label = task.spec.label
            if failure := self._failure_of(task):
                self._fail(task, failure)
                if len(self._results) >= LOOK_AHEAD:  # to be stored before there are more
                    return None
            elif label in cold:
                self._held.setdefault(label, []).append(task)
                if sum(map(len, self._held.values())) >= LOOK_AHEAD:
                    return None
            else:
                return task
        return None

    def has_others(self, owner: str) -> bool:
        """Whether something waits that a process of ``owner``'s may not do."""
        return bool(self._not_begun) or any(queue for whose, queue in self._aside.items() if whose != owner)

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
        deaths = self._deaths_in_warm_up.setdefault(part.planner, {})
        deaths[part.name] = deaths.get(part.name, 0) + 1
        if deaths[part.name] >= TRIES:
            self.failed(part, failure)
        elif part.name in self._begun:
            del self._begun[part.name]
            self._not_begun.appendleft(part)

    def lost(self, task: TrialTask, failure: Failure, spent_s: float) -> None:
        """Take note that a task's process was killed by somebody else: it runs again, a few times."""
        self._deaths[task.key] = self._deaths.get(task.key, 0) + 1
        if self._deaths[task.key] < TRIES:
            self.put_back(task)
        else:
            self._keep(task, failed_trial(task, failure, spent_s))

    def put_back(self, task: TrialTask) -> None:
        """Take back a task that has no result."""
        self._set_aside(owner_of(task)).appendleft(task)

    def give_up_one(self, failure: Failure) -> None:
        """Let the next task fail for want of a process to run it in."""
        task = self._take(lambda _: True)
        if task is None:
            task = next(held.pop(0) for held in self._held.values() if held)
        self._fail(task, failure)

    def finish(self, task: TrialTask, result: TrialResult) -> None:
        """Take the result of a task that was handed out."""
        for planner in (None, task.spec.label):  # their parts are warm somewhere
            self._deaths_in_warm_up.pop(planner, None)
        self._keep(task, result)

    def results(self) -> Iterator[tuple[TrialTask, TrialResult]]:
        """The results since the last call."""
        results, self._results = self._results, []
        return iter(results)

    def _take(self, suits: Callable[[str], bool]) -> TrialTask | None:
        """The first task whose owner suits and that nobody holds; others on the way to it are set aside."""
        for whose, queue in self._aside.items():
            if queue and suits(whose):
                return queue.popleft()
        while sum(map(len, self._aside.values())) < LOOK_AHEAD and (task := next(self._coming, None)):
            if suits(owner_of(task)):
                return task
            self._set_aside(owner_of(task)).append(task)
        return None

    def _set_aside(self, owner: str) -> deque[TrialTask]:
        return self._aside.setdefault(owner, deque())

    def _failure_of(self, task: TrialTask) -> Failure | None:
        return task.spec.failure or self._failures.get(None) or self._failures.get(task.spec.label)

    def _fail(self, task: TrialTask, failure: Failure) -> None:
        self._keep(task, failed_trial(task, failure, 0.0))

    def _keep(self, task: TrialTask, result: TrialResult) -> None:
        self.n_open -= 1
        self._results.append((task, result))

    def _settle(self, part: Part) -> None:
        """Let the tasks that wait for ``part`` go on, before all others."""
        self._begun.pop(part.name, None)
        held = self._held.pop(part.planner, []) if part.planner else []
        self._set_aside(part.owner).extendleft(reversed(held))


def owner_of(task: TrialTask) -> str:
    """Whom a process belongs to that has run ``task``: its planner if that is from outside, else ``HOUSE``."""
    return task.spec.label if task.spec.code else HOUSE
