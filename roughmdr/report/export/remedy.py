"""Advice on what to compute where a law is not known well enough between its steps.

A smooth law bends between them, by less the more there are. Single contacts of a sampled law jump, which more steps do
not make smaller: the expected law has no such jumps, and a mean over more realisations has smaller ones. With as many
times the steps as realisations each step has as many jumps as before, each smaller by that factor.
"""

import math

from roughmdr.errors import RoughmdrError
from roughmdr.report.export.law import Law, Quantity
from roughmdr.scene import Scene, read
from roughmdr.schema.toml_text import parse_toml

_MARGIN = 2.0
"""Factor on the errors that are to be allowed."""
_FOR_JUMPS = 0.75
"""Largest share of an allowed error that jumps may take; the rest is for the bend."""
_ORDER, _ORDER_OVER_PRESSURE = 1.5, 1.25
"""Powers of the number of steps by which the error of a smooth law falls: 2, but less before they resolve it, and where
a pressure turns as contacts pull off."""
_ORDER_OF_CONTACTS = 0.75
"""Power for the contacts of one surface, whose force, area and radius begin with powers from 3/2 to 1/2 of a depth."""


def remedy(law: Law, quantity: Quantity, bent: float, jumps: float) -> str:
    """Return what would reduce errors between steps, given over those allowed, to 1."""
    scene, order = _scene(law), _ORDER_OVER_PRESSURE if quantity.over_pressure else _ORDER
    bent, jumps = _MARGIN * bent, _MARGIN * jumps
    together = scene is not None and _jumps_as_a_whole(scene)
    if law.realizations == 0 and not together:
        return f"compute about {_steps(law, (bent + jumps) ** (1.0 / order))} steps"
    if scene and not (together or scene.reason_against("expected")):
        steps = _steps(law, bent ** (1.0 / order))
        return (
            f'take the expected law, which has no such jumps, with about {steps} steps (batch.estimator = "expected")'
        )
    share = min(jumps, _FOR_JUMPS)
    for_bend, more = (bent / (1.0 - share)) ** (1.0 / order), jumps / _FOR_JUMPS
    if more <= 1.0:
        return f"compute about {_steps(law, for_bend)} steps"
    if scene and scene.asperities.is_random and not together:
        runs = math.ceil(law.realizations * more)
        return f"compute about {_steps(law, max(for_bend, more))} steps and {runs} realisations"
    if scene and scene.work == 0.0:
        return f"compute about {_steps(law, max(for_bend, more ** (1.0 / _ORDER_OF_CONTACTS)))} steps"
    smaller = (
        "give the heights a spread, for those of one height jump together"
        if together
        else "take a larger surface, whose contacts jump by less, or random asperities, whose expected law has no jumps"
    )
    return f"{smaller}: more steps do not help"


def _jumps_as_a_whole(scene: Scene) -> bool:
    """Return whether asperities of one height jump together within the law, after those of another population."""
    source = scene.asperities
    return source.equal_heights and len(source.node_axes) > 1 and scene.work > 0.0


def _steps(law: Law, more: float) -> int:
    return math.ceil(law.separation.size * max(more, 1.0))


def _scene(law: Law) -> Scene | None:
    """Return the scene of a law; None where its map is no longer there."""
    try:
        return read(parse_toml(law.scene))
    except RoughmdrError:
        return None
