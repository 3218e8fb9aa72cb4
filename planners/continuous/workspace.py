"""The arrays in which a search works, made once per planner."""

from typing import NamedTuple

import numpy as np

from planners.continuous._kernels import Tree, nodes_to
from planners.problem import TimedPath
from planners.search.certificate._kernels import HALVINGS, Stack
from planners.search.steering._kernels import Body, Step, Target
from scenarios.arm import ContinuumArm
from scenarios.kernels.kinematics import ARC_SIZE


class Workspace(NamedTuple):
    """Everything that kernels write to."""

    tree: Tree
    target: Target
    step: Step
    stack: Stack

    @classmethod
    def of(cls, arm: ContinuumArm, capacity: int) -> "Workspace":
        """Arrays for ``arm`` and a tree of up to ``capacity`` nodes."""
        n, dof = arm.n_sections, arm.dof
        return cls(
            Tree(
                states=np.empty((capacity, dof)),
                tips=np.empty((capacity, 3)),
                times=np.empty(capacity),
                parents=np.empty(capacity, np.int64),
                failures=np.empty(capacity, np.int64),
                counts=np.zeros(3, np.int64),
            ),
            Target(point=np.empty(3), posture=np.empty(dof)),
            Step(
                state=np.empty(dof),
                change=np.empty(dof),
                pull=np.empty(dof),
                jacobian=np.empty((3, dof)),
                jacobian_after=np.empty((3, dof)),
            ),
            Stack(
                shares=np.empty(HALVINGS + 2),
                arcs=np.empty((HALVINGS + 2, n, ARC_SIZE)),
                gaps=np.empty((HALVINGS + 2, n)),
                state=np.empty(dof),
            ),
        )

    def path_to(self, node: int) -> TimedPath:
        """The tree's path from its root to ``node``."""
        nodes = nodes_to(self.tree, node)
        return TimedPath(self.tree.times[nodes], self.tree.states[nodes])


def body_of(arm: ContinuumArm, reserve: float) -> Body:
    """The numbers of ``arm`` with its rates cut by the share ``reserve``."""
    return Body(
        arm.section_length_m,
        arm.radius_m,
        arm.max_bend_rad,
        (1.0 - reserve) * arm.max_bend_rate_rad_s,
        (1.0 - reserve) * arm.max_tip_speed_m_s,
    )
