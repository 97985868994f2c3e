"""Theory curves beside a result: to which scenes each applies, and its values along the path of the flat."""

from roughmdr.report.theory_curves import equal_summits, gaussian
from roughmdr.report.theory_curves.base import TheoryCurve

THEORY_CURVES: dict[str, TheoryCurve] = {**equal_summits.CURVES, **gaussian.CURVES}

__all__ = ["THEORY_CURVES", "TheoryCurve"]
