"""The layered graph of configurations over a path of cubes (paper, section II-E)."""

import functools
from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from planners.search.configurations import EnumeratedSpace
from planners.search.cubes import _kernels
from planners.search.cubes.local import ObstacleSteps
from scenarios.arm import ContinuumArm, FloatArray

EdgeFilter = Callable[[int, FloatArray, FloatArray], npt.NDArray[np.bool_]]
"""Which motions from configurations (A, dof) to (B, dof) are possible from step k to k + 1: (A, B)."""

_ALL = np.empty((0, 0), np.bool_)
"""Every edge, to the kernel."""


@functools.lru_cache(maxsize=8)
def _change_table(bends: bytes) -> FloatArray:
    """Orientation changes between all lattice bends, computed once per lattice."""
    table: FloatArray = _kernels.change_table(np.frombuffer(bends).reshape(-1, 2))
    return table


class LayeredGraph:
    """Layers of free configurations, one per step; every configuration has an edge to every one in the next layer."""

    def __init__(
        self, arm: ContinuumArm, space: EnumeratedSpace, q: FloatArray, cubes: list[int], obstacles: ObstacleSteps
    ) -> None:
        """Collect the free configurations of each cube on the path.

        Args:
            arm: The arm.
            space: Its enumerated configurations.
            q: Present configuration, shape (dof,), [rad]: the first layer, and one more configuration of its cube.
            cubes: The path's cubes, the current one first.
            obstacles: Obstacles at the step of each layer.
        """
        self._q, self._space = q, space
        self._table = _change_table(space.bends_rad.tobytes())
        self.state_checks = 0
        self.layers = [np.array([_kernels.CURRENT])]
        for step, cube in enumerate(cubes[1:], start=1):
            layer, checks = _kernels.free_layer(
                cube,
                cube == cubes[0],
                q,
                space,
                arm.section_length_m,
                obstacles.centers_m[step],
                obstacles.reach_m[step],
            )
            self.layers.append(layer)
            self.state_checks += int(checks)

    def smoothest_path(self, possible: EdgeFilter | None = None) -> FloatArray | None:
        """Configurations (layers, dof) [rad] of least cumulative orientation change, the present one first.

        Bellman-Ford on a layered graph: its edges relaxed once, in the order of the layers, are already final.
        None when some layer is empty or ``possible`` leaves no path.
        """
        cost = np.zeros(1)
        parents = []
        from_now = _kernels.changes_from(self._q, self._space.bends_rad)
        for step, (before, after) in enumerate(zip(self.layers, self.layers[1:], strict=False)):
            allowed = _ALL if possible is None else possible(step, self._decode(before), self._decode(after))
            cost, parent = _kernels.relax_layer(cost, before, after, from_now, self._table, allowed)
            parents.append(parent)
        if not np.isfinite(cost).any():
            return None
        k = int(np.argmin(cost))
        chosen = [k]
        for parent in reversed(parents):
            k = int(parent[k])
            chosen.append(k)
        codes = [layer[k] for layer, k in zip(self.layers, reversed(chosen), strict=True)]
        return self._decode(np.array(codes))

    def _decode(self, codes: npt.NDArray[np.int64]) -> FloatArray:
        is_current = codes == _kernels.CURRENT
        q = self._space.decode(np.where(is_current, 0, codes))
        q[is_current] = self._q
        return q
