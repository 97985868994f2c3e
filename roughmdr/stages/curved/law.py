"""The law of a curved body on a flat with a rough layer between them, along the path of the body."""

import math
from collections.abc import Iterable, Iterator

import numpy as np

from roughmdr import expected
from roughmdr.aggregate import LoadingPath, LoadSeparation
from roughmdr.aggregate.totals import AREA, COUNT, RADIUS
from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.errors import OutOfRange
from roughmdr.expected.pull_off import ends_apart
from roughmdr.loading.pull_off import WITHOUT_TENSION, PullOff, unloadings
from roughmdr.numerics.arguments import Floats
from roughmdr.shapes import Shape
from roughmdr.stages.curved.follow import Body, Place
from roughmdr.stages.curved.local_law import LocalLaw
from roughmdr.stages.curved.refine import Layer, Solution, solve

_MAX_ERROR = 0.1  # largest numerical error over the largest force: beyond, the law is refused
_FEW = 10  # number of contacts with a standard deviation of a third
_OF_LAYER = ("model_error_curve",)
"""Variables taken from the ring where the layer is pressed most."""
_PARTS, _MAX_ROUNDS = 8, 12  # parts into which steps beside the lowest force are divided, and how often
_FINE = 0.1  # difference of forces, over their error, at which steps are close enough


def compute(layer: Layer, shape: Shape, path: LoadingPath, *, error: float, variables: Iterable[str]) -> LoadSeparation:
    """Return the law of a body of this shape along a path of its apex.

    The force has an estimated error of at most ``error`` times the largest, or a warning says which it has. OutOfRange
    where there is no equilibrium, or no number for it; TooMuchContact where the layer is full somewhere.
    """
    names, separation = list(variables), path.separation
    solution = _solved(layer, shape, separation, error)
    body, places = solution.body, solution.places
    own = _variables(body, places)
    if not all(np.isfinite(values).all() for values in own.values()):
        raise OutOfRange(f"the contact of the {shape.name} is not representable")
    ring = int(np.argmin(np.min([place.state.s for place in places], axis=0)))
    pressed = np.array([place.state.s[ring] for place in places])
    local = _of_layer(layer, pressed, names)
    law = body.half.law
    numerical = solution.error + local.numerical_error + _rule_error(solution, law)
    if not numerical <= _MAX_ERROR:
        raise OutOfRange(f"the force of the {shape.name} is right only to {numerical:.1g} of its largest")
    error_of_layer = local.model_error
    late = separation[pressed <= error_of_layer.named["trusted_separation"]]
    trusted = {"trusted_separation": float(late.max()) if late.size else math.nan}
    own |= local.variables
    local = with_body(local._replace(variables=own), shape)
    return local._replace(
        variables={name: own[name] for name in names},
        numerical_error=numerical,
        model_error=error_of_layer._replace(named=error_of_layer.named | trusted),
        pull_off=pull_off_of(body, places, separation, error),
        warnings=(*local.warnings, *_remarks(solution.error, error, own["contact_count"])),
    )


def _solved(layer: Layer, shape: Shape, separation: Floats, error: float) -> Solution:
    """Return the rings at each step; without adhesion, which has no memory, each separation is solved once."""
    if layer.adhesion.work > 0.0:
        return solve(layer, shape, separation, error)
    descending, step = np.unique(-separation, return_inverse=True)
    solution = solve(layer, shape, -descending, error)
    return solution._replace(places=[solution.places[number] for number in step.tolist()])


def _variables(body: Body, places: list[Place]) -> dict[str, Floats]:
    """Return the variables of the whole body over the steps."""
    totals = [body.totals(place) for place in places]
    return {
        "force": body.force(places),
        "contact_area": np.array([total[AREA] for total in totals]),
        "contact_count": np.array([total[COUNT] for total in totals]),
        "contact_radius_sum": np.array([total[RADIUS] for total in totals]),
        "stiffness": np.array([body.stiffness(place) for place in places]),
        "nominal_contact_radius": np.array([body.contact_radius(place) for place in places]),
    }


def _of_layer(layer: Layer, pressed: Floats, names: list[str]) -> LoadSeparation:
    """Return the law of the layer along the path of the ring that is pressed most: its errors and its limits."""
    path = LoadingPath.along(pressed, unload=False, adhesive=layer.adhesion.work > 0.0)
    return expected.compute(
        layer.source.unbounded,
        path,
        effective_modulus=layer.effective_modulus,
        adhesion=layer.adhesion,
        variables=[name for name in _OF_LAYER if name in names],
    )


def _rule_error(solution: Solution, law: LocalLaw) -> float:
    """Return the error by the rule over the shape parameters, over the largest pressure of all rings and steps."""
    peak = max(float(np.abs(place.state.pressure).max()) for place in solution.places)
    deepest = np.array([law.closest])
    largest = abs(float(law.pressure(deepest, law.untouched(1))[0][0]))
    return solution.rule_error * max(largest / peak, 1.0) if peak > 0.0 else 0.0


def with_body(law: LoadSeparation, shape: Shape) -> LoadSeparation:
    """Return the law with the extremes of the body itself, at its nominal contact radii, among its own."""
    widest = np.array([np.nanmax(law.variables["nominal_contact_radius"], initial=0.0)])
    of_body, of_contacts = Ensemble.alike(shape, np.zeros(1), {}, math.inf).validity_limits(widest), law.extremes
    slope, extent = max(of_contacts.slope, of_body.slope), max(of_contacts.extent, of_body.extent)
    return law._replace(extremes=of_contacts._replace(slope=slope, extent=extent))


def _remarks(error: float, asked: float, contacts: Floats) -> Iterator[str]:
    """Yield warnings of rings that do not reach the error asked for, and of too few contacts for their mean."""
    if error > asked:
        change = f"{error:.2g} of its largest with finer rings; {asked:g} was asked"
        yield f"the force of the curved body changes by {change}"
    if 0.0 < (most := float(contacts.max(initial=0.0))) < _FEW:
        yield (
            f"no more than {most:.2g} asperities in contact on average: a body on so few meets each of them, and its "
            f"force differs from this mean from place to place (warned of below {_FEW})"
        )


def pull_off_of(body: Body, places: list[Place], separation: Floats, error: float) -> PullOff:
    """Return the pull-off, given the rings at each step of the path; NaN where no unloading ends out of contact.

    The force is right to ``error`` over the largest.
    """
    force = body.force(places)
    rises = unloadings(separation, force)
    contacts = np.array([body.totals(place)[COUNT] for place in places])
    if not ends_apart(rises, contacts):
        return PullOff()
    if not body.half.law.adhesive:
        return WITHOUT_TENSION
    rise = min(rises, key=lambda each: float(each.force.min()))
    at = rise.last - rise.separation.size + 1 + int(np.argmin(rise.force))
    if not force[at] < 0.0:
        return WITHOUT_TENSION
    lowest, least = places[at], float(force[at])
    before, after = places[max(at - 1, rise.last - rise.separation.size + 1)], separation[min(at + 1, rise.last)]
    for _ in range(_MAX_ROUNDS):
        between = body.along(np.linspace(before.h, after, _PARTS + 1)[1:], before)
        forces = body.force(between)
        k = int(np.argmin(forces))
        if forces[k] < least:
            lowest, least = between[k], float(forces[k])
        last = float(forces[k - 1]) if k > 0 else float(body.force([before])[0])
        before, after = (between[k - 1] if k > 0 else before), between[min(k + 1, _PARTS - 1)].h
        if abs(last - forces[k]) <= _FINE * error * abs(least):
            break
    totals = body.totals(lowest)
    return PullOff(least, lowest.h, totals[COUNT], totals[AREA])
