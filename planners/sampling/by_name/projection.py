"""The projection by which OMPL's KPIECE planners see where they have been: the tip's position."""

import numpy as np
from ompl import base as ob

from planners.problem import SpaceTimeProblem, read_state
from scenarios.arm import FloatArray
from scenarios.kernels.kinematics import tips


class TipProjection(ob.ProjectionEvaluator):
    """Where a state's tip is, in cubic cells."""

    def __init__(self, problem: SpaceTimeProblem, cell_m: float) -> None:
        """Divide space into cells of side ``cell_m`` [m]."""
        super().__init__(problem.space)
        self._arm = problem.query.arm
        self.inferCellSizes()  # OMPL takes a size for a dimension only when it already has some
        for dimension in range(3):
            self.setCellSizes(dimension, cell_m)

    def getDimension(self) -> int:
        """Of the workspace."""
        return 3

    def project(self, state: ob.State, projection: FloatArray) -> None:
        """Write the tip's position [m]; samples may bend too far, which only their check refuses."""
        q, _ = read_state(state, self._arm.dof)
        projection[:] = np.asarray(tips(q[None], self._arm.section_length_m))[0]
