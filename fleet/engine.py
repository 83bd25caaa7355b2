"""Tasks on Dask: a local cluster of worker processes, or a scheduler that is already there. Nothing home-made underneath.

A task is a function that can be imported, with small arguments. It runs in a process of its own kind (a Dask worker with one thread);
its exception is its result. When a worker dies, Dask gives its task to another one; a task whose workers died `ALLOWED_DEATHS` times
more than once is given up, and costs itself only. Only a window of tasks is in flight, so that memory does not grow with their number.
"""
from __future__ import annotations

import dataclasses
import os
import pathlib
import queue
import sys
import tempfile
import time
import zipfile
from collections.abc import Callable, Iterable, Iterator
from typing import Any

import dask
import distributed
from distributed.scheduler import KilledWorker

from fleet.programs import ROOT

ALLOWED_DEATHS = 3
WINDOW = 4  # tasks in flight per worker thread
NOBODY_S = 120.0  # without a single worker before the run is given up


class NoWorkers(RuntimeError):
    """The cluster lost all of its workers."""


@dataclasses.dataclass(frozen=True)
class Task:
    """`function(*arguments)`, under a name that no other task of the run has."""

    name: str
    function: Callable[..., Any]
    arguments: tuple[Any, ...] = ()


@dataclasses.dataclass(frozen=True)
class Done:
    """`sentence` is empty when the function returned, else it says why it did not. `seconds`: in the function."""

    task: Task
    value: Any
    sentence: str
    seconds: float


def _timed(function: Callable[..., Any], arguments: tuple[Any, ...]) -> tuple[Any, str, float]:
    began = time.perf_counter()
    try:
        return function(*arguments), "", time.perf_counter() - began
    except Exception as error:  # pylint: disable=broad-except  (a task's failure is its result)
        return None, one_sentence(error), time.perf_counter() - began


def one_sentence(error: BaseException) -> str:
    """What an exception says, in one line."""
    text = " ".join(str(error).split())
    return text if text and isinstance(error, (OSError, ValueError, RuntimeError)) else f"{type(error).__name__}: {text}"


class Engine:
    """Runs tasks. Use as a context manager.

    workers: processes of the local cluster (default: one a processor). scheduler: address of a Dask scheduler (tcp://host:8786), whose
    workers must see the same folders; this package is sent to them. memory_bytes: of one local worker; Dask restarts it beyond.
    """

    def __init__(self, workers: int | None = None, scheduler: str | None = None, memory_bytes: int = 1024**3) -> None:
        self._workers = workers or os.cpu_count() or 1
        self._scheduler, self._memory = scheduler, memory_bytes
        self._cluster: distributed.LocalCluster | None = None
        self._client: distributed.Client | None = None
        self._scratch: tempfile.TemporaryDirectory[str] | None = None
        self._serial = 0

    def __enter__(self) -> Engine:
        dask.config.set({"distributed.scheduler.allowed-failures": ALLOWED_DEATHS, "distributed.comm.timeouts.connect": "60s",
                         "distributed.worker.daemon": False, "distributed.admin.tick.limit": "60s"})
        self._scratch = tempfile.TemporaryDirectory(prefix="fleet-engine-")
        if self._scheduler is None:
            # A worker's children find this package where it is; numpy's own threads would only fight over the processors.
            os.environ["PYTHONPATH"] = os.pathsep.join(dict.fromkeys([str(ROOT), *filter(None, os.environ.get("PYTHONPATH", "").split(os.pathsep))]))
            os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
            self._cluster = distributed.LocalCluster(n_workers=self._workers, threads_per_worker=1, processes=True, dashboard_address=":0",
                                                     memory_limit=self._memory, local_directory=self._scratch.name, silence_logs="CRITICAL",
                                                     host="127.0.0.1", extensions={})  # shuffling of this version fails when it ends
            self._client = distributed.Client(self._cluster)
        else:
            self._client = distributed.Client(self._scheduler, timeout="30s")
            self._client.upload_file(str(_packed(self._scratch.name)))
        return self

    def __exit__(self, *_: object) -> None:
        for part in (self._client, self._cluster):
            if part is not None:
                part.close()
        if self._scratch is not None:
            self._scratch.cleanup()

    @property
    def threads(self) -> int:
        """Tasks that run at the same time."""
        assert self._client is not None
        return max(1, sum(self._client.nthreads().values()))

    def worker_processes(self) -> list[int]:
        """Process ids of the workers."""
        assert self._client is not None
        return list(self._client.run(os.getpid).values())

    def run(self, tasks: Iterable[Task], then: Callable[[Done], Iterable[Task]] = lambda done: ()) -> Iterator[Done]:
        """Yields every task once, as it ends. `then` may name further tasks that became possible; they go first."""
        assert self._client is not None
        client, ended = self._client, queue.Queue[Any]()
        ready, flying = list[Task](), dict[str, tuple[Task, distributed.Future]]()
        waiting: Iterator[Task] = iter(tasks)
        exhausted, served = False, time.monotonic()
        window = WINDOW * self.threads
        while True:
            while len(flying) < window and not (exhausted and not ready):
                task: Task | None = ready.pop(0) if ready else next(waiting, None)
                if task is None:
                    exhausted = True
                    continue
                self._serial += 1  # a key that comes again could be answered with the earlier result
                future = client.submit(_timed, task.function, task.arguments, key=f"{task.name}-{os.getpid()}-{self._serial}", pure=False)
                flying[future.key] = (task, future)
                future.add_done_callback(ended.put)
            if not flying:
                return
            try:
                future = ended.get(timeout=5.0)
            except queue.Empty:
                served = self._someone_since(served)
                continue
            served = time.monotonic()
            task, _ = flying.pop(future.key)
            done = _collect(task, future)
            future.release()
            ready.extend(then(done))
            yield done

    def _someone_since(self, served: float) -> float:
        assert self._client is not None
        if self._client.scheduler_info()["workers"]:
            return time.monotonic()
        if time.monotonic() - served > NOBODY_S:
            raise NoWorkers(f"no worker for {NOBODY_S:g} s; what is done is kept: start workers and run the same command again")
        return served


def _collect(task: Task, future: distributed.Future) -> Done:
    try:
        value, sentence, seconds = future.result()
        return Done(task, value, sentence, seconds)
    except KilledWorker:
        return Done(task, None, f"its worker died {ALLOWED_DEATHS + 1} times while it ran", 0.0)
    except Exception as error:  # pylint: disable=broad-except  (lost connection, cancelled, not to be unpickled)
        return Done(task, None, one_sentence(error), 0.0)


def _packed(folder: str) -> pathlib.Path:
    """This package as a zip, for workers elsewhere."""
    path = pathlib.Path(folder) / "fleet.zip"
    with zipfile.ZipFile(path, "w") as archive:
        for source in sorted((ROOT / "fleet").glob("*.py")):
            archive.write(source, f"fleet/{source.name}")
    return path


class Progress:
    """Says on standard error how far a run is and how long it will last, once in a while."""

    def __init__(self, total: int, what: str, every_s: float | None = None) -> None:
        self._total, self._what = total, what
        self._every = every_s if every_s is not None else (1.0 if sys.stderr.isatty() else 30.0)
        self._began = self._said = time.monotonic()
        self.count = self.failed = 0

    def add(self, done: Done, failed: bool | None = None) -> None:
        """Counts one task."""
        self.count += 1
        self.failed += bool(done.sentence) if failed is None else failed
        if time.monotonic() - self._said >= self._every or self.count == self._total:
            self._said = time.monotonic()
            print(self.text(), file=sys.stderr, flush=True)

    def text(self) -> str:
        """One line."""
        spent = time.monotonic() - self._began
        left = spent / max(1, self.count) * (self._total - self.count)
        return (f"{self._what}: {self.count} of {self._total} done, {self.failed} failed, {self.count / max(spent, 1e-9):.2g} a second, "
                f"{clock(left)} left")


def clock(seconds: float) -> str:
    """A duration for people."""
    if seconds < 90:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"
