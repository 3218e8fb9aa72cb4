"""Runs of a hundred thousand trials: what the parent takes while they run, and what it costs to look at them after."""

from __future__ import annotations

import contextlib
import io
import json
import re
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Generator, Iterator
from itertools import cycle
from pathlib import Path
from typing import Any

from benchmarks.timing import Line
from scenarios import PackedScenarios, drawn
from suite.backends.job import Job, OnWarmUp
from suite.backends.processes import Processes
from suite.experiment.experiment import Experiment, make_experiment
from suite.experiment.manifest import make_manifest
from suite.runner import run_experiment
from suite.store.run_folder import open_run
from suite.trial.episode import run_trial
from suite.trial.lineup import Lineup, Tasks
from suite.trial.task import TrialResult, TrialTask

MANY, FEW = 100_000, 5_000
"""Trials in all, and with ``--quick``."""
AT_A_TIME = 1_000
"""Trials over which a rate is taken."""
PER_FILE = 5_000
ORIGINALS = 500
"""Real trials whose results stand in for those of a finished run."""


def scale(quick: bool) -> list[Line]:
    """Real trials of a few milliseconds each, then the verbs that read a run of as many.

    Every part is a process of its own. The trials are the cheapest there are: the potential field, one obstacle, two
    seconds. Those of the run that is read are copies of real ones, as long as trials are.
    """
    trials = FEW if quick else MANY
    with tempfile.TemporaryDirectory() as name:
        ran = _in_a_process("real", trials, Path(name) / "real")
        read = _in_a_process("copies", trials, Path(name) / "copies")
        command = ["run", *_options(trials), "--out", str(Path(name) / "copies")]
        made, resumed, shown = (_took(c) for c in (command, command, ["table", str(Path(name) / "copies")]))
    return [
        Line(f"parent, peak over {trials} trials", ran["peak_mib"], "MiB", "<= 381"),  # 400 MB
        Line("parent: growth over the last half", ran["growth_mib"], "MiB", "<= 8"),
        Line("trials per second: first thousand, wall", ran["first_per_s"], "1/s"),
        Line("trials per second: last thousand / first, wall", ran["last_per_s"] / ran["first_per_s"], "x", ">= 0.9"),
        Line("parent's CPU time of a trial: first thousand", ran["first_ms"], "ms"),
        Line("parent's CPU time of a trial: last thousand", ran["last_ms"], "ms"),
        Line("journal of copies", read["journal_mb"], "MB"),
        Line("its scenarios drawn again, all files written: wall", made[0], "s"),
        Line("resume of the finished run: wall", resumed[0], "s", "<= 10"),
        Line("resume of the finished run: CPU time", resumed[1], "s"),
        Line("suite table: wall", shown[0], "s", "<= 5"),
        Line("suite table: CPU time", shown[1], "s"),
    ]


class _Watched(Processes):
    """Two workers; takes note of time and memory at every thousandth trial."""

    def __init__(self) -> None:
        super().__init__(2)
        self.marks: list[tuple[float, float, float]] = []
        """Wall time [s], this process's CPU time [s] and its memory [MiB]."""

    def run(
        self, job: Job, tasks: Tasks, on_warm_up: OnWarmUp | None = None
    ) -> Generator[tuple[TrialTask, TrialResult], None, None]:
        for count, finished in enumerate(super().run(job, tasks, on_warm_up)):
            if count % AT_A_TIME == 0:
                self.marks.append((time.perf_counter(), time.process_time(), _memory_mib("VmRSS")))
            yield finished


def _real(trials: int, folder: Path) -> dict[str, float]:
    """Run trials of two seconds each."""
    folder.mkdir()
    files = [folder / f"{number:03d}.jsonl" for number in range(-(-trials // PER_FILE))]
    short = (s.model_copy(update={"time_limit_s": 2.0}) for s in drawn("orbit", 1, trials, seed=0))
    lines = PackedScenarios(short).lines()
    for file in files:
        with file.open("w", encoding="utf-8") as handle:
            handle.writelines(line for _, line in zip(range(PER_FILE), lines, strict=False))
    watched = _Watched()
    experiment = make_experiment(planners=("pf",), scenario_files=tuple(map(str, files)))
    with watched, contextlib.redirect_stderr(io.StringIO()):
        run_experiment(experiment, folder / "run", workers=watched)
    marks = watched.marks
    (first_s, first_cpu_s, _), (last_s, last_cpu_s, _) = (
        [after - before for before, after in zip(marks[k], marks[k + 1], strict=True)] for k in (1, len(marks) - 2)
    )
    return {
        "peak_mib": _memory_mib("VmHWM"),
        "growth_mib": marks[-1][2] - marks[len(marks) // 2][2],
        "first_per_s": AT_A_TIME / first_s,
        "last_per_s": AT_A_TIME / last_s,
        "first_ms": 1e3 * first_cpu_s / AT_A_TIME,
        "last_ms": 1e3 * last_cpu_s / AT_A_TIME,
    }


def _copies(trials: int, folder: Path) -> dict[str, float]:
    """Store a run as if it had come to its end, but for the files that are made then."""
    experiment = _experiment(trials)
    scenarios = experiment.scenarios()

    def tasks() -> Iterator[TrialTask]:
        return experiment.tasks(scenarios)

    originals = [run_trial(task) for task, _ in zip(tasks(), range(ORIGINALS), strict=False)]
    lineup = Lineup(tasks, range(trials))
    with open_run(folder, make_manifest(experiment, scenarios), lineup) as (journal, _):
        for task, original in zip(lineup, cycle(originals), strict=False):
            journal.add(task, original._replace(row=original.row | task.identity))
    return {"journal_mb": (folder / "run.db").stat().st_size / 1e6}


def _experiment(trials: int) -> Experiment:
    return make_experiment(planners=("pf",), obstacles=(1,), trials=trials)


def _options(trials: int) -> list[str]:
    """The same experiment for the command line."""
    return ["--planners", "pf", "--obstacles", "1", "--trials", str(trials)]


def _in_a_process(part: str, trials: int, folder: Path) -> dict[str, Any]:
    command = [sys.executable, "-m", "benchmarks.scale", part, str(trials), str(folder)]
    found: dict[str, Any] = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    return found


def _took(command: list[str]) -> tuple[float, float]:
    """Wall and CPU time of a ``suite`` command [s]."""
    started, before = time.perf_counter(), resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([sys.executable, "-m", "suite", *command], check=True, capture_output=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu_s = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return time.perf_counter() - started, cpu_s


def _memory_mib(name: str) -> float:
    """``VmRSS``, this process's resident memory, or ``VmHWM``, its peak, on Linux [MiB]."""
    found = re.search(rf"{name}:\s+(\d+) kB", Path("/proc/self/status").read_text(encoding="ascii"))
    return int(found[1]) / 1024.0 if found else 0.0


if __name__ == "__main__":
    measure = {"real": _real, "copies": _copies}[sys.argv[1]]
    sys.stdout.write(json.dumps(measure(int(sys.argv[2]), Path(sys.argv[3]))))
