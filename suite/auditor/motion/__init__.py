"""What there is to say of a motion without a look at the obstacles: states that cannot be, arrival, limits."""

from scenarios import Scenario
from suite.auditor.engine import FloatArray
from suite.auditor.motion import _kernels
from suite.auditor.verdicts import Finding, Kind

_KINDS = {
    _kernels.NOT_FINITE: Kind.NOT_FINITE,
    _kernels.WRONG_START: Kind.WRONG_START,
    _kernels.BACKWARD_TIME: Kind.BACKWARD_TIME,
    _kernels.JUMP: Kind.JUMP,
    _kernels.BEND_LIMIT: Kind.BEND_LIMIT,
    _kernels.BEND_RATE: Kind.BEND_RATE,
    _kernels.TIP_SPEED: Kind.TIP_SPEED,
}


def first_lie(scenario: Scenario, times_s: FloatArray, states: FloatArray) -> tuple[int, Kind | None]:
    """Number of timed states before the first that cannot be, and what is wrong with that one."""
    if not len(times_s):
        return 0, Kind.WRONG_START
    count, lie = _kernels.first_lie(times_s, states, scenario.start, scenario.arm.max_bend_rad)
    return count, _KINDS.get(lie)


def arrival(scenario: Scenario, times_s: FloatArray, states: FloatArray) -> float | None:
    """Time [s] of the first timed state, within the time limit, whose tip is within the goal tolerance."""
    index = _kernels.arrival(
        times_s,
        states,
        scenario.time_limit_s,
        scenario.goal,
        scenario.goal_tolerance_m,
        scenario.arm.section_length_m,
    )
    return None if index < 0 else float(times_s[index])


def first_excess(scenario: Scenario, times_s: FloatArray, states: FloatArray, end_s: float) -> Finding | None:
    """Where by ``end_s`` a section first bends faster, or the tip moves faster, than the arm can; None is a proof."""
    arm = scenario.arm
    time_s, excess = _kernels.first_excess(
        times_s, states, end_s, arm.section_length_m, arm.max_bend_rate_rad_s, arm.max_tip_speed_m_s
    )
    return None if excess == _kernels.OK else Finding(time_s, _KINDS[excess])
