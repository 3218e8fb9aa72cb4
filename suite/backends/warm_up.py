"""What has to be compiled or built once before a trial can be timed."""

from __future__ import annotations

from collections.abc import Sequence

from planners import PlannerSpec, warm_up
from scenarios import Scenario, start_is_free
from suite.auditor import audit, collides


def warm_up_trials(specs: Sequence[PlannerSpec], examples: Sequence[Scenario]) -> None:
    """Compile, or load from the cache, everything that a trial calls.

    Args:
        specs: The planners of the trials.
        examples: One scenario for each arm.
    """
    for scenario in examples:
        start_is_free(scenario)
        warm_up(specs, scenario.arm)
        audit(scenario, [0.0, 1.0], [scenario.start, scenario.start])
        collides(scenario, scenario.start, 0.0)
