"""Two workers of a Dask cluster on this machine beside two local ones."""

from __future__ import annotations

import contextlib
import io
import tempfile
import time
from pathlib import Path

from benchmarks.timing import Line
from suite.backends.cluster.head import DaskCluster
from suite.backends.job import Backend
from suite.backends.processes import Processes
from suite.backends.warm_up import warm_up_parts
from suite.experiment.experiment import Experiment, make_experiment
from suite.experiment.presets import PRESETS
from suite.runner import run_experiment
from suite.store.run_folder import read_trials
from suite.trial.columns import TIMING_NAMES

WORKERS = 2


def against_local(quick: bool) -> list[Line]:
    """Trials per second of both, in turns, the better of two rounds each; warm caches.

    A run of 24 trials is taken off a longer one, which leaves trials without the start of workers and cluster.
    """
    few, many = (make_experiment(**(PRESETS["table1"] | {"trials": n})) for n in (1, 10 if quick else 50))
    backends: dict[str, Backend] = {
        "local": Processes(WORKERS),
        "dask": DaskCluster(None, WORKERS, warm_up_parts),
    }
    starts = dict.fromkeys(backends, float("inf"))
    wholes = dict.fromkeys(backends, float("inf"))
    with tempfile.TemporaryDirectory() as name:
        for number in range(2):
            for which, backend in backends.items():
                folder = Path(name) / f"{which}-{number}"
                starts[which] = min(starts[which], _seconds(few, folder / "few", backend))
                wholes[which] = min(wholes[which], _seconds(many, folder / "many", backend))
        rows = [read_trials(Path(name) / f"{which}-0" / "many").drop(columns=list(TIMING_NAMES)) for which in backends]
        more = len(rows[0]) - len(read_trials(Path(name) / "local-0" / "few"))
    rates = {which: more / (wholes[which] - starts[which]) for which in backends}
    return [
        Line("trials per second, 2 local workers, wall", rates["local"], "1/s"),
        Line("trials per second, 2 Dask workers, wall", rates["dask"], "1/s"),
        Line("Dask / local", rates["dask"] / rates["local"], "x", ">= 0.9"),
        Line("start of the cluster: a run of 24 trials takes longer by", starts["dask"] - starts["local"], "s"),
        Line("rows that are equal but for timings", 100.0 * float(rows[0].equals(rows[1])), "%", ">= 100"),
    ]


def _seconds(experiment: Experiment, folder: Path, backend: Backend) -> float:
    started = time.perf_counter()
    with contextlib.redirect_stderr(io.StringIO()):
        run_experiment(experiment, folder, workers=backend)
    return time.perf_counter() - started
