"""A plan made in a process of its own, which is told a planner's spec and nothing else."""

import json
import subprocess
import sys

import numpy as np

from planners.child import answers_alone, command_for
from planners.conformance.scenes import observe, read_again, scenes, session_of
from planners.session import Plan
from planners.spec import PlannerSpec

LIMIT_S = 600.0
"""A process that takes longer is killed; much of it may be compilation."""


def plan_elsewhere(planner: PlannerSpec, scene: str) -> Plan:
    """The planner's first plan in a scene, without motion limits; its time is not told.

    Raises:
        ChildProcessError: The process failed; the message is the last line it wrote.
    """
    order = {
        "name": planner.name,
        "settings": planner.settings.model_dump_json(),
        "scene": scene,
        "path": sys.path,  # it is to import what this process can
    }
    command = command_for("planners.conformance.elsewhere")
    try:
        done = subprocess.run(command, input=json.dumps(order), capture_output=True, text=True, timeout=LIMIT_S)
    except subprocess.TimeoutExpired:
        raise ChildProcessError(f"no plan within {LIMIT_S:g} s") from None
    if done.returncode:
        said = done.stderr.splitlines() or [f"exit code {done.returncode}"]
        raise ChildProcessError(said[-1][:300])
    status, times, configurations, states, motions = json.loads(done.stdout)
    shape = (len(times), scenes()[scene].arm.dof)
    return Plan(status, np.array(times), np.array(configurations).reshape(shape), np.nan, states, motions)


def main() -> None:
    """Read an order from the standard input and write the plan to the standard output."""
    with answers_alone() as out:
        order = json.load(sys.stdin)
        sys.path[:] = order["path"]
        scenario = scenes()[order["scene"]]
        session = session_of(read_again(order["name"], order["settings"]), scenario)
        plan = session.plan(scenario.start, 0.0, observe(scenario))
        path = plan.configurations_rad.tolist()
        json.dump([plan.status, plan.times_s.tolist(), path, plan.state_checks, plan.motion_checks], out)
