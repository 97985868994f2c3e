"""Words on the trust in a force: contact fraction, model error, its parts, and the range where it holds."""

import math
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.model_error.at_given import largest_at_force
from roughmdr.model_error.coupling import MARKED_SHARE, foreseen_error, summits_error
from roughmdr.model_error.interaction import (
    ASPERITIES,
    HILLS,
    MOST_TENSION,
    OF_ORIGIN,
    SUMMITS,
    TENSION,
    Coefficients,
    interaction_error,
)
from roughmdr.model_error.parts import (
    ALL_PARTS,
    PARTS,
    PLASTIC,
    PLASTIC_AT_FORCE,
    SOFTNESS,
    TRUSTED_ERROR,
    TRUSTED_FRACTION,
)
from roughmdr.numerics.arguments import Floats
from roughmdr.result.hardness import hardness_lines
from roughmdr.result.view import ResultView
from roughmdr.schema.units import format_quantity
from roughmdr.schema.wording import under
from roughmdr.stages import stages_in
from roughmdr.variables import LATERAL, YIELDED, YIELDING

_TOLD = 0.01  # parts of the model error below this are not mentioned
_TINY = 1e-6
_ROUNDING = 1e-9
"""Relative difference within which an error counts as that of its contact fraction."""
_NO_AREA = "not known: the asperities have no nominal area, so that nothing tells how near they are to each other"

_PULL_OFF_OF_DENTS = (
    "the pull-off force itself by an unknown amount: its dents are smooth, and real ones pull less, so that it is an "
    "upper bound"
)
_OPENINGS = {
    None: "asperities are independent: force at given separation off by",
    "mean_field": "asperities feel each other's mean displacement only: force at given separation off by",
}
_BESIDES = {PLASTIC, SOFTNESS, *PLASTIC_AT_FORCE, "grid_points", "asperity_origin"}
_NAMES = {"model_error", *PARTS, "largest_contact_fraction", "trusted_separation", "overlap_fraction"}
_BY_FRACTION = {"interaction_error", "largest_contact_fraction", "overlap_fraction"}
_AT_PULL_OFF = "pull_off_contact_fraction"

Numbers = Mapping[str, Any]
"""``ModelError.named``, numbers or arrays over the runs."""


def trust_lines(
    numbers: Numbers,
    at_pull_off: ArrayLike = (),
    *,
    interaction: str | None = None,
    advise: bool = True,
    curved: bool = False,
    summits: bool = False,
) -> Iterator[tuple[str, str]]:
    """Yield the lines "contact", "model error" and "trust" of one run or several.

    ``at_pull_off`` are contact fractions at their pull-offs; NaN, or none at all, where there is none. ``interaction``
    is the model by which asperities feel each other; with "pairwise" the numbers have "grid_points" too.
    ``advise`` says whether they could feel each other where they do not. Under a ``curved`` body the numbers are those
    of the layer where it is pressed most, or where coupled contacts crowd. ``summits``: those of a surface.
    """
    known = {name: _known(numbers[name]) for name in numbers}
    largest = known["largest_contact_fraction"]
    others = [
        f"{reason}: about {_percent(known[name].max())}"
        for name, reason in ALL_PARTS.items()
        if name != "interaction_error" and name in known and known[name].max(initial=0.0) >= _TOLD
    ]
    if not largest.size:
        yield "contact", _NO_AREA
        yield from under("model error", others)
        yield "trust", f"the force is right where asperities are far apart, which is {_NO_AREA}"
        return
    tension = _known(at_pull_off)
    at_tension = [(tension, "at pull-off")] if tension.size else []
    places = [*at_tension, (largest, "at closest approach")]
    crowded = "that contacts crowd on" if interaction == "pairwise" else "where the layer is pressed most"
    area = f" of the area {crowded}," if curved else " of the patch"
    shares = [f"{_range(fraction)}{'' if i else area} {place}" for i, (fraction, place) in enumerate(places)]
    coefficients = _coefficients(known)
    yield "contact", f"summed contact area {', '.join(shares)}"
    if not (known["model_error"] > 0.0).any():
        yield "trust", "no contact along the whole path"
        return
    independent = interaction != "pairwise" and coefficients is ASPERITIES and PLASTIC not in known
    at_force = [] if curved else _at_force(numbers, asperities=independent)
    if interaction == "pairwise":
        yield "model error", _coupling(known, summits, curved=curved)
        yield from under("", [*at_force, *others])
        yield "trust", _trust_coupled(known, summits)
        return
    if coefficients is None:
        yield "model error", _neighbours(known)
    else:
        share = float(known["interaction_error"].max() / interaction_error(largest.max(), coefficients))
        errors = [f"{_interaction(float(fraction.max()), coefficients, share)} {place}" for fraction, place in places]
        yield "model error", f"{_OPENINGS[interaction]} {errors[0]}"
        yield from (("", f"and by {error}") for error in errors[1:])
        if len(places) > 1:
            yield "", _PULL_OFF_OF_DENTS if PLASTIC in numbers else _pull_off_error(tension)
    yield from under("", [*at_force, *others])
    yield "trust", _trust(known, coefficients, interaction)
    lone = known["interaction_error"].max() == 0.0
    if advise and interaction is None and not (tension.size or lone):
        yield "", _advice(known, coefficients)


def trust_of_result(result: ResultView) -> Iterator[tuple[str, str]]:
    """Yield the lines of all runs of a result; for one of an earlier version, that the error is not known."""
    if set(result.variables) >= _NAMES:
        numbers = {name: result.variables[name].values for name in (_NAMES | _BESIDES) & set(result.variables)}
        interaction = result.attrs.get("interaction")
        unlike = any(stage.unlike for stage in stages_in(result.scene))
        advise = LATERAL.name not in result.coordinates and not unlike
        yield from trust_lines(
            numbers,
            _at_pull_off(result),
            interaction=interaction,
            advise=advise,
            curved=not result.flat,
            summits=_has_summits(result.scene),
        )
    else:
        yield "trust", "not known: the result was computed by a version that did not estimate the error of its model"
    yield from hardness_lines({name: result.known(name) for name in (*YIELDING, *YIELDED)})


def _at_force(numbers: Numbers, *, asperities: bool) -> list[str]:
    """Return in words the errors at given pressure; of independent ``asperities`` their signs are known."""
    errors = largest_at_force(numbers)
    if not errors or math.isnan(max(errors.values())):
        return []
    shares = [_percent(each) for each in errors.values()]
    area, stiffness, conductance, _ = shares
    large, small = (", mostly too large", ", mostly too small") if asperities else ("", "")
    stiff = f"and conductance {stiffness}" if stiffness == conductance else f"{stiffness}, conductance {conductance}"
    given = "given pressure on loading" if PLASTIC in numbers else "given pressure"
    return [f"at {given} at most: contact area {area}{large}; stiffness {stiff}{small}"]


def _has_summits(table: dict[str, Any]) -> bool:
    """Return whether the asperities of a scene are summits of a surface, by its source alone."""
    asperities = table.get("asperities", {})
    source, model = asperities.get("source"), asperities.get("model", "")
    return source == "nayak" or (source == "surface" and model != "hills") or (source, model) == ("spectrum", "summits")


def pull_off_error_of(result: ResultView) -> str:
    """Return in words the error of the pull-off force by independence; empty where nothing is known of it."""
    tension = _at_pull_off(result)
    if tension.size and PLASTIC in result.variables:
        return _PULL_OFF_OF_DENTS
    if not tension.size or result.attrs.get("interaction") == "pairwise":
        return ""
    known = {name: result.known(name) for name in _BY_FRACTION}
    by_fraction = not all(each.size for each in known.values()) or _coefficients(known)
    return _pull_off_error(tension) if by_fraction else ""


def _at_pull_off(result: ResultView) -> Floats:
    """Return the contact fractions at the pull-offs of a result."""
    return np.concatenate([result.known(f"{_AT_PULL_OFF}{end}") for end in ("", "_min", "_max")])


def _pull_off_error(tension: Floats) -> str:
    root = math.sqrt(float(tension.max()))
    return f"the pull-off force itself by {_percent(TENSION * root)} typically, up to {_percent(MOST_TENSION * root)}"


def _neighbours(known: dict[str, Floats]) -> str:
    """Return in words the error by distances of independent asperities, and the share that overlap."""
    error, overlap = (float(known[name].max(initial=0.0)) for name in ("interaction_error", "overlap_fraction"))
    if error == 0.0:
        return "a lone asperity feels no other: no error by interaction"
    by = f"up to {_percent(error)}" if error < 1.0 else "100 % or more of the true one"
    twice = f"; {_percent(overlap)} of the contacts overlap and count more than once" if overlap >= _TOLD else ""
    return (
        "asperities are independent, where each lowers the surface under those near it: force at given separation too "
        f"high by {by}{twice}"
    )


def _trust(known: dict[str, Floats], coefficients: Coefficients | None, interaction: str | None) -> str:
    """Return in words the error of the force, and the range where it holds."""
    parts = {name: float(known[name].max(initial=0.0)) for name in ALL_PARTS if name in known}
    place, rest, beyond = "along the whole path", "", known["trusted_separation"]
    if beyond.size:
        whole = sum(parts.values())
        there = f"within {_percent(whole)}" if whole < 1.0 else "the force may be off by all of it or more"
        left_out = "asperities interact, which this scene leaves out" if interaction is None else "it is farther off"
        rest = f"; below it {left_out}: {there} at closest approach"
        parts["interaction_error"] = float(interaction_error(np.array(TRUSTED_FRACTION), coefficients or ASPERITIES))
        contact = f" (contact {_percent(TRUSTED_FRACTION)})" if coefficients and PLASTIC not in known else ""
        place = f"down to h = {format_quantity(float(beyond.max()), 'm')}{contact}"
    error = sum(parts.values())
    if error < 1.0:
        return f"force within about {_percent(error)} {place}{rest}"
    return f"none: the force may be off by all of it, because of {ALL_PARTS[max(parts, key=parts.__getitem__)]}"


def _coupling(known: dict[str, Floats], summits: bool, *, curved: bool) -> str:
    """Return in words the coupling of asperities and its error, under a flat also that of independent ones."""
    error, overlap = (float(known[name].max(initial=0.0)) for name in ("interaction_error", "overlap_fraction"))
    if not known["overlap_fraction"].size:  # not defined for hills
        return f"hills of a map are coupled in pairs: force along the path within {_percent(error)}"
    fraction = float(known["largest_contact_fraction"].max())
    independent = _interaction(fraction, SUMMITS if summits else ASPERITIES)
    on_grid = int((known["grid_points"] > 0.0).sum())
    paired = known["grid_points"].size - on_grid
    carried = f", {_percent(overlap)} of it in contacts that overlap" if overlap > 0.0 and paired else ""
    how = "asperities are coupled in pairs" if paired else "computed by boundary elements"
    also = f", in {on_grid} of {on_grid + paired} by boundary elements" if on_grid and paired else ""
    within = f"within {_percent(max(error, _TINY))}{carried}" if error > 0.0 else "as right as the grid"
    if summits and error > 0.0:
        flanks = float(summits_error(np.array(fraction), "summits"))
        within += f", of which {_percent(min(flanks, error))} because flanks of summits are no paraboloids"
    within += "" if curved else f"; with independent asperities off by {independent}"
    return f"{how}{also}: force at closest approach {within}"


def _trust_coupled(known: dict[str, Floats], summits: bool) -> str:
    """Return in words the error of the force of coupled asperities, and the range where it holds."""
    parts = {name: float(known[name].max(initial=0.0)) for name in ALL_PARTS if name in known}
    whole, beyond, rest = sum(parts.values()), known["trusted_separation"], ""
    if beyond.size and not summits:  # flanks of summits cost more than that from first touch on
        lowest = format_quantity(float(beyond.max()), "m")
        rest = f"; the part by interaction stays within {_percent(TRUSTED_ERROR)} down to h = {lowest}"
    if whole >= 1.0:
        return "none: the force may be off by all of it"
    return f"force within about {_percent(whole)} along the whole path{rest}"


def _advice(known: dict[str, Floats], coefficients: Coefficients | None) -> str:
    """Return in words the error with [interaction], if contacts overlap as often as in this scene."""
    fraction, overlap = (known[name].max(initial=0.0) for name in ("largest_contact_fraction", "overlap_fraction"))
    if coefficients is None:
        grid = ', beyond = "boundary_elements" where contacts overlap' if overlap > MARKED_SHARE else ""
        return (
            f'[interaction] model = "pairwise" counts it{grid}; boundary = "free" where the patch is no part of a '
            "larger surface"
        )
    if coefficients is HILLS:
        return 'hills need [interaction] model = "pairwise": without it their forces mean nothing'
    better = foreseen_error(fraction, overlap)
    if coefficients is SUMMITS:
        better += float(summits_error(np.array(fraction), "summits"))
    within = _percent(min(better, 1.0))
    return f'with [interaction] model = "pairwise" by the interaction within about {within}'


def _coefficients(known: dict[str, Floats]) -> Coefficients | None:
    """Return the coefficients of the error by interaction; None for an error by distances."""
    error, fraction = known["interaction_error"].max(), known["largest_contact_fraction"].max()
    kinds = (ASPERITIES, SUMMITS) if known["overlap_fraction"].size else (HILLS,)  # hills have no overlap
    by_fraction = {kind: float(interaction_error(fraction, kind)) for kind in kinds}
    if PLASTIC in known:  # softer contacts have less of it
        kind = [*OF_ORIGIN.values()][int(known["asperity_origin"].max())]
        return kind if 0.0 < error <= by_fraction[kind] * (1.0 + _ROUNDING) else None
    return next((kind for kind, of in by_fraction.items() if math.isclose(error, of, rel_tol=_ROUNDING)), None)


def _interaction(fraction: float, coefficients: Coefficients, share: float = 1.0) -> str:
    """Return in words the typical error by interaction at a contact fraction, and its range; a ``share`` of it."""
    root, most = math.sqrt(fraction), float(interaction_error(np.array(fraction), coefficients))
    low, middle = coefficients.low * root, 0.5 * coefficients.least + coefficients.typical * root
    parts = (share * min(part, 1.0) for part in (low, middle, most))
    low_percent, middle_percent, most_percent = (_percent(part).removesuffix(" %") for part in parts)
    return f"about {middle_percent} % ({low_percent} to {most_percent})"


def _known(values: Any) -> Floats:
    numbers = np.atleast_1d(np.asarray(values, dtype=np.float64)).ravel()
    return numbers[np.isfinite(numbers)]


def _percent(share: float) -> str:
    if 0.0 < share < _TINY:
        return f"below {100.0 * _TINY:g} %"
    return f"{100.0 * share:.2g} %" if share < 0.995 else "100 %"


def _range(shares: Floats) -> str:
    low, high = (_percent(float(share)) for share in (shares.min(), shares.max()))
    return high if low == high else f"{low.removesuffix(' %')} to {high}"
