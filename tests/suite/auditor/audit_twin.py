"""A slow, dense, plain NumPy twin of the audit's geometry, and the random motions that both are tried on."""

from typing import NamedTuple

import numpy as np

from scenarios import ContinuumArm, Obstacle, Orbit, Scenario, Track

UNREACHABLE_M = (5.0, 5.0, 5.0)


class Motion(NamedTuple):
    scenario: Scenario
    times_s: np.ndarray
    configurations_rad: np.ndarray


def turn(vectors):
    """Rotation matrices (..., 3, 3) of rotation vectors (..., 3): Rodrigues."""
    angle = np.linalg.norm(vectors, axis=-1)[..., None, None]
    x, y, z = np.moveaxis(vectors, -1, 0)
    zero = np.zeros_like(x)
    cross = np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=-1).reshape(*x.shape, 3, 3)
    return np.eye(3) + np.sinc(angle / np.pi) * cross + 0.5 * np.sinc(angle / (2 * np.pi)) ** 2 * cross @ cross


def backbone(arm, q, shares):
    """Backbone points (T, n * S, 3) of configurations (T, dof), at ``shares`` (S,) of every section."""
    base, frame = np.zeros((len(q), 3)), np.tile(np.eye(3), (len(q), 1, 1))
    points = []
    for i in range(arm.n_sections):
        u, v = q[:, 2 * i, None], q[:, 2 * i + 1, None]
        phi = np.maximum(np.hypot(u, v), 1e-12) * shares
        lift = arm.section_length_m * shares * np.sinc(phi / np.pi)
        out = arm.section_length_m * shares * 0.5 * phi * np.sinc(phi / (2 * np.pi)) ** 2
        along = np.arctan2(v, u)
        local = np.stack([out * np.cos(along), out * np.sin(along), lift], axis=-1)
        points.append(base[:, None] + np.einsum("tsk,tjk->tsj", local, frame))
        if i + 1 < arm.n_sections:
            base = points[-1][:, -1]
            frame = frame @ turn(np.stack([-q[:, 2 * i + 1], q[:, 2 * i], 0 * q[:, 0]], axis=-1))
    return np.concatenate(points, axis=1)


def states_at(motion, times):
    return np.stack([np.interp(times, motion.times_s, column) for column in motion.configurations_rad.T], axis=1)


def touching(motion, time):
    """Clearance of every section (row) from every obstacle (column) at an instant, exact to a micrometre."""
    arm, at = motion.scenario.arm, np.array([time])
    points = backbone(arm, states_at(motion, at), np.linspace(0.0, 1.0, 301))[0].reshape(arm.n_sections, -1, 3)
    apart = [
        np.linalg.norm(points - obstacle.position(at)[0], axis=2).min(axis=1) - arm.radius_m - obstacle.radius_m
        for obstacle in motion.scenario.obstacles
    ]
    return np.stack(apart, axis=1)


def clearances(motion, times, points_per_section=20):
    """Clearance (T,) at each time: dense points on the backbone, denser ones about the nearest."""
    arm, q = motion.scenario.arm, states_at(motion, times)
    shares = np.linspace(0.0, 1.0, points_per_section + 1)
    points = backbone(arm, q, shares)
    smallest = np.full(len(times), np.inf)
    for obstacle in motion.scenario.obstacles:
        between = points - obstacle.position(times)[:, None]
        away = np.sqrt(np.einsum("tsk,tsk->ts", between, between).min(axis=1))
        smallest = np.minimum(smallest, away - arm.radius_m - obstacle.radius_m)
    return smallest


def smallest_clearance(motion, times):
    """Smallest clearance of the motion at any of ``times``, exact to a micrometre wherever it is near 0 or 1 mm."""
    coarse = clearances(motion, times)
    # A body point is at most 3.75 mm from one of 20: up to 0.25 mm too much at 28 mm from a sphere's centre.
    overstated = 2.5e-4
    if coarse.min() < 0.0 or coarse.min() > 1e-3 + overstated:
        return coarse.min() - (overstated if coarse.min() > 0.0 else 0.0)
    close = times[coarse <= coarse.min() + overstated]
    return clearances(motion, close[:: -(-len(close) // 8)], 300).min()


def random_bending(rng, n_sections, largest=np.pi):
    bend, along = largest * np.sqrt(rng.uniform(size=n_sections)), rng.uniform(0, 2 * np.pi, n_sections)
    return np.stack([bend * np.cos(along), bend * np.sin(along)], axis=1).reshape(-1)


def random_direction(rng):
    vector = rng.normal(size=3)
    return vector / np.linalg.norm(vector)


def random_motion(rng, duration_s=0.1, largest_gap_m=0.04):
    """A fast motion that up to seven obstacles on orbits and tracks pass closely, or hit, somewhere on the way."""
    arm = ContinuumArm(n_sections=int(rng.integers(1, 4)))
    states = [random_bending(rng, arm.n_sections)]
    for _ in range(int(rng.integers(1, 4))):
        step = rng.uniform(0, 3.0) * duration_s * random_bending(rng, arm.n_sections, 1.0)
        following = states[-1] + step
        bends = np.hypot(following[::2], following[1::2])
        states.append(following * np.repeat(np.minimum(1.0, np.pi / np.maximum(bends, 1e-9)), 2))
    times = np.concatenate([[0.0], np.sort(rng.uniform(0.0, duration_s, len(states) - 2)), [duration_s]])
    # The more there are, the wider they may pass: some motions stay free of them all.
    count = int(rng.integers(1, 8))
    obstacles = tuple(_passing_obstacle(rng, arm, times, np.array(states), largest_gap_m * count) for _ in range(count))
    scenario = Scenario(id="random", arm=arm, start_rad=tuple(states[0]), goal_m=UNREACHABLE_M, obstacles=obstacles)
    return Motion(scenario, times, np.array(states))


def _passing_obstacle(rng, arm, times, states, largest_gap_m):
    radius = rng.uniform(0.01, 0.03)
    instant = rng.uniform(0.0, times[-1])
    q = np.array([np.interp(instant, times, column) for column in states.T])[None]
    points = backbone(arm, q, np.linspace(0, 1, 30))[0]
    away = arm.radius_m + radius + rng.uniform(-0.005, largest_gap_m)
    there = points[rng.integers(len(points))] + away * random_direction(rng)
    if rng.uniform() < 0.5:
        speed = rng.uniform(0.0, 0.2) * random_direction(rng)
        knots = np.sort(rng.uniform(-0.1, times[-1] + 0.1, 3))
        positions = there + (knots - instant)[:, None] * speed + rng.normal(size=(3, 3)) * 0.002
        motion = Track(times_s=tuple(knots), positions_m=tuple(map(tuple, positions)))
    else:
        ring = rng.uniform(0.01, 0.15)
        axis = random_direction(rng)
        spoke = np.cross(axis, random_direction(rng))
        center = there - ring * spoke / np.linalg.norm(spoke)
        rate = rng.uniform(-0.2, 0.2) / ring
        motion = _orbit_through(there, center, ring, axis, rate, instant)
    return Obstacle(radius_m=radius, motion=motion)


def _orbit_through(there, center, ring, axis, rate, instant):
    """The orbit that is at ``there`` at ``instant``; the phase is read off the orbit that starts at phase 0."""
    at_zero = Orbit(center_m=tuple(center), radius_m=ring, normal=tuple(axis), rate_rad_s=1.0, phase_rad=0.0)
    e1, e2 = (at_zero.position(np.array([0.0, np.pi / 2])) - center) / ring
    phase = np.arctan2((there - center) @ e2, (there - center) @ e1) - rate * instant
    return at_zero.model_copy(update={"rate_rad_s": rate, "phase_rad": phase})
