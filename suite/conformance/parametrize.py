"""A decorator for the user's own pytest, in the manner of scikit-learn's of the same name."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, TypeVar

from planners import ArmPlanner, PlannerSpec
from scenarios.spec import known_name
from suite.conformance.checks import CHECKS, checks_for, spec_of

_Test = TypeVar("_Test", bound=Callable[..., Any])
Reasons = Mapping[str, str]
"""Names of checks that are known to fail, and why."""


def parametrize_with_checks(
    planners: Sequence[str | type[ArmPlanner]],
    *,
    expected_failed_checks: Reasons | Callable[[PlannerSpec], Reasons] | None = None,
) -> Callable[[_Test], _Test]:
    """Make a test of every planner and every check that concerns it.

    The test takes ``planner`` and ``check`` and calls ``check(planner)``. Planners are imported here, but nothing is
    checked before the tests run.

    Args:
        planners: Specs (``"./mine.py:Mine[gain=2]"``, ``"rrt"``) or planner classes.
        expected_failed_checks: Checks known to fail with the reason, or a function that gives them for a planner. They
            are strict: one that passes fails its test.

    Raises:
        SpecError: Unknown planner, setting or name of a check.
        ImportError: There is no pytest.
    """
    import pytest

    return pytest.mark.parametrize(
        ("planner", "check"),
        [
            pytest.param(
                spec,
                check,
                id=f"{spec.label}-{check.__name__}",
                marks=[pytest.mark.xfail(reason=reasons[check.__name__], strict=True)]
                if check.__name__ in reasons
                else [],
            )
            for spec, reasons in _expected(planners, expected_failed_checks or {})
            for check in checks_for(spec)
        ],
    )


def _expected(
    planners: Sequence[str | type[ArmPlanner]], expected: Reasons | Callable[[PlannerSpec], Reasons]
) -> Iterator[tuple[PlannerSpec, Reasons]]:
    """Every planner with the checks it is expected to fail."""
    known = [check.__name__ for check in CHECKS]
    for spec in map(spec_of, planners):
        reasons = expected(spec) if callable(expected) else expected
        for name in reasons:
            known_name("check", name, known)
        yield spec, reasons
