"""The audit of what was executed, against the obstacles' true motion (docs/audit.md)."""

import math

import numpy as np
import numpy.typing as npt

from scenarios import Scenario
from suite.auditor.certificate import certified_contacts
from suite.auditor.engine import Contacts, Engine, FloatArray
from suite.auditor.motion import arrival, first_excess, first_lie
from suite.auditor.verdicts import Audit, Contact, Finding, Kind, Verdict


def audit(
    scenario: Scenario,
    times_s: npt.ArrayLike,
    configurations_rad: npt.ArrayLike,
    engine: Engine = certified_contacts,
) -> Audit:
    """Judge a trajectory, linear in bending vectors between its timed states.

    Nothing after arrival counts. A state that cannot be (a lie) ends the trajectory at the state before it.

    Args:
        scenario: What the trajectory claims to solve.
        times_s: Times of the states, shape (k,), [s].
        configurations_rad: Configurations at these times, shape (k, dof), [rad].
        engine: What looks for contacts.

    Raises:
        ValueError: Shapes that do not belong together. Whatever the numbers are, they are judged.
    """
    times = np.ascontiguousarray(times_s, dtype=np.float64)
    states = np.ascontiguousarray(configurations_rad, dtype=np.float64)
    arm = scenario.arm
    if times.ndim != 1 or states.shape != (len(times), arm.dof):
        raise ValueError(f"found shapes {times.shape} and {states.shape}, allowed (k,) and (k, {arm.dof})")

    count, lie = first_lie(scenario, times, states)
    if count == 0:
        return _nothing_real(lie)
    times, states = times[:count], states[:count]
    arrival_s = arrival(scenario, times, states)
    end_s = min(scenario.time_limit_s, float(times[-1])) if arrival_s is None else arrival_s
    failure = None
    if arrival_s is None:
        out_of_time = times[-1] >= scenario.time_limit_s
        failure = Finding(end_s, Kind.TIME_LIMIT if out_of_time else lie or Kind.SHORT_OF_GOAL)

    contacts = engine(scenario, times, states, end_s)
    hit, touch = _collision(contacts.per_step_s), _collision(contacts.swept_s)
    return Audit(
        per_step=_verdict(hit, failure),
        swept=_verdict(touch, failure),
        executable=_verdict(touch, first_excess(scenario, times, states, end_s), failure),
        arrival_time_s=math.nan if arrival_s is None else arrival_s,
        min_clearance_m=contacts.min_clearance_m,
        end_time_s=end_s,
        contact=_contact(contacts, times, states),
    )


def _contact(found: Contacts, times: FloatArray, states: FloatArray) -> Contact | None:
    """What touched first; the interval in which or at whose end it did says whether the arm was moving."""
    if math.isnan(found.swept_s):
        return None
    before = int(times.searchsorted(found.swept_s, "left")) - 1
    is_moving = before >= 0 and bool((states[before] != states[min(before + 1, len(states) - 1)]).any())
    return Contact(found.swept_s, found.obstacle + 1, found.section + 1, is_moving)


def _collision(time_s: float) -> Finding | None:
    return None if math.isnan(time_s) else Finding(time_s, Kind.COLLISION)


def _verdict(*findings: Finding | None) -> Verdict:
    """The earliest finding, and of several at one instant the first."""
    found = [finding for finding in findings if finding is not None]
    if not found:
        return Verdict(success=True)
    return Verdict(False, *min(found, key=lambda finding: finding.time_s))


def _nothing_real(lie: Kind | None) -> Audit:
    failed = Verdict(False, 0.0, lie or Kind.WRONG_START)
    return Audit(failed, failed, failed, arrival_time_s=math.nan, min_clearance_m=math.nan, end_time_s=0.0)
