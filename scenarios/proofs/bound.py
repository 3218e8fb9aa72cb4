"""What is proven of a scenario: a span of time outside which nobody can arrive."""

from enum import StrEnum
from typing import Literal, NamedTuple


class Reason(StrEnum):
    """What a proof stands on, in the words of result rows."""

    REACH = "reach"
    """The goal is farther from the base than the arm is long."""
    BASE = "base"
    """An obstacle runs over the base, which no arm can move."""
    WAY = "way"
    """The tip cannot be at the goal in time, or wherever it would have to be there is an obstacle."""
    SECTION = "section 1"
    """The first section has nowhere left to go."""
    SECTIONS = "sections 1 and 2"
    """The first two have not."""


class Bound(NamedTuple):
    """Every success arrives at a time in [``earliest_s``, ``latest_s``)."""

    earliest_s: float
    """Nobody arrives before [s]."""
    latest_s: float
    """Nobody arrives at or after this [s]; inf when nothing is proven that the time limit does not say."""
    reason: Reason | None = None
    """Why it is impossible, or why ``latest_s`` is what it is; None when neither is proven."""

    @property
    def outcome(self) -> Literal["impossible", "deadline", "nothing"]:
        """Whether nobody can arrive at all, nobody after some time, or neither is proven."""
        if self.earliest_s >= self.latest_s:
            return "impossible"
        return "deadline" if self.reason else "nothing"

    def tightened(self, reason: Reason, earliest_s: float = 0.0, latest_s: float = float("inf")) -> "Bound":
        """This and what ``reason`` proves, which is named where it brings the deadline forward or the impossibility."""
        both = Bound(max(self.earliest_s, earliest_s), min(self.latest_s, latest_s), self.reason)
        is_settled = both.outcome == "impossible" and self.outcome != "impossible"
        return both._replace(reason=reason) if is_settled or both.latest_s < self.latest_s else both


class Proof(NamedTuple):
    """What is proven of a scenario, one verdict apart from the other."""

    executable: Bound
    """Of motions within the arm's rates, free at every instant."""
    swept: Bound
    """Of motions free at every instant, however fast."""
