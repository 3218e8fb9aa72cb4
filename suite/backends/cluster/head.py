"""The head of a run on a Dask cluster: it hands out chunks and takes their results; it alone writes the journal."""

from __future__ import annotations

import logging
import queue
import signal
import threading
import time
import uuid
from collections.abc import Callable, Generator, Iterable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any
from urllib.parse import urlparse

from suite.backends.answer import GarbledError
from suite.backends.cluster.chunks import Chunk, Chunks
from suite.backends.cluster.node import Brief, differences, end, results_in, run_chunk, wrapped
from suite.backends.cluster.shipping import sources_of
from suite.backends.job import Job, OnWarmUp, Part
from suite.errors import SuiteError
from suite.experiment.code import house
from suite.trial.lineup import Tasks
from suite.trial.task import RowError, TrialResult, TrialTask, checked_result

if TYPE_CHECKING:
    from distributed import Client, Future

IN_FLIGHT = 2
"""Chunks per slot that are handed out: one that is worked off and one that waits for it."""
LOOK_EVERY_S = 1.0
CONNECT_LIMIT_S = 30.0
END_LIMIT_S = 5.0
GATHER_LIMIT_S = 60.0
SETTINGS = {
    "distributed.worker.daemon": False,  # it starts processes of its own, which Python forbids daemons
    "distributed.worker.profile.enabled": False,
    "distributed.scheduler.allowed-failures": 0,  # a lost chunk is ours to divide
    "distributed.admin.large-graph-warning-threshold": "1GB",
    "logging.distributed": "critical",
}
"""Of the cluster that is started here, and of the client of any."""


class DaskCluster:
    """Runs trials on the workers of a Dask scheduler, or of a cluster that is started on this machine."""

    def __init__(
        self, scheduler: str | None, workers: int, prepare: Callable[[Iterable[TrialTask]], list[Part]]
    ) -> None:
        """Nothing is started or connected yet.

        Args:
            scheduler: Its address; a cluster is started here when None.
            workers: How many workers that one has.
            prepare: Makes the parts of the warm-up, on every node.

        Raises:
            SuiteError: Dask is not installed.
        """
        if find_spec("distributed") is None:
            raise SuiteError("backend: found no dask, allowed with it: pip install 'continuum-arm-suite[cluster]'")
        self._scheduler, self._workers, self._prepare = scheduler, workers, prepare

    def run(
        self, job: Job, tasks: Tasks, on_warm_up: OnWarmUp | None = None
    ) -> Generator[tuple[TrialTask, TrialResult], None, None]:
        """See ``Backend.run``.

        Raises:
            SuiteError: The scheduler can't be reached, or a worker runs another version of the suite.
        """
        with self._client() as client:
            brief = Brief(
                house(),
                job.run,
                self._prepare,
                job.hang_limit_s,
                job.warm_up_limit_s,
                job.memory_limit_mb,
                tuple(job.examples),
                sources_of(task.spec for task in job.examples),
            )
            run = _Run(client, brief, Chunks(tasks))
            tell = (lambda: on_warm_up(job.parts[:1], job.parts[1:])) if on_warm_up and job.parts else lambda: None
            try:
                yield from run.results(tell)
            except KeyboardInterrupt:
                yield from run.last_results()
                raise
            finally:
                run.end()

    @contextmanager
    def _client(self) -> Iterator[Client]:
        import dask  # takes half a second, which runs on this machine do not have to spend
        from distributed import Client, LocalCluster

        logging.getLogger("distributed").setLevel(logging.CRITICAL)  # what is lost is seen to, and said once
        with ExitStack() as stack:
            stack.enter_context(dask.config.set(SETTINGS))
            address: Any = self._scheduler
            if address is None:
                with _interrupts_held():
                    address = LocalCluster(
                        n_workers=self._workers,
                        threads_per_worker=1,
                        dashboard_address="127.0.0.1:0",
                        memory_limit=0,
                        silence_logs=logging.CRITICAL,
                    )
                stack.callback(address.close, timeout=END_LIMIT_S)
            try:
                client = Client(address, timeout=CONNECT_LIMIT_S, set_as_default=False)
            except (OSError, ValueError) as error:
                reason = str(error).splitlines()[0][:200]
                raise SuiteError(
                    f"scheduler: found none at {self._scheduler!r} ({reason}), allowed such as tcp://host:8786"
                ) from None
            stack.callback(client.close, timeout=END_LIMIT_S)
            yield client


class _Run:
    """One run on a cluster."""

    def __init__(self, client: Client, brief: Brief, chunks: Chunks) -> None:
        self._client, self._chunks = client, chunks
        self._house, self._brief = brief.house, wrapped(brief)
        self._name = uuid.uuid4().hex[:12]
        self._done: queue.SimpleQueue[Future[Any]] = queue.SimpleQueue()
        self._out: dict[str, tuple[Future[Any], Chunk, str]] = {}
        """By key: what is handed out, with the only host where it may run, if any."""
        self._threads: dict[str, int] = {}
        self._looked_s = -float("inf")
        self._known: set[str] = set()
        self._warm: set[str] = set()

    def results(self, tell: Callable[[], None]) -> Iterator[tuple[TrialTask, TrialResult]]:
        """Hand out chunks until every task has its result."""
        chunks = self._chunks
        while chunks.n_open:
            self._look_around()
            self._hand_out()
            yield from chunks.results()
            if not self._warm:
                tell()
            self._settle_what_is_done()
        yield from chunks.results()

    def last_results(self) -> Iterator[tuple[TrialTask, TrialResult]]:
        """What the workers have by now: each ends with the trial that it is at."""
        self._tell_all(self._client.run, end, self._name, on_error="ignore")
        asked_s = time.monotonic()
        while self._out and time.monotonic() - asked_s < END_LIMIT_S:
            self._settle_what_is_done()
            yield from self._chunks.results()

    def end(self) -> None:
        """Cancel what is handed out and let the workers' processes go."""
        self._tell_all(self._client.cancel, [future for future, _, _ in self._out.values()])
        self._tell_all(self._client.run, end, self._name, on_error="ignore")

    def _tell_all(self, tell: Callable[..., object], *message: object, **options: Any) -> None:
        """Nobody waits for a worker that does not answer."""

        def told() -> None:
            with suppress(Exception):
                tell(*message, **options)

        telling = threading.Thread(target=told, daemon=True)
        telling.start()
        telling.join(END_LIMIT_S)

    def _look_around(self) -> None:
        """Which workers there are; each is asked once whether it has the same suite."""
        if time.monotonic() - self._looked_s < LOOK_EVERY_S:
            return
        self._looked_s = time.monotonic()
        if self._client.status != "running":
            raise SuiteError("scheduler: the connection is lost; the same command goes on from here")
        self._threads = self._client.nthreads()
        new = [address for address in self._threads if address not in self._known]
        answers = self._client.run(differences, self._house, workers=new, on_error="return") if new else {}
        for address, found in answers.items():
            if isinstance(found, ImportError):
                raise SuiteError(f"worker {address}: found no suite there ({found}), allowed the version that is here")
            if isinstance(found, str) and found:
                raise SuiteError(f"worker {address}: found another version of the suite there: {found}")
            if found == "":
                self._known.add(address)
        hosts = {_host(address) for address in self._threads}
        for key, (future, chunk, host) in list(self._out.items()):
            if host and host not in hosts:  # it would wait there for ever
                future.cancel()
                del self._out[key]
                self._chunks.lost(chunk, f"the node {host} has gone")

    def _hand_out(self) -> None:
        """First one chunk to every node, which compiles what all of its workers then load; then to whoever is free."""
        slots = sum(self._threads.values())
        cold = {_host(address) for address in self._known if address in self._threads} - self._warm
        if not self._warm:
            for host in cold - {host for _, _, host in self._out.values()}:
                if chunk := self._chunks.next_chunk(slots):
                    self._submit(chunk, host)
            return
        while len(self._out) < IN_FLIGHT * slots and (chunk := self._chunks.next_chunk(slots)):
            self._submit(chunk, "")

    def _submit(self, chunk: Chunk, host: str) -> None:
        key = f"suite-{self._name}-{chunk.number}"
        where = {"workers": [host], "allow_other_workers": False} if host else {}
        tasks = wrapped(chunk.tasks)
        future = self._client.submit(
            run_chunk, self._name, self._house, self._brief, tasks, key=key, pure=False, **where
        )
        self._out[key] = future, chunk, host
        future.add_done_callback(self._done.put)

    def _settle_what_is_done(self) -> None:
        try:
            future = self._done.get(timeout=LOOK_EVERY_S)
            while True:
                self._settle(future)
                future = self._done.get_nowait()
        except queue.Empty:
            return

    def _settle(self, future: Future[Any]) -> None:
        if future.key not in self._out:
            return
        _, chunk, host = self._out.pop(future.key)
        if future.status == "finished":
            try:
                answer = future.result(timeout=GATHER_LIMIT_S)
            except Exception as error:  # noqa: BLE001  with the worker that had it; Dask has no one name for that
                self._chunks.lost(chunk, f"its results were lost: {type(error).__name__}")
                self._client.cancel([future])
            else:
                self._take(chunk, answer)
                if host:
                    self._warm.add(host)
        else:
            self._chunks.lost(chunk, _why(future))
        future.release()

    def _take(self, chunk: Chunk, answer: object) -> None:
        """Nothing that comes back is taken at its word: it is checked as what comes from a local worker is."""
        try:
            found = results_in(answer, len(chunk.tasks))
            results = {place: checked_result(chunk.tasks[place], result) for place, result in found.items()}
        except (GarbledError, RowError) as error:
            self._chunks.lost(chunk, str(error))
        else:
            self._chunks.came_back(chunk, results)


def _why(future: Future[Any]) -> str:
    """Why nothing came back.

    Raises:
        SuiteError: It is no fault of a trial's.
    """
    from distributed import KilledWorker

    if future.status != "error":
        return "the scheduler has forgotten it"
    error = future.exception()
    if isinstance(error, KilledWorker):
        return "the worker of the cluster died"
    line = f"{type(error).__name__}: {error}".splitlines()[0][:200]
    raise SuiteError(f"cluster: found a worker that cannot run trials: {line}")


def _host(address: str) -> str:
    return urlparse(address).hostname or address


@contextmanager
def _interrupts_held() -> Iterator[None]:
    """Let threads and processes that are started here never see Ctrl-C, which is for the head to answer."""
    held = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, held)
