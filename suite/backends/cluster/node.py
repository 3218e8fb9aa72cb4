"""What a Dask worker does: each of its threads keeps one local worker process, with what that has warmed up."""

from __future__ import annotations

import pickle
import tempfile
import threading
import time
import zlib
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import NamedTuple

from scenarios import SpecError
from suite.backends.answer import GarbledError, frame_length, packed, unpacked
from suite.backends.cluster.shipping import Sources, Unpacked
from suite.backends.crew import Crew
from suite.backends.job import Job, Part
from suite.backends.worker import LENGTH_BYTES, Unreadable
from suite.errors import SuiteError
from suite.experiment.code import changes, house
from suite.trial.task import TrialResult, TrialTask

LONGEST_S = 60.0
"""A chunk that takes longer comes back with what it has [s]."""
MAX_BYTES = 16 * 1024 * 1024
"""So does one that has as much to bring: trajectories of thousands of trials are not held at once."""
BATCH_S = 2.0
"""Trials are given to the local crew in batches of about as long [s]."""


class Brief(NamedTuple):
    """What all chunks of a run have in common."""

    house: dict[str, object]
    """The suite at the head: its sources and versions."""
    run: Callable[[TrialTask], TrialResult]
    prepare: Callable[[Iterable[TrialTask]], list[Part]]
    """Makes the parts of the warm-up from the examples."""
    hang_limit_s: float
    warm_up_limit_s: float
    memory_limit_mb: float | None
    examples: tuple[TrialTask, ...]
    """One task of every kind that is to run."""
    sources: Sources


def wrapped(content: object) -> bytes:
    """What the head sends: it may run whatever it likes here anyway."""
    return zlib.compress(pickle.dumps(content), 1)


def differences(theirs: dict[str, object]) -> str:
    """In what this node's suite differs from the head's, in a line; empty when in nothing."""
    return "; ".join(changes(theirs, house())[:3])


class _Slot:
    """A thread's crew, for one run."""

    def __init__(self, run: str, brief: Brief) -> None:
        self.run = run
        self.lock = threading.Lock()
        """Held while a chunk is worked off."""
        self.over = threading.Event()
        self._folder = tempfile.TemporaryDirectory(prefix="continuum-arm-suite-")
        try:
            self.unpacked = Unpacked(brief.sources, Path(self._folder.name))
            parts = brief.prepare([self.unpacked.here(task) for task in brief.examples])
        except BaseException:
            self._folder.cleanup()
            raise
        job = Job(brief.run, brief.hang_limit_s, parts, brief.warm_up_limit_s, brief.memory_limit_mb)
        self.crew = Crew([], 1, job, [], None)

    def close(self) -> None:
        self.crew.close()
        self._folder.cleanup()


_SLOTS: dict[int, _Slot] = {}
"""By the thread that has it."""
_OVER: set[str] = set()
"""Names of runs that have ended."""


def run_chunk(run: str, theirs: dict[str, object], brief: bytes, tasks: bytes) -> bytes:
    """Work off a chunk.

    Args:
        run: Name of the run it belongs to; that of another ends what this thread has kept for it.
        theirs: The suite at the head; with another here, nothing else that is sent is even read.
        brief: A ``Brief``, wrapped.
        tasks: Tasks, wrapped.

    Returns:
        For each task that was run the frame of its result under its place in the chunk; or one that says what is wrong
        with this node.
    """
    if run in _OVER:
        return b""
    try:
        if found := differences(theirs):
            raise SuiteError(f"found another version of the suite there: {found}")
        slot = _slot(run, brief)
        with slot.lock:
            here = [slot.unpacked.here(task) for task in pickle.loads(zlib.decompress(tasks))]
            frames = b"".join(_frames(slot, here))
            if slot.over.is_set():
                slot.close()
            return frames
    except (SuiteError, SpecError) as error:
        return _framed(0, Unreadable(str(error)))


def _framed(place: int, answer: TrialResult | Unreadable) -> bytes:
    return place.to_bytes(LENGTH_BYTES) + packed(place, answer)


def end(run: str) -> None:
    """Let a run's processes on this node go: at once, or those that are at a trial after it."""
    _OVER.add(run)
    for thread, slot in list(_SLOTS.items()):
        if slot.run == run:
            slot.over.set()
            del _SLOTS[thread]
            if slot.lock.acquire(blocking=False):
                slot.close()


def results_in(answer: object, count: int) -> dict[int, TrialResult]:
    """At the head: the results in what came back of a chunk of ``count`` tasks, by their places.

    Raises:
        SuiteError: The node cannot run trials; says why.
        GarbledError: It is nothing that ``run_chunk`` returns.
    """
    if not isinstance(answer, bytes):
        raise GarbledError(f"found {type(answer).__name__} for bytes")
    results: dict[int, TrialResult] = {}
    begin = 0
    while begin < len(answer):
        place = int.from_bytes(answer[begin : begin + LENGTH_BYTES])
        begin += LENGTH_BYTES
        length = frame_length(answer[begin : begin + LENGTH_BYTES])
        if length is None:
            raise GarbledError("found bytes that are no answer")
        match unpacked(place, answer[begin : begin + length]):
            case TrialResult() as result if place < count:
                results[place] = result
            case Unreadable(message):
                raise SuiteError(message)
            case _:
                raise GarbledError("found something else than a result")
        begin += length
    return results


def _slot(run: str, brief: bytes) -> _Slot:
    """This thread's slot for a run."""
    thread = threading.get_ident()
    slot = _SLOTS.get(thread)
    if slot is None or slot.run != run:
        if slot is not None:
            slot.close()
        slot = _SLOTS[thread] = _Slot(run, pickle.loads(zlib.decompress(brief)))
    return slot


def _frames(slot: _Slot, tasks: list[TrialTask]) -> Iterator[bytes]:
    """The frames of results as they are made, until time or memory is up."""
    places = {task.key: place for place, task in enumerate(tasks)}
    began_s, begun, size, n_bytes = time.monotonic(), 0, 1, 0
    while (
        begun < len(tasks) and time.monotonic() - began_s < LONGEST_S and n_bytes < MAX_BYTES and not slot.over.is_set()
    ):
        batch, batch_s = tasks[begun : begun + size], time.monotonic()
        begun += len(batch)
        slot.crew.add(batch)
        for task, result in slot.crew.run():
            frame = _framed(places[task.key], result)
            n_bytes += len(frame)
            yield frame
            if slot.over.is_set():
                return
        size = max(1, min(2 * size, int(size * BATCH_S / max(time.monotonic() - batch_s, 1e-3))))
