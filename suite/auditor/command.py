"""``suite audit``: judge any trajectory against any scenario file, so that a result from elsewhere can be checked."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from scenarios import Scenario, load_scenarios
from suite.auditor.certificate import certified_contacts
from suite.auditor.engine import Engine
from suite.auditor.fcl_engine import sampled_contacts
from suite.auditor.judge import audit
from suite.auditor.points import PointsAudit, audit_points
from suite.auditor.points_file import read_points
from suite.auditor.trajectory_file import Trajectory, read_trajectories
from suite.auditor.verdicts import VERDICTS, Audit, Verdict
from suite.errors import SuiteError

ENGINES: dict[str, Engine] = {"certificate": certified_contacts, "fcl": sampled_contacts}


class Judged(NamedTuple):
    """A trajectory of a file and what the audit says of it."""

    trajectory: Trajectory
    audit: Audit

    @property
    def verdicts(self) -> dict[str, Verdict]:
        """The verdicts by the names in ``VERDICTS``."""
        return {name: getattr(self.audit, name) for name in VERDICTS}

    @property
    def is_sound(self) -> bool:
        """Whether no verdict found a violation."""
        return all(verdict.success for verdict in self.verdicts.values())


class JudgedPoints(NamedTuple):
    """A motion given as backbone points and what the audit says of it."""

    scenario: Scenario
    audit: PointsAudit


def audit_points_file(points: Path, scenarios: Path, scenario_id: str | None) -> JudgedPoints:
    """Judge the motion in a file of backbone points.

    Args:
        points: NPZ of ``time_s``, ``points_m`` and ``radius_m``.
        scenarios: Scenario file.
        scenario_id: Which of its scenarios; the only one when None.

    Raises:
        SuiteError: The points file is wrong, or it is not said which scenario.
        ScenarioError: The scenario file is wrong.
    """
    known = {scenario.id: scenario for scenario in load_scenarios(scenarios)}
    names = ", ".join([*known][:5]) + (", ..." if len(known) > 5 else "")
    if scenario_id is None and len(known) > 1:
        raise SuiteError(f"--scenario: found nothing, allowed one of {scenarios}: {names}")
    if scenario_id is not None and scenario_id not in known:
        raise SuiteError(f"--scenario: found {scenario_id!r}, allowed one of {scenarios}: {names}")
    scenario = known[scenario_id or next(iter(known))]
    return JudgedPoints(scenario, audit_points(scenario, *read_points(points)))


def audit_file(trajectories: Path, scenarios: Path, engine: str = "certificate") -> Iterator[Judged]:
    """Judge every trajectory of a file, in the order in which they begin.

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
        yield Judged(one, audit(one.scenario, one.times_s, one.configurations_rad, ENGINES[engine]))
