"""Compiled kernels are found again as long as nothing they import has changed, and never after."""

import ast
import importlib
import os
import subprocess
import sys
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
    monkeypatch.setattr(jit, "_PACKAGES", ("cache_probe",))
    monkeypatch.setenv("SUITE_CACHE_DIR", str(tmp_path / "cache"))
    monkeypatch.syspath_prepend(str(tmp_path))
    (tmp_path / "cache_probe").mkdir()
    (tmp_path / "cache_probe" / "__init__.py").write_text("")
    (tmp_path / "cache_probe" / "callee.py").write_text(CALLEE.format(factor=2))
    (tmp_path / "cache_probe" / "caller.py").write_text(CALLER)
    jit.source_hash.cache_clear()
    yield tmp_path / "cache_probe"
    jit.source_hash.cache_clear()
    for name in [name for name in sys.modules if name.partition(".")[0] == "cache_probe"]:
        del sys.modules[name]


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


def test_libraries_that_are_installed_beside_the_project_are_not_followed(house: Path) -> None:
    (house / "user.py").write_text("from library.deep import thing\nfrom cache_probe.callee import factor\n")
    library = house.parent / "library"
    library.mkdir()
    (library / "__init__.py").write_text("")
    (library / "deep.py").write_text("thing = 1\n")
    assert jit._closure(house / "user.py") == {house / name for name in ("user.py", "callee.py")}


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


def test_the_cache_is_where_the_user_wants_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SUITE_CACHE_DIR", str(tmp_path / "somewhere" / "else"))
    assert jit.cache_folder() == tmp_path / "somewhere" / "else"
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


LITERALS = """
from scenarios.kernels.jit import kernel

@kernel
def power(x, n):
    product = 1.0
    for _ in range(n):
        product *= x
    return product

@kernel
def both(x, n):
    return power(x, 3) + power(x, 4) + power(x, n)
"""


def test_a_literal_in_a_call_makes_no_kernel_of_its_own(house: Path) -> None:
    (house / "literals.py").write_text(LITERALS)
    literals = importlib.import_module("cache_probe.literals")
    assert literals.both(2.0, 5) == 8 + 16 + 32
    assert len(literals.power.signatures) == 1


COMPILES = """
import sys, time
from pathlib import Path
import numpy as np
from planners.prediction._kernels import solve
here, other = map(Path, sys.argv[1:])
here.touch()
while not other.exists():
    time.sleep(0.01)
solve(np.eye(3, 4), 3, 0.0, np.empty((3, 3)), np.empty(3))
print(sum(solve.stats.cache_misses.values()))
"""


def test_two_processes_compile_a_kernel_once(tmp_path: Path) -> None:
    files = [str(tmp_path / name) for name in "ab"]
    environment = os.environ | {"SUITE_CACHE_DIR": str(tmp_path / "cache")}
    both = [
        subprocess.Popen([sys.executable, "-c", COMPILES, *order], env=environment, stdout=subprocess.PIPE, text=True)
        for order in (files, files[::-1])
    ]
    assert sum(int(process.communicate(timeout=300)[0]) for process in both) == 1


def test_where_files_cannot_be_locked_kernels_still_compile(house: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> None:
        raise OSError("no locks here")

    monkeypatch.setattr(jit.fcntl, "flock", refuse)
    assert importlib.import_module("cache_probe.caller").scaled(10) == 20


def says(folder: Path, *, environment: dict[str, str] | None = None) -> tuple[str, str]:
    """What a process finds ten times the factor to be, and what it says on the way."""
    given = {name: value for name, value in os.environ.items() if name not in {"SUITE_CACHE_DIR", "HOME"}}
    code = f"""
import sys
sys.path[:0] = {[str(folder.parent), *sys.path]!r}
from pathlib import Path
from scenarios.kernels import jit
jit._ROOT = Path({str(folder.parent)!r})
jit._PACKAGES = ("cache_probe",)
from cache_probe.caller import scaled
print(scaled(10))
"""
    done = subprocess.run(
        [sys.executable, "-c", code], env=given | (environment or {}), capture_output=True, text=True, check=True
    )
    return done.stdout.strip(), done.stderr


@pytest.mark.parametrize("how", ["a file", "no home"])
def test_a_cache_that_cannot_be_used_is_never_a_cache_without_the_key(house: Path, tmp_path: Path, how: str) -> None:
    (tmp_path / "file").touch()
    environment = {"SUITE_CACHE_DIR": str(tmp_path / "file")} if how == "a file" else {"HOME": str(tmp_path / "file")}
    answer, said = says(house, environment=environment)
    assert answer == "20"
    assert said.count("\n") == 1
    assert "SUITE_CACHE_DIR" in said
    assert not Path(said.rpartition(" ")[2].strip()).exists()
    (house / "callee.py").write_text(CALLEE.format(factor=101))
    assert says(house, environment=environment)[0] == "1010"
    assert not list(house.rglob("*.nbi"))


@pytest.mark.parametrize(("suffix", "size"), [(".nbi", 0), (".nbi", 30), (".nbc", 0), (".nbc", 100)])
def test_what_was_cut_off_is_compiled_again(house: Path, tmp_path: Path, suffix: str, size: int) -> None:
    environment = {"SUITE_CACHE_DIR": str(tmp_path / "cache")}
    assert says(house, environment=environment) == ("20", "")
    files = sorted((tmp_path / "cache").rglob(f"*{suffix}"))
    whole = [file.stat().st_size for file in files]
    assert len(files) == 2
    for file in files:
        file.write_bytes(file.read_bytes()[:size])
    assert says(house, environment=environment) == ("20", "")
    assert [file.stat().st_size for file in files] == whole


def test_machine_code_with_a_wrong_bit_is_not_run(house: Path, tmp_path: Path) -> None:
    environment = {"SUITE_CACHE_DIR": str(tmp_path / "cache")}
    assert says(house, environment=environment) == ("20", "")
    for file in (tmp_path / "cache").rglob("*.nbc"):
        code = bytearray(file.read_bytes())
        code[len(code) // 2] ^= 1
        file.write_bytes(code)
    assert says(house, environment=environment) == ("20", "")
