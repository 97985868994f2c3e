"""The reference beside the law of a realisation: the surface of its asperities pressed by boundary elements."""

import math
from collections.abc import Iterable

import numpy as np

from roughmdr.aggregate import LoadSeparation
from roughmdr.ensemble import Ensemble
from roughmdr.errors import SceneError
from roughmdr.interaction.placed import sides_of
from roughmdr.layer.conductance import RADIUS, conductances, of_contacts
from roughmdr.numerics.arguments import Floats
from roughmdr.scene import Scene
from roughmdr.variables import REFERENCE_VARIABLES

_ALWAYS = ("reference_force", "reference_error")


def reference_variables(asked: Iterable[str]) -> list[str]:
    """Return the variables of the reference of a scene whose output has those that are asked for."""
    beside = {*_ALWAYS, *(f"reference_{name}" for name in asked)}
    return [name for name in REFERENCE_VARIABLES if name in beside]


def check_surface(scene: Scene, ensemble: Ensemble) -> None:
    """SceneError where asperities that are read do not make a surface: without positions, or a patch that repeats."""
    if not {"x", "y"} <= ensemble.positions.keys():
        raise SceneError("reference: boundary elements need x and y [m] of every asperity")
    if ensemble.origin == "hills" and scene.asperities.source == "file":
        raise SceneError("reference: hills in a file do not say how their map looks; give the map, source = 'surface'")
    if scene.repeats and sides_of(ensemble) is None:
        raise SceneError("reference: a surface that repeats needs patch, patch_x and patch_y, or nominal_area")


def with_reference(
    law: LoadSeparation, scene: Scene, separation: Floats, realization: int, ensemble: Ensemble
) -> LoadSeparation:
    """Return the law of a realisation with the variables of its reference; NaN where that has no equilibrium."""
    from roughmdr.elements.refine import errors, solve_to_error
    from roughmdr.elements.surface import surface_of_asperities, surface_of_map

    assert scene.reference is not None
    height_map = scene.asperities.height_map(scene.seed, realization)
    if height_map is None:
        surface = surface_of_asperities(ensemble, float(separation.min()), periodic=scene.repeats)
    else:
        surface = surface_of_map(height_map, ensemble.height, periodic=scene.repeats)
    stiffness = not {"stiffness", RADIUS}.isdisjoint(of_contacts(law.variables))
    found = solve_to_error(surface, separation, scene.effective_modulus, scene.reference.error, stiffness=stiffness)
    numbers = [(step.force, step.area, step.contacts, step.stiffness, step.error) for step in found.steps]
    force, area, count, slope, error = np.array(numbers).T
    solved = np.isfinite(error)
    relative = np.divide(error, force, out=np.where(error > 0.0, 1.0, 0.0), where=(force > 0.0) & solved)
    patch, radius = ensemble.nominal_area or math.nan, 0.5 * slope / scene.effective_modulus
    values = {
        "reference_force": force,
        "reference_contact_area": area,
        "reference_contact_count": count,
        "reference_stiffness": slope,
        "reference_pressure": force / patch,
        "reference_contact_fraction": area / patch,
        "reference_conductance_radius": radius,
        **{f"reference_{name}": value for name, value in conductances(radius, scene.conductance_factors).items()},
        "reference_error": np.minimum(relative, 1.0),
    }
    reference = {name: np.where(solved, values[name], math.nan) for name in reference_variables(law.variables)}
    remarks = _remarks(float(errors(found).max()), scene.reference.error, found.shape, int(np.sum(~solved)))
    return law._replace(
        variables=law.variables | reference,
        reference_points=float(math.prod(found.shape)),
        warnings=(*law.warnings, *remarks),
    )


def _remarks(error: float, asked: float, shape: tuple[int, int], lost: int) -> list[str]:
    """Return how far boundary elements fall short."""
    lines = []
    nx, ny = shape
    if math.isinf(error):
        lines.append(f"reference: {nx} x {ny} points miss the contacts; none of its forces is right")
    elif error > asked:
        lines.append(
            f"reference: {nx} x {ny} points give the force to {error:.2g} only; {asked:g} was asked for, and is out of "
            "reach of finer grids in about a minute: contacts of few points bear the force"
        )
    if lost:
        lines.append(
            f"reference: no equilibrium at {lost} steps, where the flat is below the mean height of the surface"
        )
    return lines
