"""[reference]: the surface itself, pressed by boundary elements beside the law of its asperities, without adhesion."""

import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

import numpy as np

from roughmdr.errors import SceneError
from roughmdr.schema.faults import mismatch
from roughmdr.schema.quantities import Quantity
from roughmdr.stages.conduction import RADIUS, Conduction, of_contacts
from roughmdr.stages.stage import Contacts, Given, Law, Stage
from roughmdr.variables import REFERENCE_VARIABLES

if TYPE_CHECKING:
    from roughmdr.aggregate.law import LoadSeparation
    from roughmdr.ensemble import Ensemble
    from roughmdr.loading.lateral import Path

_CONTROLS = ("separation", "force", "pressure")
_ERRORS = 1e-3, 0.5
"""Least and largest error of the force [1] that can be asked for."""
_ALWAYS = ("reference_force", "reference_error", "reference_area_error")
_AREAS = "reference_contact_area", "reference_contact_fraction"
OF_AREA = {"reference_force": 0.0, "reference_pressure": 0.0}
OF_AREA |= dict.fromkeys(("reference_contact_area", "reference_contact_fraction"), 1.0)
OF_AREA |= dict.fromkeys(("reference_stiffness", "reference_conductance_radius"), 0.5)
OF_AREA |= dict.fromkeys(("reference_thermal_conductance", "reference_electrical_conductance"), 0.5)
"""Relative error of a variable at given force over that of the contact area, by the grid."""
_STEP, _POINT = 5e-3, 3e-6
"""Seconds of a separation, and of a point there on all its grids."""
_COARSEST = 0.02
"""Error of the force [1] where none is asked for; a coarser grid may not have the contacts of a map at all."""
_EDGES = 0.6
"""Error of the contact area by the edges of contacts over the root of the error of the force, on one grid."""
_LOOKS = 4.0
"""Separations that are tried for a load."""
_ALONE, _BYTES = 4.0, 160
"""Factor on the points around a surface that stands alone; bytes of a point."""


class Reference(Stage):
    """[reference]: boundary elements beside each realisation.

    The force is right to ``error`` as far as the grid is concerned: relative to itself, and where it is below 1 % of
    the largest one to that.
    """

    key = "reference"
    about = "The surface itself by boundary elements, beside the law of its asperities, without adhesion"
    about_absent = "boundary elements"
    small_scene: ClassVar[Mapping[str, Any]] = {"reference": {"model": "boundary_elements", "error": 0.5}}
    swept = False
    on_grid = True

    model: Literal["boundary_elements"]
    """Method."""
    error: Annotated[float, Quantity("1", at_least=_ERRORS[0], at_most=_ERRORS[1])] = _COARSEST
    """Relative error of its force by the grid."""

    def check(self, scene: Given) -> None:
        if scene.work > 0.0:
            raise mismatch("reference", "does not go with adhesion: boundary elements press without it")
        if scene.path.lateral is not None:
            raise mismatch("reference", "does not go with path.lateral")
        if scene.path.control not in _CONTROLS:
            raise mismatch("reference", f"goes with path.{', path.'.join(_CONTROLS)}, not with path.{scene.path.key}")

    def reason_against(self, scene: Given, estimator: str) -> str:
        if estimator != "expected":
            return ""
        return "the reference presses single surfaces, which the expected law does not know"

    def check_read(self, scene: Given, ensemble: "Ensemble") -> None:
        """Raise SceneError where asperities from a file have no positions, or must repeat and have no patch."""
        from roughmdr.interaction.placed import sides_of

        if not {"x", "y"} <= ensemble.positions.keys():
            raise SceneError("reference: boundary elements need x and y [m] of every asperity")
        if ensemble.origin == "hills" and scene.asperities.source == "file":
            raise SceneError(
                "reference: hills in a file do not say how their map looks; give the map, source = 'surface'"
            )
        if scene.repeats and sides_of(ensemble) is None:
            raise SceneError("reference: a surface that repeats needs patch, patch_x and patch_y, or nominal_area")

    def more_variables(self, names: list[str]) -> list[str]:
        beside = {*_ALWAYS, *(f"reference_{name}" for name in names)}
        return [name for name in REFERENCE_VARIABLES if name in beside]

    def beside(self, scene: Given, separations: int, *, finest: bool) -> tuple[float, float]:
        from roughmdr.elements.refine import LARGEST_GRID, first_points

        along = LARGEST_GRID if finest else first_points(scene.asperities.expected_count, self.error)
        points = along**2 * (1.0 if scene.repeats else _ALONE)
        looks = separations * (1.0 if scene.path.control == "separation" else _LOOKS)
        return looks * (_STEP + _POINT * points), _BYTES * points

    @staticmethod
    def error_for(name: str, error: float, *, at_force: bool) -> float:
        """Return the error of the force by a grid on which a variable has a relative ``error``, about."""
        of_area = OF_AREA.get(name, 0.0) if at_force else 0.0
        return min(max((error / (_EDGES * of_area)) ** 2 if of_area else error, _ERRORS[0]), _COARSEST)

    def error_of(self, name: str, summits: float, *, at_force: bool) -> float:
        """Return the relative error of a variable by the grid, about: at given force that of the edges of contacts.

        So many ``summits`` may be more than the largest grid resolves.
        """
        from roughmdr.elements.refine import least_error

        of_area, error = OF_AREA.get(name, 0.0) if at_force else 0.0, max(self.error, least_error(summits))
        return _EDGES * of_area * math.sqrt(error) if of_area else error

    def plan_lines(self, longest: str, finest: str) -> Iterator[str]:
        yield f"boundary elements beside each realisation, their grid right to {self.error:g};"
        yield f"few and small contacts need finer grids: in all up to about {longest}, and {finest} for the grids"

    def law(self, scene: Given, contacts: Contacts) -> Law:
        """Return the law with the variables of the reference, of asperities that were drawn."""
        problem, realization = contacts.problem, contacts.realization
        if problem is None or realization is None:
            return contacts.law

        def law(path: "Path", names: list[str]) -> "LoadSeparation":
            asked = [name for name in names if name not in REFERENCE_VARIABLES]
            return self._beside(contacts.law(path, asked).only(asked), scene, path, problem.ensemble, realization)

        return law

    def _beside(
        self, law: "LoadSeparation", scene: Given, path: "Path", ensemble: "Ensemble", realization: int
    ) -> "LoadSeparation":
        """Return the law of a realisation with the variables of its reference; NaN where that has no equilibrium."""
        from roughmdr.elements.refine import errors, solve_to_error, solve_under_loads
        from roughmdr.elements.surface import surface_of
        from roughmdr.loading.machine import MachinePath

        height_map = scene.asperities.height_map(scene.seed, realization)
        loaded = isinstance(path, MachinePath)
        separation = law.variables["separation"] if loaded else path.values
        highest = float(ensemble.height.max())
        lowest = float(np.fmin.reduce(separation, initial=highest))
        lowest -= (highest - lowest) if loaded else 0.0  # with neighbours a load presses the flat deeper
        surface = surface_of(ensemble, height_map, lowest, periodic=scene.repeats)
        given = surface, separation, scene.effective_modulus, self.error
        stiffness = not {"stiffness", RADIUS}.isdisjoint(of_contacts(law.variables))
        if isinstance(path, MachinePath):
            separation, found = solve_under_loads(*given, -path.demand)
        else:
            found = solve_to_error(*given, stiffness=stiffness)
        numbers = [
            (step.force, step.area, step.contacts, step.stiffness, step.error, step.area_error) for step in found.steps
        ]
        force, area, count, slope, error, area_error = np.array(numbers).T
        solved, missed = np.isfinite(error), np.where(error > 0.0, 1.0, 0.0)
        bears = (force > 0.0) & solved
        patch, radius = ensemble.nominal_area or math.nan, 0.5 * slope / scene.effective_modulus
        conduction = scene.stage(Conduction)
        conductances = {} if conduction is None else conduction.conductances(radius)
        values = {
            "reference_separation": separation,
            "reference_force": force,
            "reference_contact_area": area,
            "reference_contact_count": count,
            "reference_stiffness": slope,
            "reference_pressure": force / patch,
            "reference_contact_fraction": area / patch,
            "reference_conductance_radius": radius,
            **{f"reference_{name}": value for name, value in conductances.items()},
            "reference_error": np.divide(error, force, out=missed.copy(), where=bears).clip(max=1.0),
            "reference_area_error": np.divide(area_error, area, out=missed.copy(), where=bears).clip(max=1.0),
        }
        beside = {name: np.where(solved, values[name], math.nan) for name in self.more_variables(list(law.variables))}
        remarks = _remarks(
            float(errors(found).max()), self.error, found.shape, int(np.sum(~solved & np.isfinite(separation)))
        )
        return law._replace(
            variables=law.variables | beside,
            reference_points=float(math.prod(found.shape)),
            warnings=(*law.warnings, *remarks),
        )

    @classmethod
    def result_lines(cls, result: Any) -> Iterator[tuple[str, str]]:
        """Yield the deviation of the mean force from the reference, where that is at least ``LIGHT`` of the largest."""
        name = next(
            (each for each in ("force", "pressure") if result.holds(each) and result.holds(f"reference_{each}")), None
        )
        if name is None:
            return
        from roughmdr.elements.refine import LIGHT

        force, reference, error = (result.mean(each)[0] for each in (name, f"reference_{name}", "reference_error"))
        points = float(np.nanmax(result.variables["reference_points"].values))
        largest = np.nanmax(reference, axis=-1, initial=0.0)[..., None]
        told = (reference > 0.0) & (reference >= LIGHT * largest) & np.isfinite(force)
        if not told.any():
            missed = "" if float(np.nanmax(error, initial=0.0)) == 0.0 else ", but may have missed light contacts"
            yield cls.key, f"boundary elements found no force along the whole path{missed}"
            return
        weight = np.where(largest > 0.0, np.maximum(reference, LIGHT * largest), 1.0)
        own = float(np.nanmax(error * reference / weight))
        area = ""
        if result.holds("reference_area_error") and any(map(result.holds, _AREAS)):
            of_area = result.mean("reference_area_error")[0][told]
            area = f" (area at given force: {_percent(of_area.min())} to {_percent(of_area.max())} %)"
        off = force[told] / reference[told] - 1.0
        least, most, rms = _percent(off.min(), "+"), _percent(off.max(), "+"), _percent(np.sqrt(np.mean(off * off)))
        yield (
            cls.key,
            f"boundary elements on up to {points:.0f} points, right to about {_percent(own)} %{area}: the mean force "
            f"of the law differs from theirs by {least} to {most} %, {rms} % r.m.s., where theirs is above "
            f"{100.0 * LIGHT:g} % of the largest",
        )


def _remarks(error: float, asked: float, shape: tuple[int, int], lost: int) -> Iterator[str]:
    """Yield warnings that boundary elements miss the error asked for, or have no equilibrium."""
    nx, ny = shape
    if math.isinf(error):
        yield f"reference: {nx} x {ny} points miss the contacts; none of its forces is right"
    elif error > asked:
        yield (
            f"reference: {nx} x {ny} points give the force to {error:.2g} only; {asked:g} was asked for, and is out of "
            "reach of finer grids in about a minute: contacts of few points bear the force"
        )
    if lost:
        yield f"reference: no equilibrium at {lost} steps, where the flat is below the mean height of the surface"


def _percent(share: float, sign: str = "") -> str:
    """Return a share in per cent with about two digits."""
    value = 100.0 * share
    return f"{value:{sign}.0f}" if abs(value) >= 9.95 else f"{value:{sign}.2g}"
