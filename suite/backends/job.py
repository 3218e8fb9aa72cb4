"""What backends are given to do."""

from __future__ import annotations

from collections.abc import Callable, Collection, Generator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple, Protocol

if TYPE_CHECKING:
    from suite.trial.lineup import Tasks
    from suite.trial.task import TrialResult, TrialTask

LEAST_WARM_UP_S = 120.0
"""Compiling a part of the warm-up takes up to ten seconds of processor time; this many make it a hang anywhere."""


class Limits(NamedTuple):
    """What a trial may take in a worker process, before it is killed and recorded as such."""

    hang_s: float = 300.0
    """Wall time [s]: ``planner_hung``. A planner's warm-up has two minutes at the least: it may have to compile."""
    memory_mb: float | None = None
    """Memory beyond what its process had before [MB]: ``planner_memory``; no limit when None."""


@dataclass(frozen=True)
class Part:
    """A part of the warm-up: kernels to compile, or load, and tables to build before a trial may be timed."""

    name: str
    """As shown while it is under way."""
    run: Callable[[], object]
    """Like everything in a job importable by name, and what it carries can be pickled."""
    typical_s: float
    """What it takes with an empty cache, about [s]."""
    planner: str | None = None
    """Label of the planner whose trials alone need it and fail with it; None for what every trial needs."""
    is_shared: bool = True
    """Whether every process needs it before its first trial, else only the first to compile what other parts load."""
    is_outside: bool = False
    """Whether it is of a planner from outside, whose process is for nobody else."""

    @property
    def owner(self) -> str:
        """That planner's label, or empty."""
        return self.planner or "" if self.is_outside else ""


@dataclass(frozen=True)
class Job:
    """How tasks are run."""

    run: Callable[[TrialTask], TrialResult]
    """Called with each task."""
    hang_limit_s: float
    """A task that takes longer is killed and becomes ``planner_hung`` [s]."""
    parts: Sequence[Part] = ()
    """The warm-up; what takes longest and what others are built on comes first."""
    warm_up_limit_s: float = LEAST_WARM_UP_S
    """A part that takes longer is killed and its planner's trials become ``planner_hung`` [s]."""
    memory_limit_mb: float | None = None
    """A task that takes more than its process had before is killed and becomes ``planner_memory`` [MB]."""
    examples: Sequence[TrialTask] = ()
    """A task of every kind that is to run, from which the parts were made; other machines make them anew."""

    def needed_by(self, task: TrialTask) -> list[Part]:
        """What a process has to have warmed up before ``task``."""
        mine = [part for part in self.parts if part.planner == task.spec.label]
        return [part for part in self.parts if part.planner is None and part.is_shared] + mine


OnWarmUp = Callable[[Collection[Part], Collection[Part]], None]
"""Called now and then with the parts under way and those not yet begun, until all have been warmed up."""


class Backend(Protocol):
    """Where trials run."""

    def run(
        self, job: Job, tasks: Tasks, on_warm_up: OnWarmUp | None = None
    ) -> Generator[tuple[TrialTask, TrialResult], None, None]:
        """Run every task and yield each with its result as it finishes; closing the iterator early ends all work.

        Tasks are taken one by one, as work is handed out. What a planner does wrong, in a trial or in its warm-up, is
        in the results of its tasks.
        """
