"""The numba decorators of the house.

Numba's file cache looks only at the file that holds a function: an edit in a callee elsewhere leaves the caller's
stale machine code in use. The cache folder of a kernel is therefore named by a hash of its file and of every file of
ours that it imports, directly or not.

A kernel is compiled by one process at a time: whoever needs it meanwhile waits and then loads it, so that processes
which start with different kernels share the work.
"""

import ast
import atexit
import fcntl
import functools
import hashlib
import os
import pickle
import shutil
import stat
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import numba
import platformdirs
from numba.core.caching import IndexDataCacheFile, NullCache
from numba.core.compiler_lock import global_compiler_lock

DIGEST_BYTES = 32
_ROOT = Path(__file__).resolve().parents[2]
_PACKAGES = ("scenarios", "planners", "suite", "tests", "benchmarks")
"""Packages of this project. Installed, they have every library beside them, which would take minutes to follow."""


def cache_folder() -> Path:
    """Folder for compiled kernels and enumerated spaces; ``SUITE_CACHE_DIR`` overrides the user's cache folder.

    Where neither can be used it is a temporary one, which this process says and its workers share.
    """
    override = os.environ.get("SUITE_CACHE_DIR")
    return _usable(Path(override or platformdirs.user_cache_dir("continuum-arm-suite")).absolute())


@functools.cache
def _usable(wanted: Path) -> Path:
    try:
        wanted.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=wanted) as probe:
            probe.write(b"is there room")
    except OSError as error:
        folder = _temporary()
        reason = f"cannot be used for compiled code: {error.strerror}"
        sys.stderr.write(f"suite: {wanted}: {reason}; set SUITE_CACHE_DIR to a folder that can. Until then: {folder}\n")
        return folder
    return wanted


def _temporary() -> Path:
    """A folder that goes with the process that made it; ``SUITE_CACHE_FALLBACK`` tells workers where it is."""
    name = os.environ.get("SUITE_CACHE_FALLBACK", f"continuum-arm-suite-{os.getpid()}")
    folder = Path(tempfile.gettempdir(), Path(name).name)
    folder.mkdir(mode=0o700, exist_ok=True)
    found = folder.lstat()
    if not stat.S_ISDIR(found.st_mode) or found.st_uid != os.geteuid():  # somebody else's, who may put anything there
        folder = Path(tempfile.mkdtemp(prefix="continuum-arm-suite-"))
    if "SUITE_CACHE_FALLBACK" not in os.environ:
        atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return folder


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
            if package.partition(".")[0] not in _PACKAGES:
                continue
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
    if config.DISABLE_JIT:  # a way of Numba's to look at what a kernel does: it is the function itself
        return function
    if Path(compiled._cache.cache_path).is_relative_to(config.CACHE_DIR):
        compiled._cache._cache_file.__class__ = _CheckedFile
    else:  # beside the source, where Numba goes next, a kernel would be found whatever it calls
        compiled._cache = NullCache()
    compiled.compile = functools.partial(_compile_once, compiled)
    return compiled


class _CheckedFile(IndexDataCacheFile):
    """A kernel's index and machine code in the cache: what is damaged is not there, what cannot be kept is not kept."""

    def load(self, key: Any) -> Any:
        """What was saved under ``key``; None if that is not to be had."""
        try:
            return super().load(key)
        except Exception:  # noqa: BLE001  unpickling what was cut off raises anything
            return None

    def save(self, key: Any, data: Any) -> None:
        """Keep ``data`` under ``key``."""
        with suppress(OSError):
            try:
                self._load_index()
            except Exception:  # noqa: BLE001  as above
                Path(self._index_path).unlink(missing_ok=True)
            super().save(key, data)

    def _dump(self, content: Any) -> bytes:
        pickled: bytes = super()._dump(content)
        return pickled + hashlib.sha256(pickled).digest()

    def _load_data(self, name: str) -> Any:
        """Machine code with one wrong bit would run."""
        whole = Path(self._data_path(name)).read_bytes()
        pickled, digest = whole[:-DIGEST_BYTES], whole[-DIGEST_BYTES:]
        if hashlib.sha256(pickled).digest() != digest:
            raise ValueError(f"{name}: damaged")
        return pickle.loads(pickled)


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
    if isinstance(dispatcher._cache, NullCache):
        yield
        return
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
