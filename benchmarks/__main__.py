"""Print every figure of ``docs/performance.md``: ``python -m benchmarks [--quick] [part ...]``."""

from __future__ import annotations

import argparse
import os
import platform
import sys

for library in ("OMP", "OPENBLAS", "MKL"):
    os.environ.setdefault(f"{library}_NUM_THREADS", "1")  # before NumPy is loaded: figures are per core


def main() -> None:
    """Run the parts asked for, all by default."""
    from benchmarks.boundary import boundary
    from benchmarks.cluster import against_local
    from benchmarks.continuous import solve_times
    from benchmarks.first_minute import first_minute
    from benchmarks.gate import gate
    from benchmarks.planning import against_literal, growth
    from benchmarks.proofs import possible, soundness
    from benchmarks.scale import scale
    from benchmarks.strrt import against_ompl
    from benchmarks.suite_runs import memory, step, throughput
    from benchmarks.timing import render
    from benchmarks.validity import validity

    parts = {
        "literal": ("Temporal planner against the literal reading of Algorithms 1 and 2", against_literal),
        "validity": ("State validity: default arm, 6 spheres, one core", validity),
        "boundary": ("The OMPL boundary", boundary),
        "growth": ("Construction of the temporal graph", growth),
        "continuous": ("Solve times of temporal-ct, seed 0, n = 1, 3, 5, 6", solve_times),
        "throughput": ("The suite", throughput),
        "step": ("What a step of a trial takes", step),
        "memory": ("Memory", memory),
        "first-minute": ("The first minute, beside an earlier version", first_minute),
        "cluster": ("Two Dask workers beside two local ones, table1", against_local),
        "scale": ("A hundred thousand trials", scale),
        "possible": ("What is proven impossible, seed 0", possible),
        "soundness": ("Proofs against planners", soundness),
        "gate": ("False alarms and power of suite compare", gate),
        "strrt": ("ST-RRT* against that of OMPL 1.7.0, future known", against_ompl),
    }
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument(
        "parts",
        nargs="*",
        metavar="part",
        help=f"which to run: {', '.join(parts)}; all by default, but for the last six",
    )
    parser.add_argument("--quick", action="store_true", help="fewer and smaller samples: two minutes, not eight")
    given = parser.parse_args()
    unknown = [part for part in given.parts if part not in parts]
    if unknown:
        parser.error(f"part: found {unknown[0]!r}, allowed {', '.join(parts)}")
    sys.stdout.write(f"{platform.machine()}, {os.cpu_count()} cores, Python {platform.python_version()}\n")
    # Only when asked for: these take many minutes, and strrt installs another OMPL first, 700 MB in the cache folder.
    for name in given.parts or list(parts)[:-6]:
        title, measure = parts[name]
        sys.stdout.write(f"\n{render(title, measure(given.quick))}")
        sys.stdout.flush()


if __name__ == "__main__":
    main()
