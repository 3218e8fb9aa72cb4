"""Hold a planner to what every planner owes."""

from __future__ import annotations

import json
from typing import Annotated, Literal

import typer

from suite.cli.options import EXIT_FOUND, within


def check_planner(
    planner: Annotated[str, typer.Argument(help="A planner, such as ./mine.py:Mine or 'rrt[range=3]'.")],
    hang_limit_s: Annotated[float, typer.Option(help="A check that takes longer is killed.")] = 120.0,
    format: Annotated[Literal["terminal", "json"], typer.Option(help="What to print.")] = "terminal",
) -> None:
    """Hold a planner to what every planner owes the suite; exit 1 if it fails a check."""
    from suite.conformance import CONFORMANCE_VERSION, Finding, run_checks

    findings: list[Finding] = []
    for finding in run_checks(planner, within("--hang-limit-s", hang_limit_s, 1, 1e6)):
        if format == "terminal":
            if not findings:
                print(f"{planner}: conformance {CONFORMANCE_VERSION}")
            mark = "ok   " if finding.outcome == "ok" else "FAIL "
            said = f": {finding.message}" if finding.message else ""
            print(f"  {mark} {finding.check}{said}", flush=True)
        findings.append(finding)
    passed = sum(finding.outcome == "ok" for finding in findings)
    if format == "json":
        report = {"planner": planner, "conformance": CONFORMANCE_VERSION, "checks": [f._asdict() for f in findings]}
        print(json.dumps(report, indent=2))
    else:
        print(f"{passed} of {len(findings)} passed")
    if passed < len(findings):
        raise typer.Exit(EXIT_FOUND)
