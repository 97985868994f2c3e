"""The memory that this process can still get, and what limits it."""

import math
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

from roughmdr.errors import StoreError
from roughmdr.schema.wording import format_bytes


def check_memory(size: float, what: str, advice: str = "") -> None:
    """Raise StoreError, with figures, if ``what`` takes ``size`` [byte] more than can be had."""
    if size > available_memory()[0]:
        hint = advice and f"; {advice}"
        raise StoreError(f"{what} takes about {format_bytes(size)} of memory, with {describe_available_memory()}{hint}")


def describe_available_memory() -> str:
    """Return how much memory is left, and what limits it, in words."""
    left, limit = available_memory()
    return f"{format_bytes(max(left, 0.0))} left of {limit or 'an unknown amount'}"


def available_memory() -> tuple[float, str]:
    """Return how much more this process can be given [byte], and the limit in words; inf if it is not known."""
    return min(_limits(), default=(math.inf, ""))


def peak_memory() -> float:
    """Return the most memory that this process has had so far [byte]; 0 if it is not known."""
    # From /proc where there is one, since getrusage also counts the parent process before a fork.
    if peak := _read_sizes("/proc/self/status").get("VmHWM"):
        return peak
    with suppress(ImportError):
        import resource

        return float(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)  # bytes, where there is no /proc
    return 0.0


def _limits() -> Iterator[tuple[float, str]]:
    used = _read_sizes("/proc/self/status")
    with suppress(ImportError, AttributeError):
        import resource

        for name, key, words in (("AS", "VmSize", "address space (ulimit -v)"), ("DATA", "VmData", "data (ulimit -d)")):
            limit = resource.getrlimit(getattr(resource, f"RLIMIT_{name}"))[0]
            if key in used and limit != resource.RLIM_INFINITY:
                yield limit - used[key], f"the {format_bytes(limit)} of {words}"
    machine = _read_sizes("/proc/meminfo")
    if machine and "VmRSS" in used:
        total = machine["MemTotal"] + machine["SwapTotal"]
        yield total - used["VmRSS"], f"the {format_bytes(total)} of this machine"


def _read_sizes(path: str) -> dict[str, float]:
    """Return the sizes [byte] in a file of /proc; none if there is no such file."""
    sizes = {}
    with suppress(OSError):
        for line in Path(path).read_text().splitlines():
            name, _, size = line.partition(":")
            if size.endswith(" kB"):
                sizes[name] = 1024.0 * int(size[:-3])
    return sizes
