"""The numba decorators of the house.

Numba's file cache looks only at the file that holds a function: an edit in a callee elsewhere leaves the caller's
stale machine code in use. The cache folder of a kernel is therefore named by a hash of its file and of every file of
ours that it imports, directly or not.

A kernel is compiled by one process at a time: whoever needs it meanwhile waits and then loads it, so that processes
which start with different kernels share the work.
"""

import ast
import fcntl
import functools
import hashlib
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import numba
import platformdirs
from numba.core.compiler_lock import global_compiler_lock

_ROOT = Path(__file__).resolve().parents[2]


def cache_folder() -> Path:
    """Folder for compiled kernels and enumerated spaces; ``SUITE_CACHE_DIR`` overrides the user's cache folder."""
    override = os.environ.get("SUITE_CACHE_DIR")
    return Path(override) if override else Path(platformdirs.user_cache_dir("continuum-arm-suite"))


@functools.lru_cache
def source_hash(file: Path) -> str:
    """Hash of a source file, of all files of this project that it imports, and of numba's version: 16 hex digits."""
    digest = hashlib.sha256(numba.__version__.encode())
    for source in sorted(_closure(file)):
        digest.update(source.read_bytes())
    return digest.hexdigest()[:16]


def _closure(file: Path) -> set[Path]:
    """The file and every file of this project reachable from it by imports."""
    found: set[Path] = set()
    pending = {file.resolve()}
    while pending:
        source = pending.pop()
        found.add(source)
        for package, imported in _imports(source.read_bytes()):
            module = _ROOT.joinpath(*package.split("."))
            names = [module / name for name in imported]  # ``from package import module``
            files = [module / "__init__.py", *(path.with_suffix(".py") for path in (module, *names))]
            pending |= {path for path in files if path.is_file()} - found
    return found


@functools.lru_cache(maxsize=256)  # most files are imported by many kernels' files
def _imports(source: bytes) -> list[tuple[str, list[str]]]:
    """Modules from which a source imports, and the names that it imports from each."""
    nodes = [node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.ImportFrom)]
    return [(node.module, [alias.name for alias in node.names]) for node in nodes if node.module]


def kernel(function: Callable[..., Any]) -> Callable[..., Any]:
    """Compile ``function`` in nopython mode, cached on disk.

    No ``fastmath``: it breaks NaN checks and lets verdicts differ between machines.
    """
    return _compile(function)


def bare_kernel(function: Callable[..., Any]) -> Callable[..., Any]:
    """The same for a kernel that makes no arrays, which numba then refuses it; views are no new arrays.

    Without numba's runtime no references are counted. With it every array out of a named tuple and every view costs
    two atomic operations, which were some 10 % of temporal-ct's searches.
    """
    return _compile(function, _nrt=False)


def _compile(function: Callable[..., Any], **options: bool) -> Callable[..., Any]:
    # Numba fixes a function's cache path when it decorates the function.
    config: Any = numba.config
    config.CACHE_DIR = str(cache_folder() / "kernels" / source_hash(Path(function.__code__.co_filename)))
    njit: Any = numba.njit  # its types do not know ``_nrt``
    compiled = njit(cache=True, fastmath=False, error_model="numpy", **options)(function)
    compiled.compile = functools.partial(_compile_once, compiled)
    return compiled


def _compile_once(dispatcher: Any, signature: tuple[Any, ...]) -> Any:
    """Numba's own ``compile``, but for one process at a time, and never for the value of an argument.

    A literal in a call, such as the 3 of ``invert(a, 3)``, would have the kernel compiled once more, just for it.
    """
    plain = tuple(numba.types.unliteral(argument) for argument in signature)
    with global_compiler_lock, _turn(dispatcher):  # in this order in every thread
        return type(dispatcher).compile(dispatcher, plain)


_held: set[Path] = set()


@contextmanager
def _turn(dispatcher: Any) -> Iterator[None]:
    """Wait until no other process compiles this kernel; where nothing can be written, nothing is shared either."""
    function = dispatcher.py_func
    file = Path(dispatcher._cache.cache_path) / f"{function.__qualname__}-{function.__code__.co_firstlineno}.lock"
    if file in _held:
        yield
        return
    handle = None
    with suppress(OSError):
        file.parent.mkdir(parents=True, exist_ok=True)
        handle = os.open(file, os.O_RDWR | os.O_CREAT, 0o666)
        fcntl.flock(handle, fcntl.LOCK_EX)  # a process that dies lets go
    _held.add(file)
    try:
        yield
    finally:
        _held.discard(file)
        if handle is not None:
            os.close(handle)
