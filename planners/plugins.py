"""Planners from outside: a class in a file, in an installed module, or offered by an installed distribution.

A reference is ``path/to/file.py:Class``, ``package.module:Class`` or the name of an entry point in ``GROUP``. Importing
one runs its author's code, so the suite does that in processes of its own (``planners.isolation``); here it is done.
"""

from __future__ import annotations

import ast
import functools
import hashlib
import importlib
import importlib.util
import inspect
import sys
from collections.abc import Iterable
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from types import ModuleType
from typing import TypeGuard

from planners.base import ArmPlanner
from scenarios.spec import SpecError

GROUP = "continuum_arm_suite.planners"
"""Entry-point group in which a distribution offers planners."""
MAX_SOURCE_BYTES = 10_000_000


def is_reference(name: str) -> bool:
    """Whether a planner's name says where its class is, as ``file.py:Class`` or ``package.module:Class``."""
    return ":" in name


def offered() -> dict[str, EntryPoint]:
    """Entry points that installed distributions offer, by name; nothing is loaded."""
    return {entry.name: entry for entry in sorted(entry_points(group=GROUP), key=lambda entry: entry.name)}


HERE = "here"
"""Place of the classes that this process has offered."""
_OFFERED_HERE: dict[str, type[ArmPlanner]] = {}


def offer(planner: type[ArmPlanner]) -> str:
    """Make a class known in this process alone, as one from a notebook has to be; its reference."""
    _OFFERED_HERE[planner.__name__] = planner
    return f"{HERE}:{planner.__name__}"


def is_here(name: str) -> bool:
    """Whether a reference is to a class that this process has offered."""
    return name.startswith(f"{HERE}:") and name.partition(":")[2] in _OFFERED_HERE


def resolved(name: str) -> str:
    """The same reference, with the file's full path: it means the same in any folder.

    Raises:
        SpecError: There is no such file, or no class is named.
    """
    place, _, class_name = name.rpartition(":")
    if not (place and class_name.isidentifier()):
        raise SpecError(f"planner: found {name!r}, allowed file.py:Class or package.module:Class")
    if not place.endswith(".py"):
        return name
    file = Path(place).expanduser().resolve()
    if not file.is_file():
        raise SpecError(f"planner: found no file {place!r}, allowed file.py:Class with a file that is there")
    if file.stat().st_size > MAX_SOURCE_BYTES:
        raise SpecError(f"planner: found {place!r} of more than {MAX_SOURCE_BYTES} bytes, allowed a source file")
    return f"{file}:{class_name}"


def load_class(name: str) -> type[ArmPlanner]:
    """Import the class behind a reference or an entry point; whatever its module raises goes through.

    Raises:
        SpecError: The module has no such class, or what is there is no planner.
    """
    place, _, class_name = _target(name).rpartition(":")
    if is_here(name):
        return _OFFERED_HERE[class_name]
    found = getattr(_module(place), class_name, None)
    if found is None:
        known = [key for key, value in vars(_module(place)).items() if _is_planner(value) and value is not ArmPlanner]
        allowed = ", ".join(known) or "none that is there"
        raise SpecError(f"planner: found no class {class_name!r} in {place}, allowed {allowed}")
    if not _is_planner(found):
        raise SpecError(f"planner: found {class_name!r} in {place}, allowed a class derived from planners.ArmPlanner")
    return found


def code_hash(name: str) -> str:
    """16 hexadecimal digits of the sources behind a reference or an entry point; nothing is imported.

    Of a file: itself and what it imports from beside it. Of a module: all sources of its top-level package.

    Raises:
        SpecError: There is no such module.
    """
    place, _, class_name = _target(name).rpartition(":")
    if is_here(name):
        return _hash_here(_OFFERED_HERE[class_name])
    return _IMPORTED[place] if place in _IMPORTED else _hash(sources(place))


def _hash_here(planner: type[ArmPlanner]) -> str:
    """The same of a class in this process; of one whose source is nowhere, of its name alone."""
    try:
        source = inspect.getsource(planner)
    except (OSError, TypeError):
        source = planner.__qualname__
    return hashlib.sha256(source.encode()).hexdigest()[:16]


def _target(name: str) -> str:
    """``place:Class`` of a reference or an entry point."""
    return name if is_reference(name) else offered()[name].value


def _is_planner(value: object) -> TypeGuard[type[ArmPlanner]]:
    return isinstance(value, type) and issubclass(value, ArmPlanner)


_IMPORTED: dict[str, str] = {}
"""Hashes of the modules that this process has imported by name: it goes on with what they were then."""


def _module(place: str) -> ModuleType:
    """The module of a file, as the file now is, or one by its name.

    Raises:
        SpecError: There is no module of that name.
    """
    if place.endswith(".py"):
        return _file_module(place, _hash(sources(place)))
    found = sources(place)
    try:
        module = importlib.import_module(place)
    except ModuleNotFoundError as error:
        if error.name is None or not f"{place}.".startswith(f"{error.name}."):
            raise
        raise SpecError(f"planner: found no module {place!r}, allowed one that is installed or beside you") from None
    _IMPORTED.setdefault(place, _hash(found))
    return module


@functools.lru_cache(maxsize=64)
def _file_module(place: str, code: str) -> ModuleType:
    """Import a file in the state ``code`` under a name of its own; what stands beside it can be imported there."""
    del code
    file = Path(place)
    name = f"continuum_arm_suite_plugin_{file.stem}_{hashlib.sha256(place.encode()).hexdigest()[:8]}"
    spec = importlib.util.spec_from_file_location(name, file)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    _append_path(str(file.parent))
    _forget(_closure(file))
    sys.modules[name] = module  # pickle and dataclasses look a class's module up by its name
    try:
        spec.loader.exec_module(module)
    except BaseException:
        del sys.modules[name]
        raise
    return module


def _forget(sources: set[Path]) -> None:
    """Have what a file imports from beside it imported anew: in a notebook that may have been edited as well."""
    importlib.invalidate_caches()
    for name, module in list(sys.modules.items()):
        if getattr(module, "__file__", None) and Path(str(module.__file__)) in sources:
            del sys.modules[name]


def _append_path(folder: str) -> None:
    """Last, so that nothing there hides what is installed."""
    if folder not in sys.path:
        sys.path.append(folder)


def sources(place: str) -> list[Path]:
    """The sources behind a file or a module: what is hashed, and what another machine needs."""
    return sorted(_closure(Path(place)) if place.endswith(".py") else _package_sources(place))


def _hash(sources: Iterable[Path]) -> str:
    digest = hashlib.sha256()
    for source in sources:
        digest.update(source.name.encode() + b"\0" + source.read_bytes() + b"\0")
    return digest.hexdigest()[:16]


def _closure(file: Path) -> set[Path]:
    """A file and the files beside it, or in folders beside it, that it imports, directly or not."""
    found: set[Path] = set()
    pending = {file}
    while pending:
        source = pending.pop()
        found.add(source)
        try:
            tree = ast.parse(source.read_bytes())
        except (SyntaxError, ValueError):
            continue  # importing it will say so
        pending |= {path for name in _imports(tree) for path in _files(file.parent, name)} - found
    return found


def _imports(tree: ast.AST) -> list[str]:
    names = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            names += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module:
            names += [node.module, *(f"{node.module}.{alias.name}" for alias in node.names)]
    return names


def _files(folder: Path, module: str) -> list[Path]:
    path = folder.joinpath(*module.split("."))
    return [file for file in (path.with_suffix(".py"), path / "__init__.py") if file.is_file()]


def _package_sources(module: str) -> list[Path]:
    top = module.partition(".")[0]
    _append_path(str(Path.cwd()))
    try:
        spec = importlib.util.find_spec(top)
    except (ImportError, ValueError):
        spec = None
    if spec is None:
        raise SpecError(f"planner: found no module {module!r}, allowed one that is installed or beside you")
    folders = spec.submodule_search_locations
    if folders:
        return [file for folder in folders for file in Path(folder).rglob("*.py")]
    return [Path(spec.origin)] if spec.origin and Path(spec.origin).is_file() else []
