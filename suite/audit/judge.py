"""The audit of what was executed, against the obstacles' true motion (docs/audit.md)."""

import math

import numpy as np
import numpy.typing as npt

from scenarios import Scenario
from suite.audit import _kernels
from suite.audit.truth import Truth, pack
from suite.audit.verdicts import Audit, Kind, Verdict

_LIES = {
    _kernels.NOT_FINITE: Kind.NOT_FINITE,
    _kernels.WRONG_START: Kind.WRONG_START,
    _kernels.BACKWARD_TIME: Kind.BACKWARD_TIME,
    _kernels.JUMP: Kind.JUMP,
    _kernels.BEND_LIMIT: Kind.BEND_LIMIT,
}
_EXCESSES = {_kernels.BEND_RATE: Kind.BEND_RATE, _kernels.TIP_SPEED: Kind.TIP_SPEED}

_Finding = tuple[float, str]
"""When and what."""


def audit(scenario: Scenario, times_s: npt.ArrayLike, configurations_rad: npt.ArrayLike) -> Audit:
    """Judge a trajectory, linear in bending vectors between its timed states.

    Nothing after arrival counts. A state that cannot be (a lie) ends the trajectory at the state before it.

    Args:
        scenario: What the trajectory claims to solve.
        times_s: Times of the states, shape (k,), [s].
        configurations_rad: Configurations at these times, shape (k, dof), [rad].

    Raises:
        ValueError: Shapes that do not belong together. Whatever the numbers are, they are judged.
    """
    times = np.ascontiguousarray(times_s, dtype=np.float64)
    states = np.ascontiguousarray(configurations_rad, dtype=np.float64)
    arm = scenario.arm
    if times.ndim != 1 or states.shape != (len(times), arm.dof):
        raise ValueError(f"found shapes {times.shape} and {states.shape}, allowed (k,) and (k, {arm.dof})")

    real, lie = _kernels.first_lie(times, states, scenario.start, arm.max_bend_rad)
    if real == 0:
        return _nothing_real(_LIES[lie] if lie else Kind.WRONG_START)
    times, states = times[:real], states[:real]
    limit = scenario.time_limit_s
    last = _kernels.arrival(times, states, limit, scenario.goal, scenario.goal_tolerance_m, arm.section_length_m)
    arrival = float(times[last]) if last >= 0 else math.nan
    end = arrival if last >= 0 else min(limit, float(times[-1]))
    failure: _Finding | None = None
    if last < 0:
        failure = (end, Kind.TIME_LIMIT if times[-1] >= limit else _LIES.get(lie, Kind.SHORT_OF_GOAL))

    per_step_s, swept_s, clearance = _kernels.contacts(
        times, states, end, arm.section_length_m, arm.radius_m, _truth(scenario)
    )
    excess_s, excess = _kernels.first_excess(
        times, states, end, arm.section_length_m, arm.max_bend_rate_rad_s, arm.max_tip_speed_m_s
    )
    hit, touch = (per_step_s, Kind.COLLISION), (swept_s, Kind.COLLISION)
    return Audit(
        per_step=_verdict(failure, hit),
        swept=_verdict(failure, touch),
        executable=_verdict(failure, touch, (excess_s, _EXCESSES.get(excess, ""))),
        arrival_time_s=arrival,
        min_clearance_m=clearance,
        end_time_s=end,
    )


def collides(scenario: Scenario, q: npt.ArrayLike, time_s: float) -> bool:
    """Whether the arm at ``q`` (dof,) [rad] touches an obstacle at ``time_s`` [s]: the per-step check by itself."""
    state = np.ascontiguousarray(q, dtype=np.float64).reshape(1, -1)
    arm = scenario.arm
    gap = _kernels.look_at(np.array([time_s]), state, time_s, arm.section_length_m, arm.radius_m, _truth(scenario))
    return bool(gap <= 0.0)


def _verdict(failure: _Finding | None, *findings: _Finding) -> Verdict:
    """The earliest finding; what ended the trajectory comes last, since nothing is looked for beyond it."""
    seen = [finding for finding in findings if not math.isnan(finding[0])]
    if seen:
        return Verdict(False, *min(seen, key=lambda finding: finding[0]))
    return Verdict(True) if failure is None else Verdict(False, *failure)


def _nothing_real(kind: Kind) -> Audit:
    failed = Verdict(False, 0.0, kind)
    return Audit(failed, failed, failed, arrival_time_s=math.nan, min_clearance_m=math.nan, end_time_s=0.0)


class _Latest:
    """The last scenario packed: an episode asks about the same one at every step."""

    scenario: Scenario | None = None
    truth: Truth


def _truth(scenario: Scenario) -> Truth:
    if _Latest.scenario is not scenario:
        _Latest.scenario, _Latest.truth = scenario, pack(scenario)
    return _Latest.truth
