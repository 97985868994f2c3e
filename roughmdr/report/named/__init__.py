"""Which of the named laws apply to a scene, and what they say along the way of its flat."""

from roughmdr.report.named import gaussian, summits
from roughmdr.report.named.law import TheoryCurve

LAWS: dict[str, TheoryCurve] = {**summits.LAWS, **gaussian.LAWS}

__all__ = ["LAWS", "TheoryCurve"]
