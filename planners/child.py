"""Child processes that run a planner's code and answer on their standard output."""

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TextIO


def command_for(module: str) -> list[str]:
    """The command of a process that runs ``module``'s ``main``.

    Not by way of this process's main script, which may have no guard, and without the folder that the user happens to
    stand in (-P), where a file may hide one of the suite's packages.
    """
    return [sys.executable, "-P", "-c", f"from {module} import main; main()"]


@contextmanager
def answers_alone() -> Iterator[TextIO]:
    """The standard output, for this process's answers; whatever a planner prints goes to the errors instead."""
    with os.fdopen(os.dup(1), "w", encoding="utf-8") as out:
        os.dup2(2, 1)
        yield out
