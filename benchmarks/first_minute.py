"""The first run of a new user, the second, and a run of one trial, beside those of an earlier commit."""

from __future__ import annotations

import io
import os
import resource
import subprocess
import sys
import tarfile
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

from benchmarks.timing import Line

BASELINE = "f727b6d"
"""The commit before the warm-up was divided among the workers."""
ROOT = Path(__file__).resolve().parents[1]
MANY = ("--planners", "temporal,rrt,pf")
ONE = ("--planners", "pf", "--obstacles", "1", "--trials", "1")


class Spent(NamedTuple):
    """What a command took."""

    wall_s: float
    cpu_s: float


def first_minute(quick: bool) -> list[Line]:
    """Whole commands, the two versions in turns, each with a cache of its own; the least of several where warm.

    Raises:
        SystemExit: Git does not know the baseline.
    """
    runs = {"empty cache": (MANY, 1), "warm": (MANY, 1 if quick else 3), "one trial, warm": (ONE, 3 if quick else 5)}
    lines = []
    with tempfile.TemporaryDirectory() as name:
        scratch = Path(name)
        sources = {"here": ROOT, "baseline": _baseline(scratch / "sources")}
        for title, (options, times) in runs.items():
            spent: dict[str, list[Spent]] = {version: [] for version in sources}
            for _ in range(times):
                for version, source in sources.items():
                    spent[version].append(_run(source, scratch / version, options))
            wall, cpu = ({v: min(getattr(s, field) for s in spent[v]) for v in sources} for field in Spent._fields)
            lines += [
                Line(f"{title}: wall", wall["here"], "s"),
                Line(f"{title}: processor time", cpu["here"], "s"),
                Line(f"{title}: {BASELINE} / here, wall", wall["baseline"] / wall["here"], "x"),
                Line(f"{title}: {BASELINE} / here, processor time", cpu["baseline"] / cpu["here"], "x"),
            ]
    return lines


def _baseline(folder: Path) -> Path:
    """The sources of the baseline in ``folder``."""
    archive = subprocess.run(["git", "archive", BASELINE], cwd=ROOT, capture_output=True, check=False)
    if archive.returncode:
        raise SystemExit(f"baseline: git does not know {BASELINE}, allowed: a clone with its history")
    with tarfile.open(fileobj=io.BytesIO(archive.stdout)) as tar:
        tar.extractall(folder, filter="data")
    return folder


def _run(source: Path, cache: Path, options: tuple[str, ...]) -> Spent:
    """Run the suite of ``source`` as a command, as its installed script would."""
    environment = os.environ | {"SUITE_CACHE_DIR": str(cache), "PYTHONPATH": str(source)}
    before, started = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "suite", "run", *options, "--out", f"{folder}/run"]
        subprocess.run(command, cwd=folder, env=environment, check=True, capture_output=True)
    wall_s, after = time.perf_counter() - started, resource.getrusage(resource.RUSAGE_CHILDREN)
    return Spent(wall_s, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
