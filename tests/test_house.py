"""Rules of the house that no linter knows."""

import ast
import importlib
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).resolve().parents[1]
PACKAGES = ("scenarios", "planners", "suite")
SOURCES = sorted(path for package in PACKAGES for path in (ROOT / package).rglob("*.py"))
ALL_FILES = SOURCES + sorted(
    path for folder in ("tests", "benchmarks", "docs") for path in (ROOT / folder).rglob("*.py")
)
KERNEL_FILES = [
    path
    for path in SOURCES
    if path.name == "_kernels.py" or (path.parent.name == "kernels" and path.name not in ("__init__.py", "jit.py"))
]


def name_of(path: Path) -> str:
    return str(path.relative_to(ROOT))


@pytest.mark.parametrize("path", ALL_FILES, ids=name_of)
def test_no_file_is_longer_than_400_lines(path: Path) -> None:
    assert len(path.read_text(encoding="utf-8").splitlines()) <= 400


@pytest.mark.parametrize("path", KERNEL_FILES, ids=name_of)
def test_every_function_of_a_kernel_file_wears_a_decorator_of_the_house(path: Path) -> None:
    tree = ast.parse(path.read_text(encoding="utf-8"))
    functions = [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)]
    assert functions
    for function in functions:
        (decorator,) = map(ast.unparse, function.decorator_list)
        assert decorator in {"kernel", "bare_kernel"}, function.name


@pytest.mark.parametrize("path", SOURCES, ids=name_of)
def test_numba_is_imported_in_one_file_only(path: Path) -> None:
    if path == ROOT / "scenarios" / "kernels" / "jit.py":
        return
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        imported = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
        imported += [node.module or ""] if isinstance(node, ast.ImportFrom) else []
        assert not any(name.split(".")[0] == "numba" for name in imported), f"line {node.lineno}"


def kind(name: str) -> int:
    """Constants, then classes, then functions: the order of Ruff's RUF022."""
    return 0 if name.isupper() else 1 if name[0].isupper() else 2


@pytest.mark.parametrize("package", ["scenarios", "planners"])
def test_the_public_names_are_sorted_complete_and_there(package: str) -> None:
    module = importlib.import_module(package)
    public = [
        name for name, value in vars(module).items() if not name.startswith("_") and not isinstance(value, ModuleType)
    ]
    assert module.__all__ == sorted(public, key=lambda name: (kind(name), name))


@pytest.mark.parametrize("path", [path for path in SOURCES if path.name == "__init__.py"], ids=name_of)
def test_what_a_package_promises_it_has(path: Path) -> None:
    module = importlib.import_module(".".join(path.parent.relative_to(ROOT).parts))
    for name in getattr(module, "__all__", []):
        assert hasattr(module, name), name
