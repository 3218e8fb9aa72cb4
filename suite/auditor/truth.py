"""The obstacles' true motion, packed into plain arrays for the audit's kernels."""

import math
from collections.abc import Sequence
from typing import NamedTuple, Protocol

import numpy as np
import numpy.typing as npt

from scenarios import Line, Obstacle, Orbit, Scenario, Still, Track, Wander
from suite.auditor._kernels import SMOOTH, TRACK
from suite.auditor.shapes import Bodies, pack_shapes

FloatArray = npt.NDArray[np.float64]

_AT_REST_RAD_S = 1e-15  # a nanometre in an hour
_RESAMPLING_ERROR_M = 2e-5
_MAX_SAMPLES = 200_000


class Law(Protocol):
    """What the audit needs of a law of motion that its kernels do not know."""

    def position(self, times_s: FloatArray) -> FloatArray:
        """Centre at each time: (T,) [s] -> (T, 3) [m]."""

    @property
    def speed_bound_m_s(self) -> float:
        """A speed that is never exceeded."""


class Truth(NamedTuple):
    """m obstacles on their laws: smooth ones are a course plus a span of ``waves``, tracks a span of ``points``."""

    bodies: Bodies
    """What they look like."""
    radii_m: FloatArray
    """Radii of spheres about their centres that hold them, pads included, shape (m,), [m]."""
    pads_m: FloatArray
    """How far a centre may be from where its law is packed to be, shape (m,), [m]."""
    speeds_m_s: FloatArray
    """Speeds that are never exceeded, shape (m,)."""
    laws: npt.NDArray[np.int64]
    """SMOOTH or TRACK, shape (m,)."""
    courses: FloatArray
    """Position at t = 0 [m] and velocity [m/s] without the waves, shape (m, 6)."""
    waves: FloatArray
    """Cosine and sine amplitudes [m] and rate [rad/s], shape (W, 7)."""
    points: FloatArray
    """Time [s] and position [m], straight in between, shape (P, 4)."""
    spans: npt.NDArray[np.int64]
    """First row of ``waves`` or ``points`` and the one after the last, shape (m, 2)."""


class _Packed(NamedTuple):
    """One obstacle's share of a ``Truth``."""

    law: int
    speed_m_s: float
    course: FloatArray
    rows: FloatArray
    """Of ``Truth.waves`` or ``Truth.points``."""
    pad_m: float = 0.0


_NO_COURSE = np.zeros(6)


def pack(scenario: Scenario) -> Truth:
    """Pack the obstacles of ``scenario``, exact at every instant; a law without a kernel is resampled with a pad."""
    packed = [pack_law(obstacle.motion, scenario.time_limit_s) for obstacle in scenario.obstacles]
    return assemble(scenario.obstacles, packed)


def assemble(obstacles: Sequence[Obstacle], packed: Sequence[_Packed]) -> Truth:
    """Put obstacles, with their laws packed, behind one another."""
    pads = np.array([one.pad_m for one in packed], dtype=np.float64)
    waves, points, spans = [np.empty((0, 7))], [np.empty((0, 4))], []
    for one in packed:
        rows = waves if one.law == SMOOTH else points
        first = sum(map(len, rows))
        rows.append(one.rows)
        spans.append((first, first + len(one.rows)))
    return Truth(
        bodies=pack_shapes(obstacles),
        radii_m=np.array([obstacle.radius_m for obstacle in obstacles], dtype=np.float64) + pads,
        pads_m=pads,
        speeds_m_s=np.array([one.speed_m_s for one in packed], dtype=np.float64),
        laws=np.array([one.law for one in packed], dtype=np.int64),
        courses=np.array([one.course for one in packed]).reshape(-1, 6),
        waves=np.concatenate(waves),
        points=np.concatenate(points),
        spans=np.array(spans, dtype=np.int64).reshape(-1, 2),
    )


def pack_law(law: Law, end_s: float) -> _Packed:
    """Pack one law of motion, to be followed until ``end_s`` [s]."""
    if isinstance(law, Orbit):
        return _smooth(law.center_m, (0.0, 0.0, 0.0), _orbit(law))
    if isinstance(law, Line):
        return _smooth(law.point_m, law.velocity_m_s, np.empty((0, 7)))
    if isinstance(law, Still):
        return _smooth(law.point_m, (0.0, 0.0, 0.0), np.empty((0, 7)))
    if isinstance(law, Wander):
        return _smooth(law.center_m, (0.0, 0.0, 0.0), _wander(law))
    if isinstance(law, Track):
        points = np.column_stack([law.times_s, law.positions_m])
        return _Packed(TRACK, law.speed_bound_m_s, _NO_COURSE, points)
    return _resampled(law, end_s)


def _smooth(point: npt.ArrayLike, velocity: npt.ArrayLike, waves: FloatArray) -> _Packed:
    """A course with waves on it, and the sum of their largest speeds (docs/audit.md).

    A wave runs through an ellipse whose longer half-axis is the largest singular value of its two amplitudes.
    """
    speed = float(np.linalg.norm(velocity))
    for wave in waves:
        speed += abs(wave[6]) * float(np.linalg.norm(wave[:6].reshape(2, 3), ord=2))
    return _Packed(SMOOTH, speed * (1.0 + 1e-12), np.concatenate([point, velocity]), waves)


def _orbit(law: Orbit) -> FloatArray:
    """One wave (1, 7): the circle's two amplitudes, read off the law itself at t = 0 and a quarter turn later."""
    rate = law.rate_rad_s if abs(law.rate_rad_s) > _AT_REST_RAD_S else 0.0
    quarter_s = 0.5 * math.pi / rate if rate else 0.0
    amplitudes = law.position(np.array([0.0, quarter_s])) - np.asarray(law.center_m)
    return np.concatenate([amplitudes.reshape(-1), [rate]])[None]


def _wander(law: Wander) -> FloatArray:
    """Waves (W, 7): a * sin(p + r t) is a sin(p) * cos(r t) + a cos(p) * sin(r t)."""
    amplitudes = np.array([wave.amplitude_m for wave in law.waves])
    phases = np.array([[wave.phase_rad] for wave in law.waves])
    rates = np.array([[wave.rate_rad_s] for wave in law.waves])
    return np.hstack([np.sin(phases) * amplitudes, np.cos(phases) * amplitudes, rates])


def _resampled(law: Law, end_s: float) -> _Packed:
    """A track through samples of ``law``: between two of them a motion of bounded speed strays at most v * step / 2."""
    speed = law.speed_bound_m_s
    wanted = math.ceil(0.5 * speed * end_s / _RESAMPLING_ERROR_M)
    times = np.linspace(0.0, end_s, min(max(wanted, 1), _MAX_SAMPLES) + 1)
    points = np.column_stack([times, law.position(times)])
    return _Packed(TRACK, speed, _NO_COURSE, points, pad_m=0.5 * speed * float(times[1]))
