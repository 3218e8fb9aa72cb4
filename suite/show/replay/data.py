"""What a page needs to draw a scenario and trials on it."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from scenarios import Mesh, Obstacle, Scenario
from scenarios.world import positions
from suite.show.replay.again import Played
from suite.show.replay.packed import packed, packed_times
from suite.show.replay.story import holds, story
from suite.trial.look import Look
from suite.trial.observation import Observer

TRACE_S = 0.25
"""Spacing of the obstacles' true positions: straight between them is off the paper's orbits by 0.03 mm at most."""
AHEAD_S = 12.0
"""How much of a prediction is drawn."""


def scenario_data(scenario: Scenario, end_s: float) -> dict[str, Any]:
    """The world until ``end_s`` [s]: arm, goal, obstacles with shapes and true motion from the observation on."""
    times = trace_times(scenario, end_s)
    return {
        "id": scenario.id,
        "family": scenario.family,
        "arm": {name: getattr(scenario.arm, name) for name in ("n_sections", "section_length_m", "radius_m")},
        "start": list(scenario.start_rad),
        "goal": list(scenario.goal_m),
        "tolerance": scenario.goal_tolerance_m,
        "shapes": [_shape(obstacle) for obstacle in scenario.obstacles],
        "trace": {"start": float(times[0]), "step": TRACE_S, "centers": packed(positions(scenario.obstacles, times))},
    }


def trace_times(scenario: Scenario, end_s: float) -> npt.NDArray[np.float64]:
    """Times at which true positions are given, from the beginning of the observation to after ``end_s`` [s]."""
    first = -scenario.observation_s
    return np.asarray(first + TRACE_S * np.arange(math.ceil((end_s - first) / TRACE_S) + 2), dtype=np.float64)


def trial_data(scenario: Scenario, played: Played) -> dict[str, Any]:
    """One trial: what was executed, what its planner believed, what it amounts to."""
    row, executed = played.row, played.executed
    return {
        "planner": played.label,
        "outcome": row["outcome"],
        "times": packed_times(executed.times_s),
        "states": packed(executed.configurations_rad),
        "verdicts": {
            name: {
                "success": bool(row[f"success_{name}"]),
                "time": row[f"violation_{name}_time_s"],
                "kind": row[f"violation_{name}_kind"],
            }
            for name in ("per_step", "swept", "executable")
        },
        "arrival": row["arrival_time_s"],
        "contact": [row["contact_obstacle"], row["contact_section"]] if row["contact_obstacle"] else None,
        "holds": holds(played),
        "story": story(scenario, played),
        "remark": played.remark,
        "predictor": row["predictor"],
        "looks": _looks(played.looks),
    }


def observed(task: Any, end_s: float) -> dict[str, Any] | None:
    """Where a task's sensors saw the obstacles until ``end_s`` [s]; None where they see exactly where they are."""
    if not (task.noise_mm or task.dropout):
        return None
    seen = Observer(task).until(end_s)
    lost = np.isnan(seen.positions_m[:, :, 0])
    return {
        "start": float(seen.times_s[0]),
        "centers": packed(np.where(lost[:, :, None], 0.0, seen.positions_m)),
        "lost": [[int(k), int(j)] for k, j in np.argwhere(lost)],
    }


def _looks(looks: list[Look]) -> dict[str, Any] | None:
    """Predictions, each once, and answers: those behind one another in one array, with their lengths beside."""
    if not looks:
        return None
    predictions = list({look.expected.start_s: look.expected for look in looks}.values())
    plans = [(look.now_s, look.plan) for look in looks if look.plan is not None]
    cut = [min(len(p.centers_m), math.ceil(AHEAD_S / p.step_s) + 1) for p in predictions]
    paths = [plan.configurations_rad for _, plan in plans]
    return {
        "from": [p.start_s for p in predictions],
        "step": predictions[0].step_s,
        "counts": cut,
        "centers": packed(np.concatenate([p.centers_m[:n] for p, n in zip(predictions, cut, strict=True)])),
        "radii": packed(np.concatenate([p.radii_m[:n] for p, n in zip(predictions, cut, strict=True)])),
        "solves": [now_s for now_s, _ in plans],
        "statuses": [plan.status for _, plan in plans],
        "lengths": [len(path) for path in paths],
        "path_times": packed_times(np.concatenate([plan.times_s for _, plan in plans])),
        "paths": packed(np.concatenate(paths)),
    }


def _shape(obstacle: Obstacle) -> dict[str, Any]:
    """A sphere, or a body with its sizes and its rotation, row by row."""
    shape = obstacle.shape
    if shape is None:
        return {"kind": "sphere", "radius": obstacle.radius_m}
    said: dict[str, Any] = {"kind": shape.kind, "rotation": shape.rotation.reshape(-1).tolist()}
    if isinstance(shape, Mesh):
        points, faces = shape.hull()
        return said | {"triangles": points[faces].reshape(-1, 3).tolist()}
    return said | {name: getattr(shape, name) for name in ("size_m", "radius_m", "length_m") if hasattr(shape, name)}
