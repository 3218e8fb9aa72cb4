"""Arrays in a page: whole numbers of steps, differences of differences, deflated, base64."""

from __future__ import annotations

import base64
import zlib
from typing import Any

import numpy as np
import numpy.typing as npt

LEVELS = 2**16 - 1
TICK_S = 1e-6


def packed(values: npt.ArrayLike) -> dict[str, Any]:
    """Numbers of shape (T, ...) as a JSON object, each off by at most half of the 65535th part of their range.

    ``shape``, the smallest value ``low``, the ``step`` between neighbours and ``data``: second differences along the
    first axis, modulo 2**``bits``, in the order of memory; smooth motion has small ones, and these deflate well.
    """
    array = np.asarray(values, dtype=np.float64)
    low, high = (float(array.min()), float(array.max())) if array.size else (0.0, 0.0)
    return _packed(array, low, (high - low) / LEVELS or 1.0, 16)


def packed_times(times_s: npt.ArrayLike) -> dict[str, Any]:
    """Times (T,) of at most an hour [s], to the microsecond: where an arm jumps, a millisecond is a centimetre."""
    return _packed(np.asarray(times_s, dtype=np.float64), 0.0, TICK_S, 32)


def _packed(array: npt.NDArray[np.float64], low: float, step: float, bits: int) -> dict[str, Any]:
    levels = np.rint((array - low) / step).astype(np.int64)
    for _ in range(2):
        levels = np.diff(levels, axis=0, prepend=np.zeros_like(levels[:1]))
    raw = (levels % 2**bits).astype(f"<u{bits // 8}").tobytes()
    data = base64.b64encode(zlib.compress(raw, 9)).decode()
    return {"shape": list(array.shape), "low": low, "step": step, "bits": bits, "data": data}
