"""``make fuzz``: nothing but one line for whatever a file holds.

python -m tests.fuzz [--inputs 200000] [--seed 0]
"""

import argparse
import random
import sys
import tempfile
import time
import traceback
from collections import Counter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from fuzz.mutation import mutated
from fuzz.readers import readers
from scenarios import UserError
from scenarios.errors import LONGEST_MESSAGE

LONGEST_S = 2.0
_CHANGES = {"os.remove", "os.rename", "os.mkdir", "os.rmdir", "shutil.rmtree"}


class Found:
    """What went wrong."""

    def __init__(self) -> None:
        self.counts = Counter[str]()
        self.lines: list[str] = []
        self.is_watching = False
        self.folder = ""

    def add(self, kind: str, line: str) -> None:
        self.counts[kind] += 1
        if self.counts[kind] <= 5:
            self.lines.append(f"{kind}: {line}")
            print(self.lines[-1], file=sys.stderr)

    def watch(self, event: str, arguments: tuple[object, ...]) -> None:
        """An audit hook: whatever is written anywhere while a file is read."""
        if not self.is_watching:
            return
        is_write = event == "open" and isinstance(arguments[2], int) and arguments[2] & 0o1103
        if (is_write or event in _CHANGES) and not str(arguments[0]).startswith(self.folder):
            self.add("files touched", f"{event} {arguments[0]}")


def fuzz(inputs: int, seed: int, folder: Path) -> tuple[Counter[str], Found]:
    """Read so many broken files; how many of each kind were read, how many of these taken, and what was found."""
    kinds = readers(folder)
    rng, found, read = random.Random(seed), Found(), Counter[str]()
    found.folder = tempfile.gettempdir()
    sys.addaudithook(found.watch)
    names, shares = list(kinds), [kind.share for kind in kinds.values()]
    (folder / "fuzz").mkdir()
    for number in range(inputs):
        name = rng.choices(names, shares)[0]
        kind, data = kinds[name], mutated(kinds[name].seeds, rng)
        file = folder / "fuzz" / kind.file
        file.write_bytes(data)
        found.is_watching = True
        started_s = time.process_time()
        try:
            kind.read(file)
            read[f"{name}, taken"] += 1
        except UserError as error:
            if len(str(error)) > LONGEST_MESSAGE or not str(error).isprintable():
                found.add("messages", repr(str(error))[:200])
        except Exception:  # noqa: BLE001  this is what is looked for
            kept = folder.parent / f"fuzz-{seed}-{number}-{kind.file}"
            kept.write_bytes(data)
            found.add("uncaught exceptions", f"{name}, {kept}\n{traceback.format_exc()}")
        found.is_watching = False
        if time.process_time() - started_s > LONGEST_S:
            found.add("over 2 s", f"{name}, input {number} of seed {seed}")
        read[name] += 1
        left = {entry.name for entry in (folder / "fuzz").iterdir()} - {kind.file}
        if left:
            found.add("files touched", f"{name}, input {number} of seed {seed}: {left}")
        file.unlink(missing_ok=True)
    return read, found


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz")
    parser.add_argument("--inputs", type=int, default=200_000)
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        started_s = time.monotonic()
        read, found = fuzz(given.inputs, given.seed, Path(folder))
    print(f"{given.inputs} inputs in {time.monotonic() - started_s:.0f} s")
    for name in sorted(name for name in read if not name.endswith(", taken")):
        print(f"{read[name]:8} {name} ({read[f'{name}, taken']} taken)")
    for kind in ("uncaught exceptions", "over 2 s", "files touched", "messages"):
        print(f"{found.counts[kind]:8} {kind}")
    return int(bool(found.counts))


if __name__ == "__main__":
    sys.exit(main())
