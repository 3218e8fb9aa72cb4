"""The suite as a whole: what two workers bring, what it spends beside solving and judging, and its memory."""

from __future__ import annotations

import contextlib
import io
import os
import re
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

from benchmarks.timing import Line, seconds_per_call
from planners import Session, build_predictor, parse_planner
from scenarios import generate
from suite.auditor import collides
from suite.experiment.experiment import Experiment, make_experiment
from suite.experiment.presets import PRESETS
from suite.runner import run_experiment
from suite.store.run_folder import read_trials
from suite.trial.execution import Execution
from suite.trial.observation import Observer
from suite.trial.task import TrialTask

KIB = 1024.0


class Cost(NamedTuple):
    """What a run takes."""

    wall_s: float
    parent_s: float
    """CPU time of the process that hands out tasks and stores results."""
    workers_s: float
    """CPU time of its workers, their start included."""

    def beyond(self, less: Cost) -> Cost:
        """What it takes more than another run."""
        return Cost(*(a - b for a, b in zip(self, less, strict=True)))


def throughput(quick: bool) -> list[Line]:
    """Trials per second with one and two workers, and the shares of a trial; warm caches.

    A run of 20 trials is taken off a longer one, which leaves trials without start-up. CPU time says what two idle
    cores would give; wall time what this machine gave.
    """
    few, many = (make_experiment(**(PRESETS["table1"] | {"trials": n})) for n in (1, 4 if quick else 20))
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        _run(few, folder / "warm", 1)
        start = {workers: _run(few, folder / f"few-{workers}", workers) for workers in (1, 2)}
        whole = {workers: _run(many, folder / f"many-{workers}", workers) for workers in (1, 2)}
        trials = read_trials(folder / "many-1")
    more = len(trials) - len(PRESETS["table1"]["planners"]) * len(PRESETS["table1"]["obstacles"])
    one, two = (whole[workers].beyond(start[workers]) for workers in (1, 2))
    start_s = start[2].parent_s + start[2].workers_s / 2.0
    ideal_s = (two.workers_s + two.parent_s) / 2.0  # the parent takes its share of the two cores
    total, solve, judge = (float(trials[name].sum()) for name in ("trial_wall_s", "planning_time_s", "audit_time_s"))
    return [
        Line("trials per second, 1 worker, wall", more / one.wall_s, "1/s"),
        Line("trials per second, 2 workers, wall", more / two.wall_s, "1/s"),
        Line("2 workers / 1 worker, wall", one.wall_s / two.wall_s, "x", ">= 1.85"),
        Line("CPU time of a trial: worker", 1e3 * two.workers_s / more, "ms"),
        Line("CPU time of a trial: parent", 1e3 * two.parent_s / more, "ms"),
        Line("2 workers / 1 worker, on two idle cores by CPU time", two.workers_s / ideal_s, "x", ">= 1.85"),
        Line("table1, 2,000 trials, on two idle cores by CPU time", start_s + 2000.0 / more * ideal_s, "s", "<= 60"),
        Line("share of a trial: solve", 100.0 * solve / total, "%"),
        Line("share of a trial: audit", 100.0 * judge / total, "%"),
        Line("share of a trial: all else", 100.0 * (1.0 - (solve + judge) / total), "%", "<= 10"),
    ]


def step(quick: bool) -> list[Line]:
    """CPU time of the parts of one step of a trial: the planner's search, and everything around it."""
    scenario = generate("orbit", 5, 4, seed=0)[3]
    task = TrialTask(scenario, parse_planner("t3"), "cubic", limits=False, seed=0)
    session = Session(task.spec, scenario, predictor=task.predictor, limits=task.limits, seed=1)
    observer, predictor = Observer(task), build_predictor("cubic", scenario)
    plan = session.plan(scenario.start, 0.0, observer.until(0.0))

    def execute() -> None:
        execution = Execution(scenario)
        execution.take(plan.times_s, plan.configurations_rad)
        execution.step()

    parts: dict[str, Callable[[], object]] = {
        "observe": lambda: observer.until(20.0),
        "predict 3 s, cubic, 5 obstacles": lambda: predictor.predict(observer.until(20.0), 3.0, 1.0),
        "observe, predict, solve, read the path": lambda: session.plan(scenario.start, 20.0, observer.until(20.0)),
        "execute": execute,
        "contact check": lambda: collides(scenario, scenario.start, 20.0),
    }
    times = seconds_per_call(list(parts.values()), 0.05, rounds=3 if quick else 10)
    return [Line(f"one step of t3: {part}", 1e6 * t, "us") for part, t in zip(parts, times, strict=True)]


def memory(quick: bool) -> list[Line]:
    """Peak memory of the parent and of its largest worker over a tenth of the trials and over all of them."""
    few, many = (100, 1000) if quick else (1000, 10_000)
    _peaks(10)  # compiles; a process that has done so stays large
    (parent_few, worker_few), (parent_many, worker_many) = _peaks(few), _peaks(many)
    return [
        Line(f"largest worker, {few} trials", worker_few, "MiB"),
        Line(f"largest worker, {many} trials", worker_many, "MiB"),
        Line("largest worker: growth", 100.0 * (worker_many / worker_few - 1.0), "%", "<= 5"),
        Line(f"parent, {few} trials", parent_few, "MiB"),
        Line(f"parent, {many} trials", parent_many, "MiB"),
        Line("parent: growth per trial", (parent_many - parent_few) * KIB / (many - few), "KiB"),
    ]


def _run(experiment: Experiment, folder: Path, workers: int) -> Cost:
    before, started = _cpu_s(), time.perf_counter()
    with contextlib.redirect_stderr(io.StringIO()):
        run_experiment(experiment, folder, workers=workers)
    wall_s = time.perf_counter() - started
    return Cost(wall_s, *(after - b for after, b in zip(_cpu_s(), before, strict=True)))


def _cpu_s() -> tuple[float, float]:
    """CPU time of this process, and of its children that have ended [s]."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    own, children = (usage.ru_utime + usage.ru_stime for usage in used)
    return own, children


def _peaks(trials: int) -> tuple[float, float]:
    """Peak resident memory [MiB] of a run of ``trials`` and of its largest worker, in a process of its own."""
    command = [sys.executable, "-m", "benchmarks.suite_runs", str(trials)]
    parent, worker = subprocess.run(command, check=True, capture_output=True, text=True).stdout.split()
    return float(parent), float(worker)


def _measure(trials: int) -> None:
    """Run ``trials`` trials of a few milliseconds each and print both peaks [MiB].

    The time limit is two seconds and the planner the potential field, one obstacle, so that thousands take a minute.
    """
    drawn = [scenario.model_copy(update={"time_limit_s": 2.0}) for scenario in generate("orbit", 1, trials, seed=0)]
    workers = 0.0
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "scenarios.jsonl"
        file.write_text("".join(f"{scenario.model_dump_json()}\n" for scenario in drawn), encoding="utf-8")
        del drawn
        experiment = make_experiment(planners=("pf",), scenario_files=(str(file),))
        with contextlib.redirect_stderr(io.StringIO()), ThreadPoolExecutor(1) as pool:
            running = pool.submit(run_experiment, experiment, Path(folder) / "run", workers=2)
            while not running.done():
                workers = max([workers, *map(_peak, _children())])
                time.sleep(0.2)
            running.result()
    sys.stdout.write(f"{_peak(os.getpid())} {workers}\n")


def _children() -> list[int]:
    """Processes that this one has started, on Linux."""
    found = [file.read_text(encoding="ascii") for file in Path("/proc/self/task").glob("*/children")]
    return [int(process) for text in found for process in text.split()]


def _peak(process: int) -> float:
    """Peak resident memory of a process on Linux [MiB], 0 once it has gone.

    ``getrusage`` would not do: a new process inherits the peak of the one that started it.
    """
    try:
        status = Path(f"/proc/{process}/status").read_text(encoding="ascii")
    except OSError:
        return 0.0
    found = re.search(r"VmHWM:\s+(\d+) kB", status)
    return int(found[1]) / KIB if found else 0.0


if __name__ == "__main__":
    _measure(int(sys.argv[1]))
