"""Compiled kernels are found again as long as nothing they import has changed, and never after."""

import ast
import importlib
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from numba.core.errors import NumbaError

from scenarios.arm import FloatArray
from scenarios.kernels import jit

CALLEE = """
from scenarios.kernels.jit import kernel

@kernel
def factor():
    return {factor}
"""
CALLER = """
from scenarios.kernels.jit import kernel
from cache_probe.callee import factor

@kernel
def scaled(x):
    return factor() * x
"""


@pytest.fixture
def house(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A house of two kernel files, one calling the other, with a cache of its own."""
    monkeypatch.setattr(jit, "_ROOT", tmp_path)
    monkeypatch.setenv("SUITE_CACHE_DIR", str(tmp_path / "cache"))
    monkeypatch.syspath_prepend(str(tmp_path))
    (tmp_path / "cache_probe").mkdir()
    (tmp_path / "cache_probe" / "__init__.py").write_text("")
    (tmp_path / "cache_probe" / "callee.py").write_text(CALLEE.format(factor=2))
    (tmp_path / "cache_probe" / "caller.py").write_text(CALLER)
    jit.source_hash.cache_clear()
    yield tmp_path / "cache_probe"
    jit.source_hash.cache_clear()


def test_an_edit_in_a_callee_elsewhere_is_seen(house: Path) -> None:
    callee = importlib.import_module("cache_probe.callee")
    caller = importlib.import_module("cache_probe.caller")
    assert caller.scaled(10) == 20
    (house / "callee.py").write_text(CALLEE.format(factor=101))
    jit.source_hash.cache_clear()  # as in a new process
    importlib.invalidate_caches()
    importlib.reload(callee)
    caller = importlib.reload(caller)
    assert caller.scaled(10) == 1010


def test_what_is_not_imported_does_not_count(house: Path) -> None:
    before = jit.source_hash(house / "caller.py")
    (house / "bystander.py").write_text("x = 1")
    jit.source_hash.cache_clear()
    assert jit.source_hash(house / "caller.py") == before
    assert jit.source_hash(house / "callee.py") != before


def test_kernel_files_import_in_the_one_way_that_the_hash_follows() -> None:
    # ``import package.module`` would go unseen.
    files = [*jit._ROOT.glob("scenarios/kernels/*.py"), *jit._ROOT.glob("*/**/_kernels.py")]
    assert len(files) > 5
    for file in files:
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                assert not {alias.name.split(".")[0] for alias in node.names} & {"scenarios", "planners", "suite"}
            if isinstance(node, ast.ImportFrom):
                assert node.level == 0, file


def test_the_cache_is_where_the_user_wants_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SUITE_CACHE_DIR", "/somewhere/else")
    assert jit.cache_folder() == Path("/somewhere/else")
    monkeypatch.delenv("SUITE_CACHE_DIR")
    assert jit.cache_folder().name == "continuum-arm-suite"


def test_a_bare_kernel_makes_no_array() -> None:
    def last_row(rows: FloatArray) -> float:
        total = 0.0
        for value in rows[-1]:
            total += value
        return total

    def doubled_sum(rows: FloatArray) -> float:
        return float((2.0 * rows).sum())

    rows = np.arange(6.0).reshape(2, 3)
    assert jit.bare_kernel(last_row)(rows) == 12.0
    with pytest.raises(NumbaError, match="NRT"):
        jit.bare_kernel(doubled_sum)(rows)
