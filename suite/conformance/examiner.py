"""The process in which checks run: compile the house, import the planner, then answer check after check."""

from __future__ import annotations

import json
import sys
import traceback
from pathlib import Path

from planners import PlannerSpec, parse_planner, warm_up
from planners.conformance.elsewhere import answers_alone
from planners.spec import load, read_spec
from scenarios import ContinuumArm, SpecError
from suite.conformance.checks import CHECKS, checks_for
from suite.conformance.finding import IMPORT

_HOUSE = Path(__file__).resolve().parents[2]
LONGEST_MESSAGE = 300


def main() -> None:
    """Answer every line of the standard input with one on the standard output, until there are no more."""
    planner: PlannerSpec | None = None
    with answers_alone() as out:
        order = json.loads(sys.stdin.readline())
        sys.path[:] = order["path"]  # what the asker can import can be imported here
        warm_up([parse_planner("rrt")], ContinuumArm())
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
        return None, failed(error, read_spec(text).name.rpartition(":")[0])


def attempt(name: str, planner: PlannerSpec | None) -> dict[str, str]:
    """What came of one check, as the fields of a finding."""
    if planner is None:
        return {"outcome": "failed", "message": "not asked: the planner could not be imported again"}
    try:
        next(check for check in CHECKS if check.__name__ == name)(planner)
    except BaseException as error:  # noqa: BLE001  a planner may raise anything; it is a finding
        return failed(error, sys.modules[load(planner)[0].__module__].__file__ or "")
    return {"outcome": "ok"}


def failed(error: BaseException, own: str) -> dict[str, str]:
    """What was raised in a line, and where: in the file ``own`` if it came through there."""
    try:
        said = next(iter(str(error).splitlines()), "")
    except Exception:  # noqa: BLE001  an exception may fail to say what it is
        said = ""
    kind = type(error).__name__
    message = said if isinstance(error, AssertionError) and said else f"{kind}: {said}" if said else kind
    frames = traceback.extract_tb(error.__traceback__)
    places = [(frame.filename, frame.lineno) for frame in frames if not frame.filename.startswith("<")]
    if isinstance(error, SyntaxError) and error.filename:
        places.append((error.filename, error.lineno))
    file, line = ([place for place in places if place[0] == own] or places)[-1]
    return {"outcome": "failed", "message": message[:LONGEST_MESSAGE], "where": f"{_short(file)}:{line}"}


def _short(file: str) -> str:
    """A file's path from the folder the user stands in, or within the suite."""
    for root in (Path.cwd(), _HOUSE):
        if Path(file).is_relative_to(root):
            return str(Path(file).relative_to(root))
    return file
