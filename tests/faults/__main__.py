"""``make faults``: runs of real trials with faults put into them end as the unbroken run does.

    python -m tests.faults [--faults 320]

Every run is of pf among one obstacle. Nothing may be lost, doubled or different (but for timings), no command may
print a traceback, and no run may end for what one planner or one worker does.
"""

import argparse
import os
import random
import shutil
import signal
import sqlite3
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import closing, suppress
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from faults.hostile import Mode
from scenarios.kernels.jit import cache_folder
from suite.trial.columns import COLUMN_NAMES, TIMING_NAMES

HERE = Path(__file__).parent
MODES = Mode.__args__
NAMES = [name for name in COLUMN_NAMES if name not in TIMING_NAMES]
WORKER_FAULTS = {"worker KILL": signal.SIGKILL, "worker TERM": signal.SIGTERM, "worker HUP": signal.SIGHUP}
SUITE_FAULTS = ["KILL", "INT", "TERM", "INT twice"]
FILE_FAULTS = [
    "derived file cut",
    "manifest gone",
    "stamp cut",
    "kernel cache cut",
    "disk full",
    "second run",
    "table meanwhile",
]


class Campaign:
    """Faults, and what came of them."""

    def __init__(self, folder: Path, trials: int) -> None:
        self.folder, self.trials = folder, trials
        self.started_s = time.monotonic()
        self.faults, self.wrong = Counter[str](), list[str]()
        self.rng = random.Random(0)
        self.environment = os.environ | {"SUITE_CACHE_DIR": str(folder / "cache")}
        with suppress(FileNotFoundError):  # nothing has been compiled here yet
            shutil.copytree(cache_folder() / "kernels", folder / "cache" / "kernels", copy_function=_link)
        self.run("whole")
        self.whole = self.rows("whole")

    def command(self, *arguments: str) -> list[str]:
        return [sys.executable, "-m", "suite", *arguments]

    def asked(self, name: str, planners: str = "pf") -> list[str]:
        where = ["--out", str(self.folder / name), "--workers", "2", "--hang-limit-s", "5"]
        return self.command("run", "--planners", planners, "--obstacles", "1", "--trials", str(self.trials), *where)

    def start(self, arguments: list[str]) -> subprocess.Popen[bytes]:
        with (self.folder / "said").open("wb") as said:
            return subprocess.Popen(arguments, env=self.environment, stdout=said, stderr=said, cwd=HERE.parents[1])

    def ended(self, process: subprocess.Popen[bytes], allowed: tuple[int, ...], what: str) -> None:
        """Wait for a command and judge its exit and what it has printed."""
        code = process.wait(900)
        said = (self.folder / "said").read_bytes()
        if b"Traceback" in said:
            self.blame(f"{what}: a traceback: {said[-500:]!r}")
        if code not in allowed:
            self.blame(f"{what}: exit {code}: {said[-300:]!r}")

    def run(self, name: str, planners: str = "pf") -> None:
        self.ended(self.start(self.asked(name, planners)), (0,), f"run {name}")

    def rows(self, name: str) -> dict[str, tuple[object, ...]]:
        """Rows of pf by trial; each once."""
        with sqlite3.connect(self.folder / name / "run.db") as db:
            chosen = ", ".join(f'"{column}"' for column in NAMES)
            found = db.execute(f"SELECT key, executed, {chosen} FROM trials WHERE planner = 'pf'").fetchall()
        if len({key for key, *_ in found}) < len(found):
            self.blame(f"{name}: rows doubled")
        return {key: tuple(row) for key, *row in found}

    def compare(self, name: str) -> None:
        found = self.rows(name)
        for what, keys in (("lost", self.whole.keys() - found.keys()), ("new", found.keys() - self.whole.keys())):
            if keys:
                self.blame(f"{name}: {len(keys)} trials {what}")
        for key in found.keys() & self.whole.keys():
            unlike = [pair for pair in zip(found[key], self.whole[key], strict=True) if pair[0] != pair[1]]
            if unlike:
                self.blame(f"{name}: a row differs: {unlike[1:] or 'in what was executed'}"[:500])
        self.say(name)

    def blame(self, what: str) -> None:
        """Keep what went wrong, and say it at once."""
        self.wrong.append(what)
        print(what, file=sys.stderr, flush=True)

    def say(self, name: str) -> None:
        """How far this is, after every run that was compared: it takes a quarter of an hour."""
        so_far = f"{self.faults.total()} faults, {len(self.wrong)} wrong"
        print(f"{time.monotonic() - self.started_s:5.0f} s  {name}: {so_far} so far", file=sys.stderr, flush=True)

    def workers_killed(self, faults: int) -> None:
        """Workers killed from outside while a run goes on, again and again."""
        number = 0
        while sum(self.faults[kind] for kind in (*WORKER_FAULTS, "worker STOP and CONT")) < faults:
            name, number = f"workers-{number}", number + 1
            process = self.start(self.asked(name))
            stored = 0
            while process.poll() is None:
                time.sleep(self.rng.uniform(0.1, 0.6))
                # Workers that are killed three times over before they have started cost a trial, as documented.
                if self._stored(name) > stored:
                    stored = self._stored(name)
                    self._kill_one(process.pid)
            self.ended(process, (0,), name)
            self.compare(name)

    def _stored(self, name: str) -> int:
        with (
            suppress(sqlite3.Error),
            closing(sqlite3.connect(f"file:{self.folder / name}/run.db?mode=ro", uri=True)) as db,
        ):
            return int(db.execute("SELECT count(*) FROM trials").fetchone()[0])
        return 0

    def _kill_one(self, suite: int) -> None:
        pids = list(workers_of(suite))
        if not pids:
            return
        kind = self.rng.choice([*WORKER_FAULTS, "worker STOP and CONT"])
        pid = self.rng.choice(pids)
        with suppress(ProcessLookupError):
            if kind in WORKER_FAULTS:
                os.kill(pid, WORKER_FAULTS[kind])
            else:
                os.kill(pid, signal.SIGSTOP)
                time.sleep(0.2)
                os.kill(pid, signal.SIGCONT)
            self.faults[kind] += 1

    def hostile_beside(self, trials: int) -> None:
        """Planners that misbehave in every trial beside one that does not."""
        at = HERE / "hostile.py"
        names = [f"{at}:Hostile[mode={mode},name={mode}]" for mode in MODES]
        all_trials, self.trials = self.trials, trials
        self.run("hostile", ",".join([*names, "pf"]))
        self.trials = all_trials
        found = self.rows("hostile")
        if len(found) != trials or any(self.whole[key] != row for key, row in found.items()):
            self.blame("hostile: rows of pf lost or different")
        with sqlite3.connect(self.folder / "hostile" / "run.db") as db:
            for planner, count in db.execute("SELECT planner, count(*) FROM trials WHERE planner <> 'pf' GROUP BY 1"):
                self.faults[f"planner: {planner}"] += count
        self.say("hostile")

    def suite_stopped(self, faults: int) -> None:
        """The whole command stopped at any time, and given again."""
        number = 0
        while sum(self.faults[kind] for kind in SUITE_FAULTS) < faults:
            name, number = f"stopped-{number}", number + 1
            for _ in range(8):
                kind = self.rng.choice(SUITE_FAULTS)
                process = self.start(self.asked(name))
                self._stop(process, kind, self.rng.uniform(0.5, 6.0))
                self.faults[kind] += 1
                for pid in workers_of(process.pid):
                    self.blame(f"{name}: worker {pid} outlives the suite after {kind}")
            self.run(name)
            self.compare(name)

    def _stop(self, process: subprocess.Popen[bytes], kind: str, after_s: float) -> None:
        with suppress(subprocess.TimeoutExpired):
            process.wait(after_s)
        name = kind.removesuffix(" twice")
        with suppress(ProcessLookupError):
            process.send_signal(getattr(signal, f"SIG{name}"))
            if name != kind:
                time.sleep(0.05)
                process.send_signal(signal.SIGINT)
        self.ended(process, (0, 130, -signal.SIGKILL, -signal.SIGINT), f"stopped by {kind}")

    def files_broken(self, rounds: int) -> None:
        """Files cut, gone or in use between and during runs."""
        for number in range(rounds):
            name = f"files-{number}"
            process = self.start(self.asked(name))
            self._stop(process, "KILL", self.rng.uniform(2.0, 6.0))
            for kind in FILE_FAULTS:
                self._break(kind, name)
                self.faults[kind] += 1
            self.run(name)
            for derived in ("trials.csv", "table.csv", "table.md", ".finished.json"):
                (self.folder / name / derived).write_bytes(b"a")
            self.run(name)
            self.compare(name)

    def _break(self, kind: str, name: str) -> None:
        folder = self.folder / name
        match kind:
            case "derived file cut" | "stamp cut":
                folder.mkdir(exist_ok=True)
                if (folder / "run.db").exists():
                    (folder / (".finished.json" if kind == "stamp cut" else "table.csv")).write_bytes(b"x")
            case "manifest gone":
                (folder / "manifest.json").unlink(missing_ok=True)
            case "kernel cache cut":
                for file in self.rng.sample(sorted((self.folder / "cache").rglob("*.nb[ic]")), 3):
                    kept = file.read_bytes()[: self.rng.choice([0, 100])]
                    file.unlink()  # the user's cache has it as well
                    file.write_bytes(kept)
            case "disk full":
                limited = ["prlimit", f"--fsize={self.rng.randint(30, 200) * 1000}", *self.asked(name)]
                self.ended(self.start(limited), (0, 2), "disk full")
            case "second run":
                first = self.start(self.asked(name))
                time.sleep(1.5)
                self.ended(self.start(self.asked(name)), (0, 2), "second run")
                self._stop(first, "INT", 1.0)
            case "table meanwhile":
                first = self.start(self.asked(name))
                time.sleep(1.5)
                self.ended(self.start(self.command("table", str(folder))), (0, 2, 3), "table meanwhile")
                self._stop(first, "KILL", 1.0)


def _link(source: str, target: str) -> None:
    try:
        os.link(source, target)
    except OSError:  # on another disk
        shutil.copy2(source, target)


def workers_of(parent: int) -> Iterator[int]:
    """Worker processes of a suite that runs, or did."""
    for file in Path("/proc").glob("[0-9]*/cmdline"):
        with suppress(OSError):
            if b"main(" in (line := file.read_bytes()) and f", {parent})".encode() in line:
                yield int(file.parent.name)


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.faults")
    parser.add_argument("--faults", type=int, default=320, help="about so many")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        campaign = Campaign(Path(folder), trials=max(10, min(200, given.faults)))
        campaign.workers_killed(given.faults // 3)
        campaign.hostile_beside(max(1, given.faults // 30))
        campaign.suite_stopped(given.faults // 10)
        campaign.files_broken(max(1, given.faults // 60))
    kinds = campaign.faults
    print(f"{kinds.total()} faults of {len(kinds)} kinds in {time.monotonic() - campaign.started_s:.0f} s")
    print(*(f"{count:6} {kind}" for kind, count in sorted(kinds.items())), sep="\n")
    print(f"{len(campaign.wrong)} trials lost, doubled or different, tracebacks, runs ended")
    print(*campaign.wrong, sep="\n")
    return int(bool(campaign.wrong))


if __name__ == "__main__":
    sys.exit(main())
