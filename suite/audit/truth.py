"""The obstacles' true motion, packed into plain arrays for the audit's kernels."""

import math
from collections.abc import Sequence
from typing import NamedTuple, Protocol

import numpy as np
import numpy.typing as npt

from scenarios import Orbit, Scenario, Track
from suite.audit._kernels import ORBIT, TRACK

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
    """m spheres on their laws; an orbit is a row of ``orbits``, a track a span of rows of ``points``."""

    radii_m: FloatArray
    """Radii, shape (m,), [m]."""
    speeds_m_s: FloatArray
    """Largest speeds, shape (m,)."""
    laws: npt.NDArray[np.int64]
    """ORBIT or TRACK, shape (m,)."""
    orbits: FloatArray
    """Centre, cosine and sine amplitudes [m], rate [rad/s]; shape (m, 10)."""
    points: FloatArray
    """Time [s] and position [m], straight in between, shape (P, 4)."""
    spans: npt.NDArray[np.int64]
    """First row of ``points`` and the one after the last, shape (m, 2)."""


class _Packed(NamedTuple):
    """One obstacle's share of a ``Truth``."""

    law: int
    speed_m_s: float
    orbit: FloatArray
    points: FloatArray
    pad_m: float = 0.0


_NO_ORBIT = np.zeros(10)
_NO_POINTS = np.empty((0, 4))


def pack(scenario: Scenario) -> Truth:
    """Pack the obstacles of ``scenario``, exact at every instant; a law without a kernel is resampled with a pad."""
    radii = [obstacle.radius_m for obstacle in scenario.obstacles]
    packed = [pack_law(obstacle.motion, scenario.time_limit_s) for obstacle in scenario.obstacles]
    return assemble(radii, packed)


def assemble(radii_m: Sequence[float], packed: Sequence[_Packed]) -> Truth:
    """Put packed obstacles behind one another."""
    ends = np.cumsum([0, *(len(one.points) for one in packed)])
    return Truth(
        radii_m=np.array([radius + one.pad_m for radius, one in zip(radii_m, packed, strict=True)]),
        speeds_m_s=np.array([one.speed_m_s for one in packed], dtype=np.float64),
        laws=np.array([one.law for one in packed], dtype=np.int64),
        orbits=np.array([one.orbit for one in packed]).reshape(-1, 10),
        points=np.concatenate([_NO_POINTS, *(one.points for one in packed)]),
        spans=np.stack([ends[:-1], ends[1:]], axis=1),
    )


def pack_law(law: Law, end_s: float) -> _Packed:
    """Pack one law of motion, to be followed until ``end_s`` [s]."""
    if isinstance(law, Orbit):
        return _orbit(law)
    if isinstance(law, Track):
        points = np.column_stack([law.times_s, law.positions_m])
        return _Packed(TRACK, law.speed_bound_m_s, _NO_ORBIT, points)
    return _resampled(law, end_s)


def _orbit(law: Orbit) -> _Packed:
    """The circle's two amplitudes, read off the law itself at t = 0 and a quarter turn later."""
    rate = law.rate_rad_s if abs(law.rate_rad_s) > _AT_REST_RAD_S else 0.0
    quarter_s = 0.5 * math.pi / rate if rate else 0.0
    center = np.asarray(law.center_m)
    amplitudes = law.position(np.array([0.0, quarter_s])) - center
    row = np.concatenate([center, amplitudes.reshape(-1), [rate]])
    return _Packed(ORBIT, law.speed_bound_m_s, row, _NO_POINTS)


def _resampled(law: Law, end_s: float) -> _Packed:
    """A track through samples of ``law``: between two of them a motion of bounded speed strays at most v * step / 2."""
    speed = law.speed_bound_m_s
    wanted = math.ceil(0.5 * speed * end_s / _RESAMPLING_ERROR_M)
    times = np.linspace(0.0, end_s, min(max(wanted, 1), _MAX_SAMPLES) + 1)
    points = np.column_stack([times, law.position(times)])
    return _Packed(TRACK, speed, _NO_ORBIT, points, pad_m=0.5 * speed * float(times[1]))
