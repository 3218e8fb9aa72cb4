"""The process in which checks run: compile the house, import the planner, then answer check after check."""

from __future__ import annotations

import json
import sys

from planners import PlannerSpec, parse_planner
from planners.child import answers_alone
from planners.failure import failure_of
from planners.first_use import warm_up_planner, warm_up_problem
from scenarios import ContinuumArm, SpecError
from suite.conformance.checks import CHECKS, checks_for
from suite.conformance.finding import IMPORT


def main() -> None:
    """Answer every line of the standard input with one on the standard output, until there are no more."""
    planner: PlannerSpec | None = None
    with answers_alone() as out:
        order = json.loads(sys.stdin.readline())
        sys.path[:] = order["path"]  # what the asker can import can be imported here
        warm_up_problem(ContinuumArm())
        warm_up_planner(parse_planner("rrt"), "portfolio", ContinuumArm())
        print(json.dumps("ready"), file=out, flush=True)
        for line in sys.stdin:
            name = json.loads(line)
            if name == IMPORT:
                planner, answer = import_planner(order["planner"])
            else:
                answer = attempt(name, planner)
            print(json.dumps(answer), file=out, flush=True)


def import_planner(text: str) -> tuple[PlannerSpec | None, object]:
    """The planner with the names of its checks; a line for a user's mistake, a finding for what its code raised."""
    try:
        planner = parse_planner(text)
        return planner, [check.__name__ for check in checks_for(planner)]
    except SpecError as error:
        return None, str(error)
    except BaseException as error:  # noqa: BLE001  it may raise anything
        return None, failed(error)


def attempt(name: str, planner: PlannerSpec | None) -> dict[str, str]:
    """What came of one check, as the fields of a finding."""
    if planner is None:
        return {"outcome": "failed", "message": "not asked: the planner could not be imported again"}
    try:
        next(check for check in CHECKS if check.__name__ == name)(planner)
    except BaseException as error:  # noqa: BLE001  a planner may raise anything; it is a finding
        return failed(error)
    return {"outcome": "ok"}


def failed(error: BaseException) -> dict[str, str]:
    """What was raised and where, as the fields of a finding."""
    return {"outcome": "failed", "message": failure_of(error).message.removeprefix("AssertionError: ")}
