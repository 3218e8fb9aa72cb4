"""What it costs to pass through OMPL: a state and a motion, from its C++ into the kernels and back."""

from __future__ import annotations

import numpy as np

from benchmarks.timing import Line, seconds_per_call
from planners.prediction import Prediction
from planners.problem import Query, SpaceTimeProblem, _kernels, write_state
from scenarios import ContinuumArm
from scenarios.collision import CONTACT_TOLERANCE_M
from scenarios.families.base import random_configuration
from scenarios.kernels.clearance import motion_clear_until

SPHERES = 6
SAMPLES = 10


def boundary(quick: bool) -> list[Line]:
    """Cost of ``si.isValid`` and ``si.checkMotion`` beside the kernels they end in."""
    rng = np.random.default_rng(0)
    problem = _problem(rng)
    arm, world = problem.query.arm, problem.query.world
    pairs = _motions(problem, rng, 10 if quick else 40)
    states = [(problem.si.allocState(), problem.si.allocState()) for _ in pairs]
    for (one, other), (q0, q1) in zip(states, pairs, strict=True):
        write_state(one, q0, 0.0)
        write_state(other, q1, 5.0)
    limits = (arm.max_bend_rad, arm.max_bend_rate_rad_s, arm.max_tip_speed_m_s, CONTACT_TOLERANCE_M)
    body = (arm.section_length_m, arm.radius_m)
    state, state_kernel, motion, motion_kernel = seconds_per_call(
        [
            lambda: [problem.si.isValid(one) for one, _ in states],
            lambda: [_kernels.clearance(q0, 0.0, *body, arm.max_bend_rad, world) for q0, _ in pairs],
            lambda: [problem.si.checkMotion(one, other) for one, other in states],
            lambda: [_kernels.motions_valid(q0[None], 0.0, q1[None], 5.0, *body, *limits, world) for q0, q1 in pairs],
        ],
        0.1,
        rounds=5 if quick else 15,
    )
    return [
        Line("a state through OMPL", 1e6 * state / len(pairs), "us"),
        Line("a state's kernel, called from Python", 1e6 * state_kernel / len(pairs), "us"),
        Line("a motion of ten samples through OMPL", 1e6 * motion / len(pairs), "us", "<= 15"),
        Line("a motion's kernel, called from Python", 1e6 * motion_kernel / len(pairs), "us"),
    ]


def _problem(rng: np.random.Generator) -> SpaceTimeProblem:
    """The space-time problem among six spheres that move."""
    centers = rng.uniform((-0.3, -0.3, 0.0), (0.3, 0.3, 0.4), size=(SPHERES, 3))
    moving = centers + rng.uniform(-0.01, 0.01, size=(SPHERES, 3)) * np.arange(21.0)[:, None, None]
    radii = rng.choice([0.02, 0.03], SPHERES)
    prediction = Prediction(0.0, 1.0, moving, radii, np.zeros(moving.shape[:2]))
    arm = ContinuumArm()
    query = Query(arm, np.array([0.0, 0.0, 0.4]), 0.01, prediction, prediction.world(0.0), limits=True)
    problem = SpaceTimeProblem(query, 20.0)
    problem.update(query, 0.0)
    return problem


def _motions(problem: SpaceTimeProblem, rng: np.random.Generator, count: int) -> list[tuple[np.ndarray, np.ndarray]]:
    """Valid motions of 5 s for whose proof ten states are looked at."""
    arm = problem.query.arm
    found: list[tuple[np.ndarray, np.ndarray]] = []
    while len(found) < count:
        q0 = random_configuration(rng, arm)
        q1 = q0 + rng.normal(scale=0.1, size=arm.dof)
        if not arm.within_bends(q1) or not problem.validator.check(q0, 0.0, q1, 5.0):
            continue
        _, states = motion_clear_until(
            q0, 0.0, q1, 5.0, 0.0, CONTACT_TOLERANCE_M, arm.section_length_m, arm.radius_m, problem.query.world
        )
        if states == SAMPLES:
            found.append((q0, q1))
    return found
