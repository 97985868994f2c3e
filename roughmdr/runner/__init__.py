"""The batch, run: a plan's tasks over threads, processes or a cluster, what they find into one dataset."""

from roughmdr.runner.batch import execute, run
from roughmdr.runner.cluster import Tls

__all__ = ["Tls", "execute", "run"]
