"""Whether a scenario can be solved at all: the story of a proof."""

from typing import Literal, get_args

import numpy as np

from scenarios.errors import ScenarioError
from scenarios.proofs.allowance import ARRIVAL_SLACK_M, Allowance
from scenarios.proofs.base import base_hit_s
from scenarios.proofs.bound import Bound, Proof, Reason
from scenarios.proofs.hulls import pack_hulls
from scenarios.proofs.section import tighten_by_section
from scenarios.proofs.sections import tighten_by_sections
from scenarios.proofs.way import earliest_arrival_s, goal_free_s
from scenarios.scenario import Scenario

Effort = Literal["base", "section", "sections"]
"""How far to go: base and way (milliseconds), section 1 (tenths of a second), sections 1 and 2 (minutes)."""


def prove(scenario: Scenario, effort: Effort = "section") -> Proof:
    """Prove that nobody can solve ``scenario``, or nobody after some time, or neither.

    What is proven holds for every planner and every motion that the audit (docs/audit.md) would call a success, its
    tolerances included; docs/possible.md derives it. What is not proven may be possible or not.

    Args:
        scenario: The scenario.
        effort: ``base``, ``section`` or ``sections``; each proves what those before it do, and more.

    Raises:
        ScenarioError: Another effort.
    """
    if effort not in get_args(Effort):
        raise ScenarioError(f"effort: found {effort!r}, allowed {', '.join(get_args(Effort))}")
    hulls = pack_hulls(scenario.obstacles, scenario.arm.radius_m, scenario.time_limit_s)
    allowance = Allowance.of(scenario.arm)
    base_s = base_hit_s(scenario, hulls)
    swept, executable = (
        _within_reach(scenario).tightened(Reason.WAY, earliest_s=earliest).tightened(Reason.BASE, latest_s=base_s)
        for earliest in (
            goal_free_s(scenario, hulls, 0.0, allowance.stray_m),
            earliest_arrival_s(scenario, hulls, allowance),
        )
    )
    if effort != "base" and executable.outcome != "impossible":
        executable = tighten_by_section(scenario, hulls, executable)
    if effort == "sections" and executable.outcome != "impossible":
        executable = tighten_by_sections(scenario, hulls, executable)
    return Proof(executable, swept)


def _within_reach(scenario: Scenario) -> Bound:
    """Nothing, unless the goal is farther from the base than the arm is long."""
    too_far = np.linalg.norm(scenario.goal) > scenario.arm.length_m + scenario.goal_tolerance_m + 2 * ARRIVAL_SLACK_M
    nothing = Bound(0.0, np.inf)
    return nothing.tightened(Reason.REACH, earliest_s=np.inf) if too_far else nothing
