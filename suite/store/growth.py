"""What a journal has of what a command asks for: a run grows, and what other code has made is not mixed in."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from scenarios import ContinuumArm
from suite.trial.task import Code, TrialTask


@dataclass
class Standing:
    """How far a run is with what is asked for."""

    chosen: dict[str, Code] = field(default_factory=dict)
    """By the trials' keys, in the order asked for: the code whose row stands, or will stand, for each."""
    done: Counter[str] = field(default_factory=Counter)
    """Trials by planner that have such a row."""
    left: list[int] = field(default_factory=list)
    """The others, by their places in the order asked for."""
    examples: dict[tuple[str, str, ContinuumArm], TrialTask] = field(default_factory=dict)
    """One of those for every planner, predictor and arm among them: what a warm-up has to know."""
    stale: Counter[str] = field(default_factory=Counter)
    """Trials by planner whose rows are of other code of that planner: they run again."""
    kept: int = 0
    """Trials whose rows are of other code and are used as they are."""
    other_houses: Counter[str] = field(default_factory=Counter)
    """Trials whose rows are of another house, by its hash: for the user to decide about."""

    @property
    def there(self) -> int:
        """Trials that have such a row."""
        return self.done.total()

    def notes(self) -> list[str]:
        """What there is to tell the user, a line each."""
        notes = [
            f"{planner}: its code has changed; its {_rows(count)} of before {'is' if count == 1 else 'are'} stale"
            " and run again"
            for planner, count in self.stale.items()
        ]
        if self.kept:
            notes.append(f"{_rows(self.kept)} made by other code {'is' if self.kept == 1 else 'are'} used as they are")
        if 0 < self.there < len(self.chosen):
            notes.append(f"{self.there} of {len(self.chosen)} trials are there already")
        return notes


def settle(tasks: Iterable[TrialTask], made: Mapping[str, Sequence[Code]], *, keep_stale: bool) -> Standing:
    """Choose a row for every task.

    Args:
        tasks: What is asked for, with the code that would run it now.
        made: Which code has made rows of which trial, the latest last.
        keep_stale: Whether a row of other code will do where there is none of the present.
    """
    standing = Standing()
    for place, task in enumerate(tasks):
        codes = made.get(task.key, ())
        code = task.code
        if code in codes:
            standing.done[task.spec.label] += 1
        elif codes and keep_stale:
            code = codes[-1]
            standing.done[task.spec.label] += 1
            standing.kept += 1
        elif any(other.house == code.house for other in codes):
            standing.stale[task.spec.label] += 1
        elif codes:
            standing.other_houses[codes[-1].house] += 1
        standing.chosen[task.key] = code
        if code not in codes:
            standing.left.append(place)
            standing.examples.setdefault((task.spec.label, task.predictor, task.scenario.arm), task)
    return standing


def _rows(count: int) -> str:
    return f"{count} row" if count == 1 else f"{count} rows"
