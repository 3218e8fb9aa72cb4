"""What an audit finds: three verdicts on one trajectory."""

import math
from enum import StrEnum
from typing import NamedTuple

VERDICTS = ("per_step", "swept", "executable")
"""Names of the three verdicts, each stricter than the one before."""


class Kind(StrEnum):
    """Kinds of violation, in the words of result rows."""

    COLLISION = "collision"
    BEND_RATE = "bend rate"
    TIP_SPEED = "tip speed"
    NOT_FINITE = "not finite"
    WRONG_START = "wrong start"
    BACKWARD_TIME = "backward time"
    JUMP = "jump"
    BEND_LIMIT = "bend limit"
    TIME_LIMIT = "time limit"
    SHORT_OF_GOAL = "short of goal"


class Finding(NamedTuple):
    """A violation."""

    time_s: float
    kind: Kind


class Verdict(NamedTuple):
    """Whether a trajectory succeeds by one definition and, if not, what is wrong first."""

    success: bool
    violation_time_s: float = math.nan
    """Time of the first violation [s]; nan when there is none."""
    violation_kind: str = ""
    """One of ``Kind``; empty when there is none."""


class Contact(NamedTuple):
    """The first touch of arm and obstacles, at any instant."""

    time_s: float
    obstacle: int
    """Which of the scenario's obstacles, counted from 1."""
    section: int
    """Which section of the arm, counted from 1 at the base."""
    is_moving: bool
    """Whether the arm moved on the way there; false where it held still and the obstacle came."""

    @property
    def how(self) -> str:
        """``moving`` or ``holding``."""
        return "moving" if self.is_moving else "holding"


def contact_columns(contact: Contact | None) -> dict[str, int | str | None]:
    """A contact in the columns of a row; None without one."""
    return {
        "contact_obstacle": contact and contact.obstacle,
        "contact_section": contact and contact.section,
        "contact_while": contact and contact.how,
    }


class Audit(NamedTuple):
    """The three verdicts, each stricter than the one before, and what else was measured on the way."""

    per_step: Verdict
    """No collision at any whole second."""
    swept: Verdict
    """No collision at any instant."""
    executable: Verdict
    """Swept, and within the arm's bending rate and tip speed."""
    arrival_time_s: float
    """Time of the first timed state with the tip within the goal tolerance [s]; nan when there is none."""
    min_clearance_m: float
    """Smallest clearance until ``end_time_s``, contacts included [m]; inf without obstacles (docs/audit.md)."""
    end_time_s: float
    """Where the audit ended: at arrival, at the time limit or at the last timed state that can be [s]."""
    contact: Contact | None = None
    """What touched first; None where nothing did."""
