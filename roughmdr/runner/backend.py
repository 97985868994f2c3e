"""Where tasks are computed: threads or processes of this machine, or a dask cluster.

On a cluster there are a few tasks at a time, so that memory stays bounded; those that are lost are computed again.
"""

import logging
import socket
import sys
import threading
import time
import uuid
from collections.abc import Iterable, Iterator, Mapping
from contextlib import AbstractContextManager, ExitStack, closing, contextmanager, nullcontext
from typing import TYPE_CHECKING, Any, NamedTuple
from urllib.parse import urlsplit

from roughmdr.batch.tasks import Task, compute, failed
from roughmdr.errors import RoughmdrError, Unfinished
from roughmdr.runner.local import Pool, Processes, Sink, Threads

if TYPE_CHECKING:
    import ssl

    from distributed import Client

    from roughmdr.batch.plan import Plan

_WINDOW = 2  # tasks submitted for each thread of the cluster: one that runs, one that is ready
_COUNT_INTERVAL = 1.0  # time between counts of the threads [s]
_TIMEOUT = 30.0  # longest wait for an answer of the scheduler [s]
_GREETING_TIMEOUT = 5.0  # longest wait for its first bytes [s]: so a wrong address shows within ten seconds
_GREETING = b"pickle-protocol"  # key of the handshake with which a dask scheduler opens a connection
_GREETING_BYTES = 2**12  # first bytes of a connection, which hold that key
_LOCAL = ("threads", "processes")
_ADDRESSES = ("tcp://", "tls://")


class Cluster:
    """The workers of a dask scheduler, whose number may change."""

    def __init__(self, client: "Client") -> None:
        self._client = client
        self._threads, self._counted = 0, -_COUNT_INTERVAL

    @property
    def workers(self) -> int:
        """Number of threads, at least one."""
        if time.monotonic() - self._counted > _COUNT_INTERVAL:
            self._threads, self._counted = sum(self._client.nthreads().values()), time.monotonic()
        return max(1, self._threads)

    def compute(self, tasks: Iterable[Task], stop: threading.Event, sink: Sink) -> None:
        """Compute the tasks; one whose workers die one after another has failed, any other is tried again."""
        from distributed import as_completed

        if not self._client.nthreads():
            print("roughmdr: the scheduler has no workers yet; waiting for some", file=sys.stderr, flush=True)
        name, submitted = f"roughmdr-{uuid.uuid4().hex}", dict[Any, Task]()
        numbered = enumerate(tasks)
        done = as_completed(loop=self._client.loop)
        try:
            while True:
                while len(submitted) < _WINDOW * self.workers and not stop.is_set():
                    number, task = next(numbered, (0, None))
                    if task is None:
                        break
                    future = self._client.submit(compute, task, key=f"{name}-{number}", pure=False)
                    submitted[future.key] = task
                    done.add(future)
                if not submitted:
                    return
                future = next(done)
                self._receive(future, submitted.pop(future.key), sink)
        except (OSError, TimeoutError) as error:
            raise Unfinished(f"the cluster is lost: {error or type(error).__name__}") from None

    @staticmethod
    def _receive(future: Any, task: Task, sink: Sink) -> None:
        from distributed import KilledWorker

        if future.status == "cancelled":
            raise Unfinished("the cluster is lost: its scheduler does not answer any more")
        error = future.exception() if future.status == "error" else None
        if isinstance(error, RoughmdrError):
            raise error
        if isinstance(error, KilledWorker):
            sink(failed(task, "the workers that computed it died, one after another"))
        elif error is not None:
            sink(failed(task, f"{type(error).__name__}: {error}"))
        else:
            sink(future.result())


def _check_scheduler(address: str, context: "ssl.SSLContext | None") -> None:
    """OSError where no dask scheduler listens, or one without a valid certificate; a client would try on and on."""
    url, deadline = urlsplit(address), time.monotonic() + _GREETING_TIMEOUT
    with ExitStack() as opened:
        connection = opened.enter_context(
            socket.create_connection((url.hostname or "", url.port or 0), _GREETING_TIMEOUT)
        )
        if context is not None and address.startswith("tls://"):
            connection = opened.enter_context(context.wrap_socket(connection, server_hostname=url.hostname))
        heard = b""
        while _GREETING not in heard:
            connection.settimeout(max(deadline - time.monotonic(), 1e-3))
            part = connection.recv(_GREETING_BYTES)
            heard += part
            if not part or len(heard) > _GREETING_BYTES:
                raise ConnectionError("another server listens there")


@contextmanager
def connected(address: str, tls: Mapping[str, str] | None) -> Iterator[Cluster]:
    """Connect to the cluster at tcp://HOST:PORT or tls://HOST:PORT; RoughmdrError where there is none.

    ``tls`` are the files for an encrypted connection, as ``distributed.Security`` names them.
    """
    try:
        from distributed import Client, Security
    except ImportError:
        raise RoughmdrError(
            f"scheduler is {address!r}: clusters need the package distributed: pip install -e '.[cluster]' in the "
            "clone of roughmdr"
        ) from None
    try:
        security = Security(**tls, require_encryption=True) if tls else Security()  # dask's own settings else
        context = security.get_connection_args("client").get("ssl_context")
        secure = address.startswith("tls://")
        if security.require_encryption and not secure:
            raise RoughmdrError(f"scheduler is {address!r}: with certificates it must be tls://HOST:PORT")
        if secure and context is None:
            raise RoughmdrError(f"scheduler is {address!r}: it needs --tls-ca, --tls-cert and --tls-key")
        _check_scheduler(address, context)
        client = Client(address, security=security, timeout=_TIMEOUT, set_as_default=False)
    except RoughmdrError:
        raise
    except (OSError, TimeoutError, ValueError, TypeError, RuntimeError) as error:
        raise RoughmdrError(f"scheduler is {address!r}: no dask scheduler answers there ({error})") from None
    with _quiet_logs(), client:
        yield Cluster(client)


@contextmanager
def _quiet_logs() -> Iterator[None]:
    """Silence dask, which reports a lost connection with a traceback: here an error says so in words."""
    logs = [logging.getLogger(f"distributed.{part}") for part in ("client", "batched", "core", "comm")]
    levels = [log.level for log in logs]
    for log in logs:
        log.setLevel(logging.CRITICAL)
    try:
        yield
    finally:
        for log, level in zip(logs, levels, strict=True):
            log.setLevel(level)


class Backend(NamedTuple):
    """A scheduler, its number of workers, and the size of their tasks."""

    scheduler: "str | Client" = "threads"  # "threads", "processes", the address of a dask cluster, or a Client of one
    workers: int = 2
    tls: Mapping[str, str] | None = None  # files for an encrypted connection, as distributed.Security names them
    runs_per_task: int | None = None  # None for as many as make a task worth its overhead

    def check(self) -> None:
        """RoughmdrError where the scheduler or the number of workers cannot be."""
        workers, scheduler = self.workers, self.scheduler
        if isinstance(workers, bool) or not isinstance(workers, int) or workers < 1:
            raise RoughmdrError(f"workers is {workers!r}; it must be a whole number of at least 1")
        if isinstance(scheduler, str):
            allowed = scheduler in _LOCAL or scheduler.startswith(_ADDRESSES)
        else:
            allowed = type(scheduler).__module__.startswith("distributed.")  # distributed is not imported for this
        if not allowed:
            raise RoughmdrError(
                f"scheduler is {scheduler!r}; it must be 'threads', 'processes', or the address of a dask cluster, "
                "tcp://HOST:PORT or tls://HOST:PORT, or in Python a Client of one"
            )

    @property
    def is_local(self) -> bool:
        """Whether the tasks are computed on this machine, by workers that are started for them."""
        return isinstance(self.scheduler, str) and self.scheduler in _LOCAL

    def for_runs_of(self, plan: "Plan") -> "Backend":
        """Return this backend, of threads with one where the runs of a plan hold Python's lock."""
        from roughmdr.batch.estimate import holds_lock

        return self._replace(workers=1) if self.scheduler == "threads" and holds_lock(plan) else self

    def pool(self) -> AbstractContextManager[Pool]:
        """Open the pool that computes the tasks; RoughmdrError where a cluster does not answer."""
        if not isinstance(self.scheduler, str):
            return nullcontext(Cluster(self.scheduler))
        if self.scheduler == "processes":
            return closing(Processes(self.workers))
        if self.scheduler == "threads":
            return nullcontext(Threads(self.workers))
        return connected(self.scheduler, self.tls)
