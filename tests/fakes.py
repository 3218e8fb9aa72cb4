"""Tasks without planners, for the tests of what runs and stores them; importable by worker processes."""

import os
import resource
import signal
import stat
import subprocess
import sys
import threading
import time
from collections.abc import Collection
from functools import partial
from pathlib import Path

import numpy as np
from pydantic import BaseModel

from planners import PlannerSpec
from scenarios import Scenario
from suite.backends.answer import packed
from suite.backends.job import Part
from suite.trial.task import TrialResult, TrialTask, trial_row


class FakeSettings(BaseModel):
    gain: float = 0.5


def fake_spec(label: str, settings: BaseModel | None = None) -> PlannerSpec:
    return PlannerSpec(label, "fake", settings or FakeSettings())


def make_scenario(number: int) -> Scenario:
    return Scenario(id=f"fake-{number:04d}", family="fake", start_rad=(0.0,) * 6, goal_m=(0.1, 0.001 * number, 0.3))


def make_tasks(labels: list[str], trials: int = 1, outside: Collection[str] = ()) -> list[TrialTask]:
    specs = {label: fake_spec(label)._replace(code="theirs" if label in outside else "") for label in labels}
    return [
        TrialTask(make_scenario(number), specs[label], predictor="cubic", limits=False, seed=0)
        for number in range(trials)
        for label in labels
    ]


WRONG: dict[str, dict[str, object]] = {
    "surrogate": {"message": "bad \udc80 name"},
    "nul": {"message": "a \0"},
    "long": {"message": "x" * 2000},
    "count": {"state_checks": 2**70},
    "negative": {"motion_checks": -5},
    "outcome": {"outcome": "won"},
}
"""What some labels measure that no column can hold."""


def _channels() -> list[int]:
    """File descriptors of this process's sockets."""
    handles = {int(link.name): link.stat() for link in Path("/proc/self/fd").iterdir() if link.exists()}
    return [handle for handle, found in handles.items() if stat.S_ISSOCK(found.st_mode)]


def _mischief(task: TrialTask) -> None:  # noqa: C901  a case is a trick
    """Do to this process what the planner's label says."""
    match task.spec.label:
        case "die twice":
            with Path(os.environ["DEATHS"]).open("a") as file:
                file.write("x")
            if len(Path(os.environ["DEATHS"]).read_text()) <= 2:
                os.kill(os.getpid(), signal.SIGKILL)
        case "garbage":
            for channel in _channels():
                os.write(channel, b"\0\0\0\4abcd" * 9)
        case "half":
            for channel in _channels():
                os.write(channel, (1000).to_bytes(8) + b"abc")
            time.sleep(1000)
        case "forge":
            for channel in _channels():
                os.write(channel, packed(2, None))
        case "close":
            os.closerange(3, 256)
            time.sleep(1000)
        case "child":
            subprocess.Popen(["sleep", "777"])
        case "print":
            os.write(1, b"said \xff " * 1_000_000)
        case "memory":
            kept = [np.ones(1_000_000) for _ in range(100)]
            time.sleep(1000 + len(kept))
        case "ask too much":
            np.ones(1 << 45)
        case "spoil":
            resource.setrlimit(resource.RLIMIT_NOFILE, (3, 3))
            np.random.default_rng = None
            threading.Timer(0.1, os._exit, [9]).start()
            raise ValueError("spoilt")
        case "another":
            task.scenario.__dict__["id"] = "stolen"
            task.__dict__["key"] = ("x", "y")


def behave(task: TrialTask) -> TrialResult:
    """Do what the planner's label says, or reach the goal about every second time."""
    match task.spec.label:
        case "raise":
            raise ValueError("two\nlines")
        case "hang":
            time.sleep(1000)
        case "die":
            os.kill(os.getpid(), signal.SIGKILL)
        case "quit":
            os._exit(0)
        case "leave":
            raise SystemExit(5)
        case _:
            _mischief(task)
    rng = np.random.default_rng(task.trial_seed)
    reached = bool(rng.random() < 0.5)
    measured = {
        "outcome": "reached" if reached else "collided",
        "success_per_step": reached,
        "success_swept": reached and bool(rng.random() < 0.5),
        "arrival_time_s": rng.uniform(1, 50) if reached else None,
        "planning_time_s": time.perf_counter() % 1,
        "n_solves": int(rng.integers(1, 9)),
    } | WRONG.get(task.spec.label, {})
    return TrialResult(trial_row(task, measured), np.arange(3.0), rng.normal(size=(3, 6)))


def behave_slowly(task: TrialTask) -> TrialResult:
    """The same in some time."""
    time.sleep(0.05)
    return behave(task)


def behave_and_tell(task: TrialTask) -> TrialResult:
    """The same; in the message, which process did it."""
    result = behave(task)
    return result._replace(row=result.row | {"message": str(os.getpid())})


def heavy_imports(task: TrialTask) -> TrialResult:
    """In the message: what this process has imported without need."""
    heavy = ("pandas", "rich", "typer", "tabulate", "scipy.stats", "scipy.interpolate", "scipy.spatial", "networkx")
    found = ", ".join(name for name in heavy if name in sys.modules)
    return TrialResult(trial_row(task, {"outcome": "reached", "message": found}), np.empty(0), np.empty((0, 6)))


def prepare_nothing(tasks: object) -> list[Part]:
    return []


def warm(how: str) -> None:
    """Do in a warm-up what ``how`` says."""
    match how:
        case "raise":
            raise ValueError("three\nlines")
        case "leave":
            raise SystemExit(3)
        case "hang":
            time.sleep(1000)
        case "die":
            os.kill(os.getpid(), signal.SIGKILL)
        case "quit":
            os._exit(7)


def warm_after_a_death(file: str) -> None:
    """As if somebody killed the first process that comes here."""
    if not Path(file).exists():
        Path(file).touch()
        os.kill(os.getpid(), signal.SIGKILL)


def make_parts(hows: dict[str, str]) -> list[Part]:
    """A part of the warm-up for each planner, by label."""
    return [Part(label, partial(warm, how), 1.0, planner=label) for label, how in hows.items()]


def place_of(raising: str) -> str:
    """`` (fakes.py:12)`` of the line of this file that raises what is named."""
    lines = Path(__file__).read_text(encoding="utf-8").splitlines()
    (number,) = (number for number, line in enumerate(lines, start=1) if line.strip() == f"raise {raising}")
    return f" (fakes.py:{number})"
