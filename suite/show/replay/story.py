"""A trial in sentences: what happened, when, and what the planner had believed."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np
import numpy.typing as npt

from planners import Plan
from scenarios import STEP_S, Scenario, clearances
from scenarios.world import obstacles_at
from suite.show.replay.again import Played
from suite.trial.columns import Row
from suite.trial.look import Look

_STILL_RAD = 1e-9
_NOTABLE_S = 2.0
_ENDINGS = {
    "planner_error": "failed as a program",
    "planner_hung": "hung and was stopped",
    "worker_lost": "took its process down",
    "invalid_scenario": "was not asked: the start is hit while the obstacles are observed",
}
_EXCESS = {"bend rate": "bends a section faster than the arm can", "tip speed": "moves its tip faster than the arm can"}


def story(scenario: Scenario, played: Played) -> list[str]:
    """Sentences, the most telling first."""
    return list(_sentences(scenario, played))


def holds(played: Played) -> list[tuple[float, float]]:
    """Intervals in which the arm stood still [s], those that follow one another as one."""
    times, states = played.executed.times_s, played.executed.configurations_rad
    still = np.abs(np.diff(states, axis=0)).max(axis=1, initial=0.0) <= _STILL_RAD
    found: list[tuple[float, float]] = []
    for k in np.flatnonzero(still):
        begin, end = float(times[k]), float(times[k + 1])
        if found and found[-1][1] == begin:
            begin = found.pop()[0]
        found.append((begin, end))
    return found


def _sentences(scenario: Scenario, played: Played) -> Iterator[str]:
    row = played.row
    touch_s = row["violation_swept_time_s"] if row["violation_swept_kind"] == "collision" else None
    if row["outcome"] in _ENDINGS:
        yield f"The planner {_ENDINGS[row['outcome']]}: {row['message'] or 'it left no message'}."
    if touch_s is not None:
        yield f"{_touch(row, touch_s)}."
        if row["success_per_step"] and row["arrival_time_s"] is not None:
            yield "Between whole seconds only: per step the trial counts as a success."
        yield from _belief(scenario, played, touch_s)
    elif row["outcome"] in ("stuck", "timeout"):
        yield f"It did not reach the goal within {scenario.time_limit_s:g} s."
    if row["arrival_time_s"] is not None and touch_s is None:
        yield f"It reached the goal at {row['arrival_time_s']:.2f} s; {_clearance(row)}."
    kind, since_s = row["violation_executable_kind"], row["violation_executable_time_s"]
    if kind in _EXCESS:
        yield f"At {since_s:.2f} s it {_EXCESS[kind]}: not executable."
    yield from _standing(played)


def _touch(row: Row, touch_s: float) -> str:
    if row["contact_obstacle"] is None:  # rows of the first version
        return f"At {touch_s:.2f} s the arm touched an obstacle"
    how = "while the arm was moving" if row["contact_while"] == "moving" else "which was holding still"
    return f"At {touch_s:.2f} s obstacle {row['contact_obstacle']} touched section {row['contact_section']}, {how}"


def _clearance(row: Row) -> str:
    least = row["min_clearance_m"]
    return (
        "there was nothing to touch" if least is None or not np.isfinite(least) else f"clearance {1e3 * least:.1f} mm"
    )


def _belief(scenario: Scenario, played: Played, touch_s: float) -> Iterator[str]:
    """What the latest look before the touch expected of it, and whether the planner could have known."""
    looks = [look for look in played.looks if look.now_s <= touch_s]
    if not looks or played.row["contact_obstacle"] is None:
        return
    expected, j = looks[-1].expected, int(played.row["contact_obstacle"]) - 1
    centers, _ = obstacles_at(expected, touch_s)
    error_m = float(np.linalg.norm(centers[j] - scenario.obstacles[j].position(np.array([touch_s]))[0]))
    yield (
        f"The planner had looked at {expected.start_s:g} s and expected obstacle {j + 1} at"
        f" {1e3 * error_m:.1f} mm from where it then was."
    )
    last_s = expected.start_s + expected.step_s * (len(expected.centers_m) - 1)
    if touch_s > last_s + 1e-9:
        yield f"Its prediction ended at {last_s:g} s: of what came later it had not thought."
    elif all(obstacle.shape is None for obstacle in scenario.obstacles):
        yield from _consequence(scenario, played, looks[-1], touch_s)


def _consequence(scenario: Scenario, played: Played, look: Look, touch_s: float) -> Iterator[str]:
    """How near the arm came, by the planner's own belief, from the touch to the end of that step."""
    end_s = min(math.floor(touch_s / STEP_S + 1e-9) * STEP_S + STEP_S, float(played.executed.times_s[-1]))
    times = np.linspace(touch_s, max(end_s, touch_s), 50)
    states = np.stack([configuration_at(played, time) for time in times])
    if not scenario.arm.within_bends(states).all():
        return
    left_m = clearances(scenario.arm, states, times, look.expected)
    worst = int(left_m.argmin())
    if left_m[worst] > 0:
        yield f"By its own belief {1e3 * left_m[worst]:.1f} mm would have been left: the prediction was wrong."
    else:
        yield (
            f"By its own belief, too, the two meet: {-1e3 * left_m[worst]:.1f} mm deep at {times[worst]:.2f} s."
            f" It did not look there, or saw no other way."
        )


def configuration_at(played: Played, time_s: float) -> npt.NDArray[np.float64]:
    """What the arm was like at ``time_s`` [s], shape (dof,), [rad]."""
    times, states = played.executed.times_s, played.executed.configurations_rad
    return np.array([np.interp(time_s, times, column) for column in states.T])


def _standing(played: Played) -> Iterator[str]:
    """How long it stood still, and why as far as that is known."""
    total = sum(end - begin for begin, end in holds(played))
    if total < _NOTABLE_S:
        return
    answers = [look.plan for look in played.looks if look.plan is not None]
    without = [plan for plan in answers if not len(plan.times_s)]
    why = f": {len(without)} of {len(answers)} solves gave no path ({_statuses(without)})" if without else ""
    yield f"It stood still for {total:g} s in all{why}."


def _statuses(plans: Sequence[Plan]) -> str:
    return ", ".join(dict.fromkeys(plan.status for plan in plans))
