"""Error against run time, one curve a method: of one asperity, and of the mean law of a rough surface.

    python pipelines/work_precision.py -o results/studies

Errors are those against many digits, of the force at given separations, the contact area and the pull-off force; run
times are those of a curve of 50 to 200 states. A method joins by a line in ``work_precision_tip.METHODS`` or
``work_precision_rough.METHODS``. Writes work_precision.nc and work_precision.png.
"""

import warnings
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np
import work_precision_rough as rough
import work_precision_tip as tip
import xarray as xr
from studies.study import Study, named, table
from work_precision_picture import draw
from work_precision_points import QUANTITIES, Method, Point, Reference

import roughmdr as rm

TARGETS = (0.1, 0.01, 1e-3, 1e-4)
_AUTO = "auto, error asked for"


class Part(NamedTuple):
    """Some scenes, the ways to their curves, and what these are held against."""

    scenes: dict[str, Any]
    methods: tuple[Method, ...]
    reference: Callable[..., Reference]

    def measured(self, quick: bool) -> Iterator[tuple[str, Method, Point]]:
        """Scene, method and point, of all; quick without the last scene."""
        for title, scene in list(self.scenes.items())[: -1 if quick else None]:
            exact = self.reference(scene, quick=quick)
            for method in self.methods:
                for point in method.points(scene, exact, quick):
                    yield title, method, point


PARTS = (
    Part(tip.TIPS, tip.METHODS, tip.reference),
    Part(rough.SURFACES, rough.METHODS, rough.reference),
)


def study(quick: bool) -> xr.Dataset:
    """All points, and what is cheapest."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rm.LimitWarning)  # all ways suppose the same
        found = [each for part in PARTS for each in part.measured(quick)]
    titles, methods, points = zip(*found, strict=True)
    return xr.Dataset(
        {
            "error": (("point", "quantity"), [point.errors for point in points], named("relative error of a quantity")),
            "seconds": ("point", [point.seconds for point in points], named("run time of a curve", "s")),
            "evaluations": (
                "point",
                np.array([point.evaluations for point in points], dtype=float),
                named("evaluations of a state, a profile, an integrand or a spring for a curve"),
            ),
            "setting": ("point", [float(point.setting) for point in points], named("what the error is set by")),
            "setting_of": ("point", [method.setting for method in methods]),
            "competes": (
                "point",
                [int(method.competes) for method in methods],
                named("whether it may be the cheapest"),
            ),
        },
        {
            "scene": ("point", list(titles)),
            "method": ("point", [method.name for method in methods]),
            "quantity": list(QUANTITIES),
        },
    )


def cheapest(result: xr.Dataset, scene: str, quantity: str, error: float) -> xr.Dataset | None:
    """The point of least run time that comes to an error in a quantity; None where none does."""
    competes = (result.scene == scene) & (result.competes == 1)
    enough = np.flatnonzero(competes & (result.error.sel(quantity=quantity) <= error))
    if enough.size == 0:
        return None
    return result.isel(point=enough[np.argmin(result.seconds.to_numpy()[enough])])


def _in_words(point: xr.Dataset | None) -> str:
    """A point: the method, its run time and its counted evaluations."""
    if point is None:
        return "none"
    value, of = float(point.setting), str(point.setting_of.item())
    setting = "" if of == "-" else f", {value:g} {of.removesuffix('s') if value == 1.0 else of}"
    return f"{point.method.item()}{setting}: {1e3 * float(point.seconds):.2g} ms ({float(point.evaluations):,.0f})"


def _of(result: xr.Dataset, scene: str) -> xr.Dataset:
    return result.isel(point=np.flatnonzero(result.scene.to_numpy() == scene))


def _points(result: xr.Dataset, method: str) -> Iterator[xr.Dataset]:
    for number in np.flatnonzero(result.method.to_numpy() == method):
        yield result.isel(point=number)


def tell(result: xr.Dataset) -> str:
    """What is cheapest for each error, and what came of errors that were asked for."""
    lines = ["The cheapest method for an error: run time of a curve, in brackets the evaluations counted in it.\n"]
    scenes = list(dict.fromkeys(result.scene.to_numpy().tolist()))
    for quantity in QUANTITIES:
        rows = [
            [scene, *(_in_words(cheapest(result, scene, quantity, error)) for error in TARGETS)]
            for scene in scenes
            if not np.isnan(_of(result, scene).error.sel(quantity=quantity)).all()
        ]
        lines += [table([f"error of the {quantity}", *(f"{100 * error:g} %" for error in TARGETS)], rows), ""]
    rows = [
        [
            scene,
            f"{100 * float(point.setting):g} %",
            f"{100 * float(point.error.sel(quantity='force')):.1g} %",
            f"{1e3 * float(point.seconds):.2g} ms ({float(point.evaluations):,.0f})",
            _in_words(cheapest(result, scene, "force", float(point.setting))),
        ]
        for scene in scenes
        for point in _points(_of(result, scene), _AUTO)
    ]
    head = ['[accuracy] method = "auto"', "asked", "came to", "cost", "cheapest, had one known"]
    return "\n".join([*lines, table(head, rows)])


STUDY = Study("work_precision", "Error against run time", study, draw, tell)

if __name__ == "__main__":
    STUDY.command()
