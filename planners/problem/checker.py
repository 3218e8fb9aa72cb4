"""The one state validity checker. OMPL: it must not hold the ``SpaceInformation`` (the cycle leaks through C++)."""

import math

from ompl import base as ob

from planners.problem import _kernels
from planners.problem.query import Query
from planners.problem.states import read_state


class SpaceTimeChecker(ob.StateValidityChecker):
    """The one state validity checker: bends within limits and no contact at the state's time."""

    def __init__(self, si: ob.SpaceInformation, query: Query) -> None:
        """Check states against ``query``, which may be replaced at every solve."""
        super().__init__(si)
        self.query = query
        self.checks = 0

    def isValid(self, state: ob.State) -> bool:
        """Whether the state is free of the predicted obstacles."""
        return self.clearance(state) > 0.0

    def clearance(self, state: ob.State) -> float:
        """Signed distance to the nearest predicted obstacle [m], never overstated; -inf past the bending limit."""
        self.checks += 1
        arm, world = self.query.arm, self.query.world
        q, time_s = read_state(state, arm.dof)
        gap = float(_kernels.clearance(q, time_s, arm.section_length_m, arm.radius_m, arm.max_bend_rad, world))
        shapes = self.query.shapes
        return gap if shapes is None or gap > 0.0 or gap == -math.inf else shapes.clearance(arm, q, time_s)
