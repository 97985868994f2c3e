"""How much memory this process may still have, and what keeps it from more."""

import math
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

from roughmdr.errors import StoreError
from roughmdr.schema.wording import bytes_in_words


def check_room(size: float, what: str, advice: str = "") -> None:
    """StoreError, with figures, where ``what`` takes so many bytes more and cannot have them."""
    if size > room()[0]:
        hint = advice and f"; {advice}"
        raise StoreError(f"{what} takes about {bytes_in_words(size)} of memory, with {left_in_words()}{hint}")


def left_in_words() -> str:
    """How much memory is left, and of what."""
    left, whole = room()
    return f"{bytes_in_words(max(left, 0.0))} left of {whole or 'what nothing here tells'}"


def room() -> tuple[float, str]:
    """How many bytes more this process can be given at most, and of what; inf where nothing tells."""
    return min(_rooms(), default=(math.inf, ""))


def _rooms() -> Iterator[tuple[float, str]]:
    held = _lines("/proc/self/status")
    for name, has, words in (("AS", "VmSize", "address space (ulimit -v)"), ("DATA", "VmData", "data (ulimit -d)")):
        limit = _limit(name)
        if has in held and limit < math.inf:
            yield limit - held[has], f"the {bytes_in_words(limit)} of {words}"
    machine = _lines("/proc/meminfo")
    if machine and "VmRSS" in held:
        whole = machine["MemTotal"] + machine["SwapTotal"]
        yield whole - held["VmRSS"], f"the {bytes_in_words(whole)} of this machine"


def _lines(path: str) -> dict[str, float]:
    """The sizes [byte] in a file of the system; none where there is no such file."""
    found = {}
    with suppress(OSError):
        for line in Path(path).read_text().splitlines():
            name, _, size = line.partition(":")
            if size.endswith(" kB"):
                found[name] = 1024.0 * int(size[:-3])
    return found


def _limit(name: str) -> float:
    """A limit [byte] that was set for this process."""
    with suppress(ImportError, AttributeError):
        import resource

        limit = resource.getrlimit(getattr(resource, f"RLIMIT_{name}"))[0]
        return math.inf if limit == resource.RLIM_INFINITY else float(limit)
    return math.inf
