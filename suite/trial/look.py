"""What a planner believed and answered at one step: told to whoever watches a trial."""

from typing import NamedTuple

from planners import Plan
from scenarios import SampledWorld


class Look(NamedTuple):
    """One step of a trial."""

    now_s: float
    expected: SampledWorld
    """The obstacles' spheres as predicted at the latest look, which its ``start_s`` tells, grown by the margin."""
    plan: Plan | None
    """The planner's answer; None where the path of an earlier one went on."""
