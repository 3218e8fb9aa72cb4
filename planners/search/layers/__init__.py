"""The layered graph of configurations over a path of cubes (paper, section II-E)."""

from collections.abc import Callable
from typing import TypeVar

import numpy as np

from planners.search.certificate._kernels import HALVINGS, Stack
from planners.search.configurations._kernels import memo_size
from planners.search.layers import _kernels
from planners.search.layers._kernels import Configurations, Full, Layers, Motions
from planners.search.scene import Scene
from scenarios.arm import FloatArray
from scenarios.kernels.kinematics import ARC_SIZE

CAPACITY = 1024
"""Configurations for which there is room at first."""

Answer = TypeVar("Answer")


def empty_layers(n_sections: int, n_bends: int, horizon: int, capacity: int = CAPACITY) -> Layers:
    """Room for the layers of a solve of ``horizon`` steps with a lattice of ``n_bends``."""
    n, dof = n_sections, 2 * n_sections
    return Layers(
        Configurations(
            codes=np.empty(capacity, np.int64),
            digits=np.empty((capacity, n), np.int64),
            states=np.empty((capacity, dof)),
            arcs=np.empty((capacity, n, ARC_SIZE)),
            gaps=np.empty((capacity, n)),
            is_laid_out=np.empty(capacity, np.bool_),
            labels=np.empty(capacity, np.int64),
        ),
        Motions(weights=np.empty(32 * capacity), answers=np.empty(32 * capacity, np.int8)),
        spans=np.empty((capacity // 4, 3), np.int64),
        blocks=np.empty((capacity // 4, 27), np.int64),
        memo=np.empty((horizon + 1, memo_size(n_bends, n)), np.int8),
        counts=np.zeros(5, np.int64),
        stack=Stack(
            shares=np.empty(HALVINGS + 2),
            arcs=np.empty((HALVINGS + 2, n, ARC_SIZE)),
            gaps=np.empty((HALVINGS + 2, n)),
            state=np.empty(dof),
        ),
        change=np.empty(dof),
    )


def call(kernel: Callable[..., Answer], layers: Layers, scene: Scene, *others: object) -> tuple[Layers, Answer]:
    """What ``kernel`` answers, called again with twice the room as long as it has too little; and the layers used."""
    while True:
        try:
            return layers, kernel(layers, scene, *others)
        except Full:
            capacity, n_sections = layers.configurations.digits.shape
            layers = empty_layers(n_sections, len(scene.space.bends_rad), len(layers.memo) - 1, 2 * capacity)


class LayeredGraph:
    """Layers of free configurations, one per step; every configuration has an edge to every one in the next layer."""

    def __init__(self, scene: Scene, cubes: list[int]) -> None:
        """Take the path's cubes, the arm's own first; at step k the obstacles of ``scene`` are where they are then."""
        layers = empty_layers(scene.space.n_sections, len(scene.space.bends_rad), scene.horizon)
        self._scene = scene
        self._layers, (self._chain, self._blocks) = call(_kernels.layered_graph, layers, scene, np.array(cubes))

    @property
    def state_checks(self) -> int:
        """Configurations checked."""
        return int(self._layers.counts[_kernels.STATE_CHECKS])

    @property
    def motion_checks(self) -> int:
        """Motions checked."""
        return int(self._layers.counts[_kernels.MOTION_CHECKS])

    def smoothest_path(self, look: bool = False) -> FloatArray | None:
        """Configurations (layers, dof) [rad] of least cumulative orientation change, the present one first.

        With ``look`` each motion has to be possible: within the limits of the scene, touching nothing at any instant.
        None when there is no path.
        """
        rows = _kernels.smoothest_path(self._layers, self._scene, self._chain, self._blocks, look)
        return self._layers.configurations.states[rows] if len(rows) else None
