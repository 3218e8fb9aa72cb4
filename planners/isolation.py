"""What is known of a planner from outside without importing it here.

Importing a file runs its author's code, which may raise, hang or take the process down. So a child process imports it
and says what the suite has to know: its settings, its predictor, whether it is a bound.
"""

from __future__ import annotations

import functools
import json
import os
import signal
import subprocess
import sys
from contextlib import suppress
from typing import Any

from pydantic import BaseModel, ConfigDict, ValidationError

from planners import plugins
from planners.child import answers_alone, command_for
from planners.failure import Failure, failure_of
from planners.prediction import PREDICTORS
from planners.spec import PlannerSpec, is_outside, parse_planner, planner_class, read_spec
from scenarios.spec import SpecError

LIMIT_S = 60.0
"""A planner that has not been imported after this long [s] is taken to hang; its kernels are compiled later."""


class OutsideSettings(BaseModel):
    """Values of settings whose model is not to be had in this process."""

    model_config = ConfigDict(frozen=True, extra="allow")


class Facts(BaseModel):
    """What the suite has to know of a planner, or why that can't be had."""

    model_config = ConfigDict(extra="forbid")

    summary: str = ""
    settings: dict[str, Any] = {}
    predictor: str = "cubic"
    prediction_margin: float = 0.0
    is_bound: bool = False
    mistake: str = ""
    """A user's mistake in the spec."""
    failure: Failure | None = None


def describe(text: str, limit_s: float = LIMIT_S) -> PlannerSpec:
    """Read a spec as ``parse_planner`` does, but import what is from outside in a process of its own.

    Args:
        text: The spec.
        limit_s: The child process is killed after this long [s].

    Returns:
        The spec; with a ``failure`` when the planner can't be imported.

    Raises:
        SpecError: As ``parse_planner``: a mistake in the spec.
    """
    typed = read_spec(text)
    if not is_outside(typed.name) or plugins.is_here(typed.name):
        return parse_planner(text)
    code = plugins.code_hash(typed.name)
    facts = facts_of(text, code, limit_s)
    if facts.mistake:
        raise SpecError(facts.mistake)
    settings = OutsideSettings(**(typed.values if facts.failure else facts.settings))
    return PlannerSpec(
        typed.label,
        typed.name,
        settings,
        facts.predictor,
        facts.prediction_margin,
        facts.is_bound,
        code,
        facts.failure,
    )


@functools.lru_cache(maxsize=256)
def facts_of(text: str, code: str, limit_s: float = LIMIT_S) -> Facts:
    """Start a child that imports the planner and read its answer: once for each state ``code`` of its sources."""
    del code
    with subprocess.Popen(
        command_for("planners.isolation"),
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
        text=True,
    ) as child:
        try:
            answered, _ = child.communicate(json.dumps({"text": text, "path": sys.path}), limit_s)
            return Facts.model_validate_json(answered)
        except subprocess.TimeoutExpired:
            return Facts(failure=Failure("planner_hung", f"in import: killed after {limit_s:g} s"))
        except ValidationError:
            child.wait()
            return Facts(failure=Failure("planner_error", f"in import: the process died: {_cause(child.returncode)}"))
        finally:
            with suppress(ProcessLookupError):
                os.killpg(child.pid, signal.SIGKILL)  # with whatever it has started


def _cause(code: int) -> str:
    return signal.Signals(-code).name if code < 0 else f"exit code {code}"


def main() -> None:
    """In the child: read which planner is asked about, write its facts."""
    with answers_alone() as out:
        order = json.load(sys.stdin)
        sys.path[:] = order["path"]  # what the asker can import can be imported here
        out.write(_look_at(order["text"]).model_dump_json())
    os._exit(0)  # threads and exit handlers of the planner's own are not waited for


def _look_at(text: str) -> Facts:
    try:
        spec = parse_planner(text)
    except SpecError as mistake:
        return Facts(mistake=str(mistake))
    except BaseException as error:  # noqa: BLE001  a module may raise anything, SystemExit as well
        return Facts(failure=failure_of(error, "in import"))
    if spec.predictor not in PREDICTORS:
        found = f"predictor: found {spec.predictor!r}, allowed {', '.join(PREDICTORS)}"
        return Facts(failure=Failure("planner_error", f"in import: {found}"))
    settings = json.loads(spec.settings.model_dump_json())
    return Facts(
        summary=planner_class(spec.name).summary,
        settings=settings,
        predictor=spec.predictor,
        prediction_margin=spec.prediction_margin,
        is_bound=spec.is_bound,
    )
