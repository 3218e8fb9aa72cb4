"""The one numba decorator of the house.

Numba's file cache looks only at the file that holds a function: an edit in a callee elsewhere leaves the caller's
stale machine code in use. The cache folder is therefore named by a hash of every kernel source, so that any edit
starts a fresh folder.
"""

import hashlib
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba
import platformdirs

_ROOT = Path(__file__).resolve().parents[2]
_KERNEL_SOURCES = ("scenarios/kernels/*.py", "planners/**/_kernels.py", "suite/**/_kernels.py")


def cache_folder() -> Path:
    """Folder for compiled kernels and enumerated spaces; ``SUITE_CACHE_DIR`` overrides the user's cache folder."""
    override = os.environ.get("SUITE_CACHE_DIR")
    return Path(override) if override else Path(platformdirs.user_cache_dir("continuum-arm-suite"))


def kernel_hash() -> str:
    """Hash of all kernel sources and of numba's version, 16 hexadecimal digits."""
    digest = hashlib.sha256(numba.__version__.encode())
    for pattern in _KERNEL_SOURCES:
        for source in sorted(_ROOT.glob(pattern)):
            digest.update(source.read_bytes())
    return digest.hexdigest()[:16]


# Must be set before the first decoration: numba fixes a function's cache path when it is decorated.
_config: Any = numba.config
_config.CACHE_DIR = str(cache_folder() / "kernels" / kernel_hash())


def kernel(function: Callable[..., Any]) -> Callable[..., Any]:
    """Compile ``function`` in nopython mode, cached on disk.

    No ``fastmath``: it breaks NaN checks and lets verdicts differ between machines.
    """
    compiled: Callable[..., Any] = numba.njit(cache=True, fastmath=False, error_model="numpy")(function)
    return compiled
