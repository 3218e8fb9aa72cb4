"""States and paths between OMPL and arrays; an element-wise read is the cheapest way out of a state."""

import numpy as np
from ompl import base as ob
from ompl import geometric as og

from planners.problem.query import TimedPath
from scenarios.arm import FloatArray


def read_state(state: ob.State, dof: int) -> tuple[FloatArray, float]:
    """Copy (configuration (dof,) [rad], time [s]) out of an OMPL state."""
    return np.fromiter(map(state[0].__getitem__, range(dof)), np.float64, dof), float(state[1].position)


def write_state(state: ob.State, q: FloatArray, time_s: float) -> None:
    """Write a configuration (dof,) [rad] and a time [s] into an OMPL state."""
    state[0][0 : len(q)] = q.tolist()
    state[1].position = float(time_s)


def write_path(si: ob.SpaceInformation, timed: TimedPath) -> og.PathGeometric:
    """The same path in OMPL states. A state in one call: long paths were a tenth of the median solve."""
    path, state, write = og.PathGeometric(si), si.allocState(), si.getStateSpace().copyFromReals
    for reals in np.column_stack([timed.configurations_rad, timed.times_s]).tolist():
        write(state, reals)
        path.append(state)
    return path
