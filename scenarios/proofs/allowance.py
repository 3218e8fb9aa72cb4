"""What the audit lets pass (docs/audit.md): a proof must hold for everything that could still be called a success.

The numbers are given here once more, since nothing here may know the audit; a test compares them with the audit's own.
"""

from typing import NamedTuple

from scenarios.arm import ContinuumArm

RATE_SLACK = 1e-3
"""A section's bending vector may be faster than its rate by this share."""
SPEED_SLACK = 2e-3
"""The tip may be faster than its speed by this share: what exceeds it is certainly caught."""
ARRIVAL_SLACK_M = 2e-9
"""The tip may be this much farther from the goal than the tolerance; twice the audit's, for rounding."""
LATE_S = 2e-9
"""Arrival may be this much later than the time limit; twice the audit's, for rounding."""
STRAY_RAD = 2e-5
"""How far a bending vector may be from one that keeps the rate: a start that is not quite the scenario's, bends past
the limit, and 10,000 steps of less than a nanosecond, whose rates are not looked at but which move 1e-9 rad at most."""

_ROUNDING = 1.0 + 1e-9


class Allowance(NamedTuple):
    """How fast an arm may be at most, and how far it may stray beyond that, with a success still to its name."""

    rate_rad_s: float
    """Of a section's bending vector."""
    tip_speed_m_s: float
    stray_m: float
    """Of the tip, by ``STRAY_RAD`` of all sections at once."""

    @classmethod
    def of(cls, arm: ContinuumArm) -> "Allowance":
        """The allowance of ``arm``; its tip is no faster than all sections bending alike can make it."""
        rate = arm.max_bend_rate_rad_s * (1.0 + RATE_SLACK) * _ROUNDING
        lever_m = 0.5 * arm.n_sections * arm.length_m  # sum over sections of half of it and of all beyond
        speed = min(arm.max_tip_speed_m_s * (1.0 + SPEED_SLACK) * _ROUNDING, rate * lever_m)
        return cls(rate, speed, STRAY_RAD * lever_m + 1e-9)
