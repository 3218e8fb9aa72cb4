"""Files of backbone points: untrusted, so checked and bounded."""

from __future__ import annotations

import zipfile
from pathlib import Path
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from scenarios.errors import UserError
from scenarios.reading import open_regular
from suite.errors import SuiteError

MAX_BYTES = 1024**3
"""Of all arrays, unpacked."""


class BackbonePoints(NamedTuple):
    """A motion as points along the backbone."""

    times_s: npt.NDArray[np.float64]
    """Shape (T,)."""
    points_m: npt.NDArray[np.float64]
    """Shape (T, N, 3), base first."""
    radius_m: float


def read_points(file: Path) -> BackbonePoints:
    """Read an NPZ with ``time_s`` (T,), ``points_m`` (T, N, 3) and ``radius_m``.

    Raises:
        FileError: The file cannot be opened or is too large.
        SuiteError: It is no NPZ, or holds something else.
    """
    try:
        with open_regular(file, MAX_BYTES) as handle, zipfile.ZipFile(handle) as packed:
            size = sum(part.file_size for part in packed.infolist())
            if size > MAX_BYTES:
                raise SuiteError(f"{file}: found {size} bytes of arrays, allowed {MAX_BYTES}")
            handle.seek(0)
            arrays = np.load(handle, allow_pickle=False)
            missing = [name for name in ("time_s", "points_m", "radius_m") if name not in arrays]
            if missing:
                raise SuiteError(f"{file}: found no array {missing[0]}, allowed time_s, points_m and radius_m")
            times, points, radius = (np.asarray(arrays[name]) for name in ("time_s", "points_m", "radius_m"))
    except UserError:
        raise
    except (OSError, ValueError, zipfile.BadZipFile, EOFError, NotImplementedError, RuntimeError) as error:
        raise SuiteError(f"{file}: cannot be read as an NPZ: {error}"[:300]) from None
    if not all(array.dtype.kind in "fiu" for array in (times, points, radius)):
        raise SuiteError(f"{file}: found arrays of other things than numbers, allowed numbers")
    if times.ndim != 1 or not len(times) or points.shape[:1] != times.shape or points.shape[2:] != (3,):
        raise SuiteError(f"{file}: found shapes {times.shape} and {points.shape}, allowed (T,) and (T, N, 3)")
    if points.shape[1] < 2:
        raise SuiteError(f"{file}: points_m: found {points.shape[1]} points a frame, allowed two or more")
    if radius.size != 1 or not 0.0 < float(radius.reshape(())) <= 100.0:
        raise SuiteError(f"{file}: radius_m: found {radius.tolist()!r:.60}, allowed one number above 0, up to 100")
    return BackbonePoints(times.astype(np.float64), points.astype(np.float64), float(radius.reshape(())))
