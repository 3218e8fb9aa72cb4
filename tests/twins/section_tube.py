"""The tube of section 1 by plain NumPy: every cell against every other, every point against every obstacle."""

import numpy as np

from twins.kinematics import backbone
from twins.shapes import signed_distance


def tube(scenario, edge, far, step_s, steps, points, allowance):
    """Sets of alive cells (i, j), the middle one (0, 0), at each of ``steps`` times; no word of start and goal.

    Args:
        scenario: The scenario.
        edge: Of a cell [rad].
        far: Cells from the middle one to the rim of the grid.
        step_s: Time between two sets [s].
        steps: Number of sets.
        points: Backbone points looked at.
        allowance: Largest rate [rad/s], and how far a bend may be off [rad].
    """
    rate, stray = allowance
    arm = scenario.arm
    grid = np.stack(np.meshgrid(*[np.arange(-far, far + 1)] * 2, indexing="ij"), axis=-1).reshape(-1, 2)
    nearest = np.maximum(np.abs(grid) * edge - edge / 2, 0)
    grid = grid[np.linalg.norm(nearest, axis=1) <= arm.max_bend_rad + stray]
    lines = np.stack([backbone(cell * edge, arm.section_length_m, points)[1:] for cell in grid])
    arcs = arm.section_length_m * np.arange(1, points + 1) / points
    shifts = arcs**2 / (2 * arm.section_length_m) * (np.sqrt(2) / 2 * edge + stray)
    apart = np.maximum(np.abs(grid[:, None] - grid) - 1, 0) * edge
    may_bend = np.linalg.norm(apart, axis=2) <= rate * step_s + 1e-9
    alive = (np.abs(grid * edge - scenario.start[:2]) <= edge / 2 + 1e-9).all(axis=1)
    for k in range(steps):
        if k:
            alive = may_bend[:, alive].any(axis=1)
        alive &= ~hit(scenario, lines, shifts, k * step_s)
        yield {tuple(cell) for cell in grid[alive]}


def hit(scenario, lines, shifts, time_s):
    """Whether some point of each line (C, S, 3), wherever within its shift (S,), touches an obstacle: (C,)."""
    touched = np.zeros(len(lines), bool)
    for obstacle in scenario.obstacles:
        away = lines - obstacle.position(np.array([time_s]))[0]
        if obstacle.shape is None:
            gaps = np.linalg.norm(away, axis=2) - obstacle.radius_m
        else:
            gaps = signed_distance(obstacle.shape, away.reshape(-1, 3)).reshape(away.shape[:2])
        touched |= (gaps + shifts < scenario.arm.radius_m).any(axis=1)
    return touched
