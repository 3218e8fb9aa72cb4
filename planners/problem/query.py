"""What one solve is about, and the timed path that answers it."""

from typing import NamedTuple

from planners.prediction import Prediction
from planners.problem import _kernels
from scenarios.arm import ContinuumArm, FloatArray
from scenarios.shaped_world import ShapedWorld
from scenarios.world import SampledWorld


class TimedPath(NamedTuple):
    """Timed states, linear in bending vectors between them."""

    times_s: FloatArray
    """Strictly increasing, shape (k,), [s]."""
    configurations_rad: FloatArray
    """Shape (k, dof), [rad]."""


class Query(NamedTuple):
    """What one solve is about, shared by the checker, the validator and the planners."""

    arm: ContinuumArm
    goal_m: FloatArray
    """Goal point of the tip, shape (3,), [m]."""
    goal_tolerance_m: float
    prediction: Prediction
    """The obstacles as predicted, with error bounds."""
    world: SampledWorld
    """The same for collision checks, grown by the margin that the planner's registry entry asks for: spheres that hold
    the obstacles, whatever their shapes are."""
    limits: bool
    """Whether planners whose paths may otherwise jump in shape must keep to what the motion validator allows."""
    shapes: ShapedWorld | None = None
    """The obstacles' own shapes, which decide where the spheres are hit; None where ``world`` is exact."""
    asked_margin: float | None = None
    """Standard deviations that a run asks every planner to keep clear of; None where each is to keep its own."""

    def goal_distance(self, q: FloatArray) -> float:
        """Distance of the tip at ``q`` (dof,) [rad] from the goal point [m]."""
        return float(_kernels.tip_distance(q, self.arm.section_length_m, self.goal_m))
