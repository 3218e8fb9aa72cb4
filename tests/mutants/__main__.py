"""Try every mutant, or those whose names hold a given word: ``python -m tests.mutants [WORD ...]``.

Each is made in a copy of the sources, where its tests run. It is killed when they fail. The copy is always in the same
place, so that kernels it does not change come out of the cache.
"""

import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterable
from pathlib import Path

from .table import MUTANTS, Mutant

ROOT = Path(__file__).resolve().parents[2]
COPY = ROOT / ".mutants"
COPIED = ("scenarios", "planners", "suite", "tests", "results", "pyproject.toml")
HANGS_AFTER_S = 900.0
PASSED, FAILED = 0, 1
"""Exit codes of pytest; any other says that the tests named could not be run."""


def main(words: list[str]) -> int:
    """Print a line per mutant and return 0 when all are killed."""
    chosen = [mutant for mutant in MUTANTS if not words or any(word in mutant.name for word in words)]
    if not chosen:
        sys.exit(f"mutants: found none whose name holds {' or '.join(words)}")
    try:
        COPY.mkdir()
    except FileExistsError:
        sys.exit(f"mutants: found {COPY}, allowed one run at a time: remove it when none is under way")
    try:
        for name in COPIED:
            copy = shutil.copytree if (ROOT / name).is_dir() else shutil.copy2
            copy(ROOT / name, COPY / name)
        tests = dict.fromkeys(test for mutant in chosen for test in mutant.tests)
        if run(tests) != PASSED:
            print("FAILS     without any change", flush=True)
            return 1
        return max(try_out(mutant) for mutant in chosen)
    finally:
        shutil.rmtree(COPY)


def try_out(mutant: Mutant) -> int:
    """Apply a mutant, run its tests, take it back; 0 when it was killed."""
    source = COPY / mutant.file
    text = source.read_text(encoding="utf-8") if source.is_file() else ""
    started = time.perf_counter()
    if text.count(mutant.old) != 1:
        verdict = "GONE"
    else:
        source.write_text(text.replace(mutant.old, mutant.new), encoding="utf-8")
        code = run(mutant.tests)
        shutil.copy2(ROOT / mutant.file, source)  # with its date, by which compiled code is known
        verdict = {PASSED: "SURVIVED", FAILED: "killed"}.get(code, "NOT RUN")
    print(f"{verdict:8} {time.perf_counter() - started:6.0f} s  {mutant.name}", flush=True)
    return 0 if verdict == "killed" else 1


def run(tests: Iterable[str]) -> int:
    """Exit code of pytest in the copy; a mutant that makes its tests hang has made them fail."""
    call = [sys.executable, "-m", "pytest", "-x", "-q", "--no-header", "-p", "no:cacheprovider", *tests]
    environment = os.environ | {"PYTHONDONTWRITEBYTECODE": "1", "PYTHONPATH": str(COPY)}
    process = subprocess.Popen(
        call, cwd=COPY, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True
    )
    try:
        return process.wait(HANGS_AFTER_S)
    except subprocess.TimeoutExpired:
        return FAILED
    finally:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()


sys.exit(main(sys.argv[1:]))
