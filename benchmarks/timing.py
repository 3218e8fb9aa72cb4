"""Times that survive a busy machine, and the table they are printed in."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import NamedTuple

Call = Callable[[], object]


class Line(NamedTuple):
    """One figure of the report."""

    name: str
    value: float
    unit: str
    target: str = ""
    """What it should be, such as ``>= 500``; empty where the figure only explains others."""

    @property
    def verdict(self) -> str:
        """``ok`` or ``missed``, empty without a target."""
        if not self.target:
            return ""
        sign, bound = self.target.split()
        return "ok" if (self.value >= float(bound) if sign == ">=" else self.value <= float(bound)) else "missed"


def seconds_per_call(calls: Sequence[Call], at_least_s: float, rounds: int = 5) -> list[float]:
    """Least CPU time of each call [s], taken in turns, so that whatever else the machine does hits all alike.

    Args:
        calls: What to time; each is called once beforehand.
        at_least_s: Time that each call is repeated for in every round [s].
        rounds: Number of rounds.
    """
    repeats = []
    for call in calls:
        call()
        started, count = time.process_time(), 0
        while count == 0 or time.process_time() - started < at_least_s:
            call()
            count += 1
        repeats.append(count)
    best = [float("inf")] * len(calls)
    for _ in range(rounds):
        for k, call in enumerate(calls):
            started = time.process_time()
            for _ in range(repeats[k]):
                call()
            best[k] = min(best[k], (time.process_time() - started) / repeats[k])
    return best


def cpu_seconds(call: Call) -> float:
    """CPU time of one call [s]."""
    started = time.process_time()
    call()
    return time.process_time() - started


def render(title: str, lines: Sequence[Line]) -> str:
    """A block of the report."""
    rows = [f"{title}"]
    for line in lines:
        row = f"  {line.name:<62} {line.value:>12.4g} {line.unit:<12} {line.target:>10} {line.verdict}"
        rows.append(row.rstrip())
    return "\n".join(rows) + "\n"
