"""Motions at the very limits of what the audit lets pass, among obstacles that all but touch them.

What is drawn is the motion; the arm's limits, the goal and the obstacles are made to fit. So each scenario is solved,
and none leaves a proof of the contrary much room to be wrong unnoticed.
"""

from typing import NamedTuple

import numpy as np
from shapes import KINDS, random_shape

from scenarios import ContinuumArm, Line, Obstacle, Orbit, Scenario, Track, Wander, Wave
from suite.auditor import Audit, audit

OVER = 1.0009  # of the limits, of which the audit forgives 0.1 %
# The first that will do: room for what the audit wants, and a tip faster than allowed, but for what samples miss.
ROOMS = ((2e-4, OVER), (2e-4, 0.999), (1e-3, 0.99), (4e-3, 0.95))
SAMPLES = 40  # of a piece of the motion


class Solved(NamedTuple):
    scenario: Scenario
    times_s: np.ndarray
    configurations_rad: np.ndarray
    judged: Audit

    def at(self, times_s) -> np.ndarray:
        """Configurations (T, dof) at ``times_s``."""
        columns = self.configurations_rad.T
        return np.stack([np.interp(times_s, self.times_s, column) for column in columns], axis=1)


def random_arm(rng: np.random.Generator) -> ContinuumArm:
    return ContinuumArm(
        n_sections=int(rng.integers(1, 5)),
        section_length_m=rng.uniform(0.05, 0.4),
        radius_m=rng.uniform(0.004, 0.03),
        max_bend_rad=rng.choice([np.pi, rng.uniform(0.8, np.pi), 1e-3]),
        max_bend_rate_rad_s=rng.choice([0.5, rng.uniform(0.1, 2.0)]),
    )


def just_missed(
    rng: np.random.Generator, arm: ContinuumArm, n_obstacles: int, shapes: bool = False, hold: float = 0.3
) -> Solved | None:
    """A motion and a scenario that it solves; None where the draw failed. ``hold``: how often a section rests."""
    times, states = _motion(rng, arm, int(rng.integers(2, 8)), hold)
    dense_s = np.linspace(0.0, times[-1], SAMPLES * (len(times) - 1) + 1)
    dense = np.stack([np.interp(dense_s, times, column) for column in states.T], axis=1)
    tips = arm.tips(dense)
    speed = np.linalg.norm(np.diff(tips, axis=0), axis=1).max() / dense_s[1]
    backbone = np.stack([arm.backbone_points(q, 15) for q in dense])
    bodies = []
    for _ in range(n_obstacles):
        motion = _law(rng, float(times[-1]), 1.2 * arm.length_m)
        away = np.linalg.norm(backbone - motion.position(dense_s)[:, None], axis=2).min()
        radius = away - arm.radius_m - 0.5 * arm.section_length_m / 15
        if radius > 0.01:
            bodies.append((motion, radius, random_shape(rng, rng.choice(KINDS)) if shapes else None))
    for room_m, over in ROOMS:
        scenario = Scenario(
            id="just-missed",
            arm=arm.model_copy(update={"max_tip_speed_m_s": float(max(speed, 1e-4) / over)}),
            start_rad=tuple(states[0].tolist()),
            goal_m=tuple((tips[-1] + [0.0, 0.0, 0.0099]).tolist()),
            obstacles=tuple(_obstacle(motion, radius - room_m, shape) for motion, radius, shape in bodies),
            time_limit_s=float(max(1.0, times[-1] + 1e-10)),
        )
        judged = audit(scenario, times, states)
        if judged.executable.success:
            return Solved(scenario, times, states, judged)
    return None


def _motion(rng, arm, pieces, hold):
    """Every section straight ahead at its full rate from one timed state to the next, or at rest."""
    n, limit = arm.n_sections, arm.max_bend_rad
    bends = _in_disc(rng, n, limit)
    times, states = [0.0], [bends.reshape(-1)]
    for _ in range(pieces):
        duration = rng.uniform(0.05, 1.0) * 1.5 / arm.max_bend_rate_rad_s
        far = OVER * arm.max_bend_rate_rad_s * duration
        to = _in_disc(rng, n, limit) - bends
        moved = to / np.maximum(np.linalg.norm(to, axis=1, keepdims=True), 1e-9) * far
        past = np.linalg.norm(moved, axis=1) > np.linalg.norm(to, axis=1)
        moved[past] = to[past]
        moved[rng.uniform(size=n) < hold] = 0.0
        bends = bends + moved
        times.append(times[-1] + duration)
        states.append(bends.reshape(-1))
    return np.array(times), np.array(states)


def _in_disc(rng, n, limit):
    bend, plane = limit * np.sqrt(rng.uniform(size=n)), rng.uniform(-np.pi, np.pi, n)
    return np.column_stack([bend * np.cos(plane), bend * np.sin(plane)])


def _law(rng, end_s, spread_m):
    """An obstacle's course; often it ends up near the base, where it decides the most."""
    place = rng.normal(size=3) * rng.choice([0.15, 0.6]) * spread_m
    speed = rng.choice([0.0, rng.uniform(0.0, 0.3) * spread_m / end_s])
    match rng.integers(4):
        case 0:
            velocity = speed * rng.normal(size=3)
            return Line(point_m=tuple(place - end_s * velocity), velocity_m_s=tuple(velocity))
        case 1:
            radius = 0.3 * spread_m
            return Orbit(
                center_m=tuple(place),
                radius_m=radius,
                normal=tuple(rng.normal(size=3)),
                rate_rad_s=speed / radius,
                phase_rad=rng.uniform(0.0, 6.0),
            )
        case 2:
            waves = [
                Wave(amplitude_m=tuple(a), rate_rad_s=speed / 0.1, phase_rad=rng.uniform(0.0, 6.0))
                for a in 0.1 * rng.normal(size=(3, 3))
            ]
            return Wander(center_m=tuple(place), waves=tuple(waves))
        case _:
            times = np.sort(rng.uniform(0.0, end_s, 4)) + 1e-6 * np.arange(4)
            points = place + speed * end_s * rng.normal(size=(4, 3))
            return Track(times_s=tuple(times.tolist()), positions_m=tuple(map(tuple, points.tolist())))


def _obstacle(motion, radius, shape):
    """A sphere, or ``shape`` made to touch that sphere from inside."""
    if shape is None:
        return Obstacle(radius_m=min(radius, 9.0), motion=motion)
    scale = min(radius, 2.0) / shape.bounding_radius_m
    sizes = shape.model_dump(exclude={"kind", "rotation_rad"}).items()
    scaled = {key: (scale * np.array(value)).tolist() for key, value in sizes}
    return Obstacle(shape=type(shape)(rotation_rad=shape.rotation_rad, **scaled), motion=motion)
