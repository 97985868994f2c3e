"""Where tasks are computed: threads or processes of this machine, or a dask cluster."""

from collections.abc import Mapping
from contextlib import AbstractContextManager, closing, nullcontext
from typing import TYPE_CHECKING, NamedTuple

from roughmdr.errors import RoughmdrError
from roughmdr.runner.cluster import Cluster, connected
from roughmdr.runner.local import Pool, Processes, Threads

if TYPE_CHECKING:
    from distributed import Client

    from roughmdr.batch.plan import Plan

_LOCAL = ("threads", "processes")
_ADDRESSES = ("tcp://", "tls://")


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
