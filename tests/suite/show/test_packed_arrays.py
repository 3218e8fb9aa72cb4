import base64
import zlib

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from suite.show.replay.packed import packed, packed_times


def unpacked(said: dict) -> np.ndarray:
    """The slow twin of web/unpack.js."""
    raw = np.frombuffer(zlib.decompress(base64.b64decode(said["data"])), dtype=f"<u{said['bits'] // 8}").astype(
        np.int64
    )
    levels = raw.reshape(said["shape"])
    for _ in range(2):
        levels = np.cumsum(levels, axis=0)
    return said["low"] + said["step"] * (levels % 2 ** said["bits"])


@given(
    arrays.arrays(
        np.float64,
        arrays.array_shapes(min_dims=1, max_dims=3, min_side=0, max_side=6),
        elements=st.floats(-1e3, 1e3, allow_nan=False),
    )
)
def test_numbers_come_back_to_half_a_step(values: np.ndarray) -> None:
    said = packed(values)
    assert list(values.shape) == said["shape"]
    back = unpacked(said)
    span = float(np.ptp(values)) if values.size else 0.0
    assert np.abs(back - values).max(initial=0.0) <= 0.5 * span / 65535 + 1e-9


def test_smooth_motion_takes_a_byte_a_number() -> None:
    times = np.arange(500)
    values = np.stack([np.sin(0.01 * times + k) for k in range(9)], axis=1)
    assert len(packed(values)["data"]) < 1.4 * values.size


def test_times_come_back_to_the_microsecond() -> None:
    times = np.concatenate([0.1 * np.arange(30_000), [3600.0]])
    said = packed_times(times)
    assert np.abs(unpacked(said) - times).max() <= 0.5e-6 + 1e-9
    assert len(said["data"]) < 2000
