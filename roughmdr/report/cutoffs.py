"""How the summits of a map, and the pressure on them, depend on the cutoff: roughmdr generate --cutoffs."""

import math
from functools import partial

import numpy as np

from roughmdr.aggregate import LoadingPath, Problem
from roughmdr.aggregate.compute import compute
from roughmdr.ensemble import SurfaceAsperities
from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.errors import RoughmdrError, SceneError
from roughmdr.loading.first_reached import first_reached
from roughmdr.numerics.arguments import Floats
from roughmdr.scene import Scene
from roughmdr.schema.units import format_quantity, quantity

_FRACTIONS = (0.01, 0.02, 0.05)
"""Summed contact areas over the nominal area."""
_HEADINGS = (
    ("cutoff", ""),
    ("rms height", ""),
    ("rms slope", ""),
    ("summits", ""),
    ("density", ""),
    ("mean radius", ""),
    ("height std", ""),
    ("points", "a summit"),
    ("misfit", ""),
    ("radii", "off by"),
    *((f"{fraction:.0%}", "pressure") for fraction in _FRACTIONS),
)
_NOTES = (
    "A cutoff takes away roughness that may be real, and pressures at a given contact area fall with the rms slope:",
    "give one only against noise that was measured. Pressures are those at which contacts of independent asperities",
    "add up to 1, 2 and 5 % of the nominal area on loading; mean radius is 1/<1/R>.",
)
_RTOL = 1e-10  # error of the separation, over its distance from where nothing touches


def tabulate_cutoffs(scene: Scene, lengths: str) -> str:
    """Return a table of the summits of a map, without a cutoff and for each of ``lengths``, as "0.2 um, 0.4 um".

    SceneError where the asperities of the scene are not from a map, or a length is not one, or does not fit the map.
    """
    section = scene.asperities
    if not isinstance(section, SurfaceAsperities):
        raise SceneError(f"--cutoffs: is for source 'surface'; asperities.source is {section.source!r}")
    try:
        cutoffs = [quantity(text.strip(), "m") for text in lengths.split(",")]
    except RoughmdrError as error:
        raise SceneError(f"--cutoffs {lengths!r}: {error}") from None
    if not min(cutoffs) > 0.0:
        raise SceneError(f"--cutoffs {lengths!r}: {min(cutoffs):g} m must be above 0")
    rows = [_row(scene, section, cutoff) for cutoff in (None, *cutoffs)]
    lines = [*zip(*_HEADINGS, strict=True), *rows]
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    table = ["  ".join(f"{text:>{width}}" for text, width in zip(line, widths, strict=True)) for line in lines]
    return "\n".join([*table, *_NOTES])


def _row(scene: Scene, section: SurfaceAsperities, cutoff: float | None) -> tuple[str, ...]:
    given = {"cutoff": cutoff, "model": "summits", "shape": None}
    summits = type(section).model_validate(section.model_dump(exclude_unset=True) | given).asperities
    attrs, count = summits.attrs, summits.height.size
    area = summits.nominal_area or math.inf

    def length(name: str) -> str:
        return format_quantity(float(attrs[name]), "m")

    return (
        "none" if cutoff is None else length("cutoff"),
        length("rms_height"),
        f"{attrs['rms_slope']:.3g}",
        str(count),
        format_quantity(count / area, "m-2"),
        length("mean_curvature_radius"),
        format_quantity(float(np.std(summits.height)), "m"),
        f"{attrs['points_per_summit']:.3g}",
        f"{attrs['misfit']:.2g}",
        f"{100.0 * float(attrs['radius_uncertainty']):.0f} %",
        *(format_quantity(pressure_at(scene, summits, fraction), "Pa") for fraction in _FRACTIONS),
    )


def pressure_at(scene: Scene, summits: Ensemble, fraction: float) -> float:
    """Return the pressure [Pa] at which the contacts of ``summits`` add up to a fraction of their nominal area.

    With adhesion, of the flat on its way in, where contacts may form by jumps: then the first pressure beyond.
    """
    problem = Problem(summits, scene.effective_modulus, scene.adhesion_model)

    def law(name: str, separation: Floats) -> Floats:
        path = LoadingPath.along(np.append(problem.clear, separation), unload=False, adhesive=scene.work > 0.0)
        return compute(problem, path, [name]).variables[name][1:]

    contact_fraction = partial(law, "contact_fraction")
    reached = first_reached(contact_fraction, fraction, problem.clear, problem.depth, _RTOL, "contact fraction")
    return float(law("pressure", np.array([reached]))[0])
