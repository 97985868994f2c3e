"""The cost of a contact and step by shape and law: force with its error, area and count, 200 steps in and out."""

from typing import Any

import numpy as np
import xarray as xr
from studies.study import named

import roughmdr as rm
from benchmarks.sums import MODULUS, RADIUS, SHAPES, TOTALS, WORK, by_the_sum, each, ensemble_of
from roughmdr.kernels.adhesion import Adhesion

SLOPE = {"distribution": "uniform", "loc": 0.08, "scale": 0.04}
ALL: dict[str, dict[str, Any]] = {
    "paraboloid": {"radius": RADIUS},
    "cone": {"slope": SLOPE},
    "flat_punch": {"radius": {"distribution": "uniform", "loc": 1e-6, "scale": 2e-6}},
    **SHAPES,
    "sphere": {"radius": RADIUS},
    "truncated_cone": {"slope": SLOPE, "flat_radius": "2 um"},
    "truncated_paraboloid": {"radius": RADIUS, "flat_radius": "2 um"},
    "rounded_cone": {"slope": SLOPE, "blend_radius": "5 um"},
    "rounded_punch": {"flat_radius": "2 um", "edge_radius": RADIUS},
}
LAWS = ("none", "jkr", "dugdale")
_SLOW = {("tabulated", "dugdale"): 0.001}
"""Share of the asperities that is measured; of all others with a range of adhesion a twentieth."""


def by_law(count: int, repeats: int) -> xr.Dataset:
    """Measure every shape with every law, and the JKR paraboloid in the same run; Tabor number 1 of 50 um."""
    one = rm.tabor(rm.Paraboloid(radius=50e-6), effective_modulus=MODULUS, work=WORK, strength=1.0)
    laws = {"none": Adhesion(), "jkr": Adhesion(WORK), "dugdale": Adhesion(WORK, "dugdale", 1.0 / one)}
    found = np.full((len(ALL), len(LAWS)), np.nan)
    reference = each(by_the_sum(ensemble_of(count), laws["jkr"], repeats, TOTALS, 200))
    for i, (shape, parameters) in enumerate(ALL.items()):
        for j, law in enumerate(LAWS):
            share = _SLOW.get((shape, law), 0.05 if law == "dugdale" and shape != "paraboloid" else 1.0)
            ensemble = ensemble_of(max(20, int(share * count)), shape, **parameters)
            found[i, j] = each(by_the_sum(ensemble, laws[law], repeats, TOTALS, 200))
    over = ("law_shape", "law")
    variables = {
        "law_time": (over, found, named("time per contact and step", "ns")),
        "law_ratio": (over, found / reference, named("time over that of the JKR paraboloid")),
    }
    return xr.Dataset(variables, {"law_shape": list(ALL), "law": list(LAWS)})
