"""``suite audit``: judge any trajectory against any scenario file, so that a result from elsewhere can be checked."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path

from scenarios import load_scenarios
from suite.auditor.certificate import certified_contacts
from suite.auditor.engine import Engine
from suite.auditor.fcl_engine import sampled_contacts
from suite.auditor.judge import audit
from suite.auditor.trajectory_file import Trajectory, read_trajectories
from suite.auditor.verdicts import VERDICTS, Audit, Contact, Verdict
from suite.errors import SuiteError

ENGINES: dict[str, Engine] = {"certificate": certified_contacts, "fcl": sampled_contacts}


def audit_file(trajectories: Path, scenarios: Path, engine: str = "certificate") -> Iterator[str]:
    """Judge every trajectory of a file; one line each, in the order in which they begin.

    Args:
        trajectories: CSV with columns scenario_id, planner, time_s, u1_rad, v1_rad, ...
        scenarios: Scenario file that has every scenario named there.
        engine: A key of ``ENGINES``.

    Raises:
        SuiteError: The trajectory file or the engine's name is wrong.
        ScenarioError: The scenario file is wrong.
    """
    if engine not in ENGINES:
        raise SuiteError(f"--engine: found {engine!r}, allowed {', '.join(ENGINES)}")
    for one in read_trajectories(trajectories, load_scenarios(scenarios)):
        yield _line(one, audit(one.scenario, one.times_s, one.configurations_rad, ENGINES[engine]))


def _line(trajectory: Trajectory, judged: Audit) -> str:
    verdicts = ", ".join(f"{field.replace('_', ' ')} {_words(getattr(judged, field))}" for field in VERDICTS)
    arrival = "never arrives" if math.isnan(judged.arrival_time_s) else f"arrives at {judged.arrival_time_s:.3f} s"
    clearance = f"clearance {1000.0 * judged.min_clearance_m:.2f} mm"
    return f"{trajectory.scenario.id} {trajectory.planner}: {verdicts}; {arrival}; {clearance}{_touch(judged.contact)}"


def _touch(contact: Contact | None) -> str:
    if contact is None:
        return ""
    how = "moving" if contact.is_moving else "holding"
    return f"; section {contact.section} touches obstacle {contact.obstacle} first, while {how}"


def _words(verdict: Verdict) -> str:
    return "ok" if verdict.success else f"{verdict.violation_kind} at {verdict.violation_time_s:.3f} s"
