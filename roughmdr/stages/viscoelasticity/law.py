"""The law of viscoelastic asperities without adhesion, from their elastic law; Poisson's ratio is constant in time.

While contacts grow they are those of the elastic law, and the force is F(t) = ∫ phi(t - s) dF_el(h(s)) [1]_. While the
flat rises they are those of an earlier time t1 of loading, and the integral ends there [2]_.

References
----------
.. [1] E. H. Lee, J. R. M. Radok, J. Appl. Mech. 27 (1960) 438.
.. [2] T. C. T. Ting, J. Appl. Mech. 33 (1966) 845.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from roughmdr.aggregate import LoadSeparation
from roughmdr.numerics.arguments import Floats
from roughmdr.stages.viscoelasticity.hereditary import Fading, remembered_force
from roughmdr.stages.viscoelasticity.motion import FlatMotion
from roughmdr.stages.viscoelasticity.relaxation import Relaxation

ElasticLaw = Callable[[Floats, list[str]], LoadSeparation]
"""Returns the elastic law at separations [m], in any order, in these variables."""


class Viscoelasticity(NamedTuple):
    """A body that relaxes, under a flat that moves in time."""

    relaxation: Relaxation
    motion: FlatMotion


@np.errstate(over="ignore", under="ignore")  # a time over a much shorter one: nothing is remembered
def viscoelastic_law(
    elastic: ElasticLaw,
    separation: Floats,
    names: list[str],
    body: Viscoelasticity,
    *,
    clear: float,
    nominal_area: float | None,
) -> LoadSeparation:
    """Return the law along separations [m] that fall, and then rise; OutOfRange where the elastic law raises it.

    ``elastic`` is the law with the instantaneous modulus, ``names`` are of force, pressure, contact_area,
    contact_fraction, contact_count, contact_radius_sum and model_error_curve. At ``clear`` [m] and above nothing
    touches. ``nominal_area`` [m2] is None only where no variable needs it. The model error is that of the elastic law.
    """
    loading, age = body.motion.contacts(separation, body.relaxation, clear)
    law = elastic(loading, list(dict.fromkeys(["force", *(name for name in names if name != "pressure")])))
    force, visits, error = law.variables["force"], law.visits, law.numerical_error

    if force.any():

        def force_at(separation: Floats) -> tuple[Floats, float]:
            nonlocal visits
            found = elastic(separation, ["force"])
            visits += found.visits
            return found.variables["force"], found.numerical_error

        relaxation = body.relaxation
        lengths = body.motion.speed * relaxation.times
        weights = relaxation.shares[:, None] * np.exp(-age / relaxation.times[:, None])
        fading = Fading(lengths, weights, relaxation.long_term, force)
        force, off = remembered_force(force_at, fading, loading, clear)
        error = off / float(np.abs(force).max())
    variables = {"force": force}
    if "pressure" in names:
        assert nominal_area is not None
        variables["pressure"] = force / nominal_area
    return law._replace(variables=law.variables | variables, numerical_error=error, visits=visits).only(names)
