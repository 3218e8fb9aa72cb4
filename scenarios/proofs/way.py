"""The tip's way: how soon it can be at the goal, obstacles that cannot be passed on the way included.

A tip that arrives at T is, at every t <= T, within v t of where it starts and within v (T - t) of the goal's ball. The
two balls meet in a lens. Where an obstacle covers a whole lens nobody arrives at T, nor earlier.
"""

import numpy as np

from scenarios.proofs import _kernels
from scenarios.proofs.allowance import ARRIVAL_SLACK_M, LATE_S, Allowance
from scenarios.proofs.hulls import Hulls
from scenarios.scenario import Scenario
from scenarios.world import positions

_LOOK_S = 0.05
_MAX_LOOKS = 2_000
_GAIN_S = 1e-3  # what delays arrival by less is left at that
_ROUNDS = 500  # what is not proven by then is left at that too


def earliest_arrival_s(scenario: Scenario, hulls: Hulls, allowance: Allowance) -> float:
    """Time before which no tip that keeps its speed is at the goal [s]; inf when that is after the time limit."""
    tip, goal = scenario.arm.tip(scenario.start), scenario.goal
    arrival_m = scenario.goal_tolerance_m + ARRIVAL_SLACK_M + allowance.stray_m
    way_m = float(np.linalg.norm(goal - tip))
    earliest = max(0.0, (way_m - arrival_m - allowance.stray_m) / allowance.tip_speed_m_s)
    for _ in range(_ROUNDS):
        known = earliest
        earliest = goal_free_s(scenario, hulls, earliest, allowance.stray_m)
        looks = int(np.clip(np.ceil(earliest / _LOOK_S), 1, _MAX_LOOKS)) + 1
        times = np.linspace(0.0, min(earliest, scenario.time_limit_s), looks)
        centers = positions(scenario.obstacles, times)
        earliest = float(
            _kernels.way_blocked_until(
                earliest,
                scenario.time_limit_s + 1.0,
                times,
                centers,
                hulls,
                tip,
                goal,
                allowance.stray_m,
                arrival_m,
                allowance.tip_speed_m_s,
            )
        )
        if earliest < known + _GAIN_S or earliest > scenario.time_limit_s:
            break
    return _or_never(earliest, scenario)


def goal_free_s(scenario: Scenario, hulls: Hulls, from_s: float, stray_m: float) -> float:
    """Time from ``from_s`` on until which some obstacle covers the goal's whole ball [s]; inf: all the time."""
    arrival_m = scenario.goal_tolerance_m + ARRIVAL_SLACK_M + stray_m
    time_s = from_s
    for _ in range(_ROUNDS):
        centers = positions(scenario.obstacles, np.array([time_s]))[0]
        # An obstacle that covers the ball with this much to spare does so for as long as it takes to run so far.
        spared = _kernels.goal_covered_for(scenario.goal, arrival_m, centers, hulls)
        if spared < _GAIN_S or time_s > scenario.time_limit_s:
            break
        time_s += spared
    return _or_never(time_s, scenario)


def _or_never(time_s: float, scenario: Scenario) -> float:
    """``time_s``; inf when that is too late."""
    return time_s if time_s <= scenario.time_limit_s + LATE_S else np.inf
