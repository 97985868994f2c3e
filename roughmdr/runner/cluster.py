"""Tasks on a dask cluster that is there already: some in flight, so that memory stays bounded; lost ones again."""

import logging
import socket
import sys
import threading
import time
import uuid
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, NamedTuple
from urllib.parse import urlsplit

from roughmdr.batch.tasks import Task, compute, failed
from roughmdr.errors import RoughmdrError, Unfinished
from roughmdr.runner.local import Sink

if TYPE_CHECKING:
    import ssl

    from distributed import Client

_WINDOW = 2  # tasks in flight for each thread of the cluster: one that runs, one that is ready
_COUNTED = 1.0  # for so long [s] the number of threads is taken to be the same
_ANSWER = 30.0  # how long [s] a scheduler may take to answer


class Tls(NamedTuple):
    """The files that an encrypted connection needs."""

    ca: str
    cert: str
    key: str


class Cluster:
    """The workers of a dask scheduler; whoever they are, and whether they come or go."""

    def __init__(self, client: "Client") -> None:
        self._client = client
        self._threads, self._counted = 0, -_COUNTED

    @property
    def workers(self) -> int:
        """How many threads there are, at least one."""
        if time.monotonic() - self._counted > _COUNTED:
            self._threads, self._counted = sum(self._client.nthreads().values()), time.monotonic()
        return max(1, self._threads)

    def compute(self, tasks: Iterable[Task], stop: threading.Event, sink: Sink) -> None:
        """As in ``Pool``; a task that takes its workers down with it has failed, any other is tried again."""
        from distributed import as_completed

        if not self._client.nthreads():
            print("roughmdr: the scheduler has no workers yet; waiting for some", file=sys.stderr, flush=True)
        name, flying = f"roughmdr-{uuid.uuid4().hex}", dict[Any, Task]()
        numbered = enumerate(tasks)
        done = as_completed(loop=self._client.loop)
        try:
            while True:
                while len(flying) < _WINDOW * self.workers and not stop.is_set():
                    number, task = next(numbered, (0, None))
                    if task is None:
                        break
                    future = self._client.submit(compute, task, key=f"{name}-{number}", pure=False)
                    flying[future.key] = task
                    done.add(future)
                if not flying:
                    return
                future = next(done)
                self._received(future, flying.pop(future.key), sink)
        except (OSError, TimeoutError) as error:
            raise Unfinished(f"the cluster is lost: {error or type(error).__name__}") from None

    @staticmethod
    def _received(future: Any, task: Task, sink: Sink) -> None:
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


def _check(address: str, *, encrypted: bool, certified: bool) -> None:
    """RoughmdrError where address and certificates do not go together."""
    secure = address.startswith("tls://")
    if encrypted and not secure:
        raise RoughmdrError(f"scheduler is {address!r}: with certificates it must be tls://HOST:PORT")
    if secure and not certified:
        raise RoughmdrError(f"scheduler is {address!r}: it needs --tls-ca, --tls-cert and --tls-key")


def _reach(address: str, context: "ssl.SSLContext | None") -> None:
    """OSError where nobody listens, or where it is a stranger; a client would try on and on."""
    place = urlsplit(address)
    with socket.create_connection((place.hostname or "", place.port or 0), _ANSWER) as plain:
        if context is not None and address.startswith("tls://"):
            context.wrap_socket(plain, server_hostname=place.hostname).close()


@contextmanager
def connected(address: str, tls: Tls | None) -> Iterator[Cluster]:
    """The cluster at an address, tcp://HOST:PORT or tls://HOST:PORT; RoughmdrError where there is none."""
    try:
        from distributed import Client, Security
    except ImportError:
        raise RoughmdrError(
            f"scheduler is {address!r}: clusters need the package distributed: pip install 'roughmdr[cluster]'"
        ) from None
    try:
        security = Security()  # as dask is configured
        if tls is not None:
            security = Security(
                tls_ca_file=tls.ca, tls_client_cert=tls.cert, tls_client_key=tls.key, require_encryption=True
            )
        context = security.get_connection_args("client").get("ssl_context")
        _check(address, encrypted=security.require_encryption, certified=context is not None)
        _reach(address, context)
        client = Client(address, security=security, timeout=_ANSWER, set_as_default=False)
    except RoughmdrError:
        raise
    except (OSError, TimeoutError, ValueError, TypeError, RuntimeError) as error:
        raise RoughmdrError(f"scheduler is {address!r}: no dask scheduler answers there ({error})") from None
    with _silent(), client:
        yield Cluster(client)


@contextmanager
def _silent() -> Iterator[None]:
    """What dask says of a lost connection, with a traceback, is said here in words."""
    logs = [logging.getLogger(f"distributed.{part}") for part in ("client", "batched", "core", "comm")]
    levels = [log.level for log in logs]
    for log in logs:
        log.setLevel(logging.CRITICAL)
    try:
        yield
    finally:
        for log, level in zip(logs, levels, strict=True):
            log.setLevel(level)
