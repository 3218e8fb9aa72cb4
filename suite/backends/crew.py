"""Workers and what they are at: a hang or a crash of a planner costs one trial, never the run.

Every worker holds one piece of work at a time, so it is always known what a dead or late one had. In a pool with a
shared queue a planner that takes its process down at once can pass for one that hangs.
"""

from __future__ import annotations

from collections.abc import Generator, Sequence
from dataclasses import replace
from multiprocessing.connection import wait

from planners.failure import Failure
from suite.backends.agenda import HOUSE, Agenda, owner_of
from suite.backends.job import Job, OnWarmUp, Part
from suite.backends.local import in_warm_up, run_task, warm_up, within
from suite.backends.process import LOOK_EVERY_S, PENDING, Bloated, Dead, Garbled, Late, WorkerProcess
from suite.backends.worker import Unreadable
from suite.trial.lineup import Tasks
from suite.trial.task import RowError, TrialResult, TrialTask, checked_result, failed_trial

STARTS = 3
"""So many workers that die one after the other while they start, with none that works, cost a trial."""
TELL_EVERY_S = 1.0
PRINTED = "\n--- printed in the trial ---\n"
"""Between a traceback and what a planner has printed."""


class _Worker:
    """A process, what it is at and what it has warmed up."""

    def __init__(self, process: WorkerProcess) -> None:
        self.process = process
        self.part: Part | None = None
        self.task: TrialTask | None = None
        self.warm: set[str] = set()
        self.owner = HOUSE
        """The planner from outside that alone may run here, once it has."""


class Crew:
    """Works off one job's tasks with a number of workers."""

    def __init__(
        self,
        started: Sequence[WorkerProcess],
        workers: int,
        job: Job,
        tasks: Tasks,
        on_warm_up: OnWarmUp | None,
    ) -> None:
        """Begin with the processes that were ``started``."""
        self._crew = [_Worker(process) for process in started]
        self._n_workers = workers
        self._job, self._bare_job = job, replace(job, parts=())
        self._agenda = Agenda(job, tasks)
        self._on_warm_up = on_warm_up
        self._failed_starts = 0

    def run(self) -> Generator[tuple[TrialTask, TrialResult], None, None]:
        """Yield every task with its result as it finishes; afterwards there may be more to ``add`` and to run."""
        agenda = self._agenda
        while agenda.n_open:
            self._hand_out()
            self._tell()
            yield from agenda.results()  # workers have gone on: the caller may take its time to store them
            if agenda.n_open:
                for worker in self._due():
                    self._settle(worker)
        yield from agenda.results()

    def add(self, tasks: Tasks) -> None:
        """Have more tasks run, by workers that are warm."""
        self._agenda.add(tasks)

    def close(self) -> None:
        """Kill the workers, whatever they are at."""
        for worker in self._crew:
            worker.process.kill()

    def _hand_out(self) -> None:
        """Give every worker that is at nothing something to do, and start more while there are tasks for them."""
        for worker in list(self._crew):
            if worker.process.is_asked:
                continue
            if worker.task is None and (part := self._agenda.next_part(worker.owner)):
                self._warm_up(worker, part)
                continue
            served = {other.owner for other in self._crew} - {HOUSE}
            worker.task = worker.task or self._agenda.next_task(worker.owner, served)
            if worker.task is None and worker.owner != HOUSE and self._agenda.has_others(worker.owner):
                worker.process.kill()
                self._crew.remove(worker)
            elif worker.task is not None:
                cold = [part for part in self._job.needed_by(worker.task) if part.name not in worker.warm]
                if cold:
                    self._warm_up(worker, cold[0])
                else:
                    self._run(worker, worker.task)
        # While others work, each of their trials pays for a few starts more: none is made in an endless haste.
        may_start = self._failed_starts < STARTS or not self._crew
        while may_start and len(self._crew) < min(self._n_workers, self._agenda.n_open):
            self._crew.append(_Worker(WorkerProcess()))

    def _warm_up(self, worker: _Worker, part: Part) -> None:
        worker.part, worker.owner = part, worker.owner or part.owner
        worker.process.ask(warm_up, part, limit_s=self._job.warm_up_limit_s)

    def _run(self, worker: _Worker, task: TrialTask) -> None:
        worker.owner = worker.owner or owner_of(task)
        limit_s, limit_mb = self._job.hang_limit_s, self._job.memory_limit_mb
        worker.process.ask(run_task, self._bare_job, task, limit_s=limit_s, memory_limit_mb=limit_mb)

    def _tell(self) -> None:
        if self._on_warm_up is not None:
            self._on_warm_up(self._agenda.begun, self._agenda.not_begun)

    def _due(self) -> list[_Worker]:
        """Wait until a worker has something to say or is late; return those, none if the warm-up takes its time."""
        if not any(worker.process.is_asked for worker in self._crew):
            return []
        patience_s = min(worker.process.patience_s for worker in self._crew)
        if self._agenda.begun:
            patience_s = min(patience_s, TELL_EVERY_S)
        handles = [handle for worker in self._crew for handle in worker.process.handles]
        talking = wait(handles, timeout=None if patience_s == float("inf") else patience_s)
        due_s = 0.0 if self._job.memory_limit_mb is None else LOOK_EVERY_S
        return [w for w in self._crew if w.process.patience_s <= due_s or not {*w.process.handles}.isdisjoint(talking)]

    def _settle(self, worker: _Worker) -> None:
        """Take note of what a worker has done, or of what became of it."""
        is_idle, spent_s, answer = not worker.process.is_asked, worker.process.spent_s, worker.process.answer()
        if answer is PENDING:
            return
        if not worker.process.is_alive:
            self._crew.remove(worker)
        if worker.part is not None:
            self._settle_part(worker, worker.part, answer)
        elif worker.task is not None:
            task, worker.task = worker.task, None
            self._settle_task(worker, task, answer, spent_s)
        elif answer is None:
            self._failed_starts = 0
        elif not is_idle:  # it died or was killed while it started
            self._failed_starts += 1
            if self._failed_starts >= STARTS and not self._crew:
                self._failed_starts = 0
                failure = _failure(answer, worker.process.log())
                message = f"no worker process could start: {failure.message}"
                self._agenda.give_up_one(failure._replace(outcome="worker_lost", message=message))

    def _settle_task(self, worker: _Worker, task: TrialTask, answer: object, spent_s: float) -> None:
        log = worker.process.log()
        if isinstance(answer, TrialResult):
            try:
                self._agenda.finish(task, with_log(checked_result(task, answer), log))
                self._failed_starts = 0
                return
            except RowError as error:
                answer = Failure("planner_error", str(error))
        failure = _failure(answer, log)
        if failure.outcome == "worker_lost":
            self._agenda.lost(task, failure, spent_s)
        else:
            self._agenda.finish(task, failed_trial(task, failure, spent_s))

    def _settle_part(self, worker: _Worker, part: Part, answer: object) -> None:
        worker.part = None
        if answer is None:
            worker.warm.add(part.name)
            self._agenda.is_warm(part)
            return
        failure = within(in_warm_up(part), _failure(answer, worker.process.log()))
        if isinstance(answer, Dead):
            self._agenda.died(part, failure)
        else:
            self._agenda.failed(part, failure)
        if worker.task is not None:
            self._agenda.put_back(worker.task)
            worker.task = None


def _failure(answer: object, log: str) -> Failure:
    """What an answer that is no result means for the planner; what it has printed goes with it."""
    match answer:
        case Failure():
            return answer._replace(traceback=joined(answer.traceback, log))
        case Late(limit_s):
            outcome, message = "planner_hung", f"killed after {limit_s:g} s"
        case Bloated(limit_mb):
            outcome, message = "planner_memory", f"killed for taking more than {limit_mb:g} MB"
        case Dead(cause):
            outcome = "worker_lost" if answer.is_from_outside else "planner_error"
            message = f"the process died: {cause}"
        case Garbled(message):
            outcome, message = "planner_error", f"its process answered with something else: {message}"
        case Unreadable(message):
            outcome, message = "planner_error", f"cannot be sent to a worker process: {message}"
        case _:
            outcome, message = "planner_error", f"found {type(answer).__name__} for a result"
    return Failure(outcome, message, joined("", log))


def with_log(result: TrialResult, log: str) -> TrialResult:
    """The result with what was printed in its trial."""
    return result._replace(traceback=joined(result.traceback, log))


def joined(traceback: str, log: str) -> str:
    """What is kept of a trial in words."""
    return f"{traceback}{PRINTED}{log}" if log else traceback
