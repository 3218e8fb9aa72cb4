"""What every planner owes the suite: for the user's own pytest, and for ``suite check-planner``."""

from planners.conformance import CONFORMANCE_VERSION, Check
from suite.conformance.checks import CHECKS, checks_for, spec_of
from suite.conformance.finding import Finding
from suite.conformance.isolated import run_checks
from suite.conformance.parametrize import parametrize_with_checks

__all__ = [
    "CHECKS",
    "CONFORMANCE_VERSION",
    "Check",
    "Finding",
    "checks_for",
    "parametrize_with_checks",
    "run_checks",
    "spec_of",
]
