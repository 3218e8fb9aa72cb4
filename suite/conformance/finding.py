"""What came of a check."""

from __future__ import annotations

from typing import Literal, NamedTuple

IMPORT = "import"
"""What the first finding is about: no check, but whether the planner can be imported at all."""


class Finding(NamedTuple):
    """What came of one check."""

    check: str
    outcome: Literal["ok", "failed", "hung", "died"]
    message: str = ""
    """One line, with file and line: of the planner's own code if it raised, else of the check."""
