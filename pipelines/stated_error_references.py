"""The force of a scene at least ten times finer than a run computes it: of draws, asperity by asperity; or expected."""

import numpy as np
from oracles.multiprecision import Number, mp
from stated_error_cohesion import Cohesive, CohesivePunch
from stated_error_contacts import DIGITS, Follower, Punch, Touching
from stated_error_expected import ORDERS, Expected

from roughmdr.ensemble import Ensemble
from roughmdr.numerics.arguments import Floats
from roughmdr.scene import Scene
from roughmdr.shapes import SHAPES, FlatPunch, Shape

FINER = 10.0
"""Times the error that is stated: how right a reference is at least."""


def force_of_draws(scene: Scene, realization: int, separation: Floats) -> list[Number]:
    """[N] at each step, of the asperities of one realisation of a scene without a sweep."""
    source = scene.asperities
    drawn = source.ensemble(scene.seed, realization, stratified=scene.batch.estimator == "stratified")
    with mp.workdps(DIGITS):
        path = [mp.mpf(h) for h in separation.tolist()]
        total = [mp.mpf(0)] * len(path)
        found: dict[tuple[float, ...], Follower] = {}
        deepest = float(drawn.height.max() - separation.min()) if drawn.height.size else 0.0
        for number, z in enumerate(drawn.height.tolist()):
            values = {name: float(column[number]) for name, column in _columns(drawn).items()}
            key = tuple(values.values())
            if key not in found:
                shape = source.fixed or SHAPES[source.shape_name](**values)
                found[key] = follower(shape, scene, deepest)
            forces = found[key].forces([mp.mpf(z) - h for h in path])
            total = [one + other for one, other in zip(total, forces, strict=True)]
        return total


def _columns(drawn: Ensemble) -> dict[str, Floats]:
    """The parameters of each asperity, where they are not all the same profile."""
    return {} if drawn.fixed is not None else drawn.parameters


def follower(shape: Shape, scene: Scene, deepest: float) -> Follower:
    """One asperity of a scene, pressed no farther than ``deepest`` [m]."""
    law = scene.adhesion_model
    if isinstance(shape, FlatPunch):
        if law.cohesive:
            return CohesivePunch(shape.radius, scene.effective_modulus, law.work, law.strength)
        return Punch(shape.radius, scene.effective_modulus, law.work)
    if law.cohesive:
        return Cohesive(shape, scene.effective_modulus, law.work, law.strength, deepest)
    return Touching(shape, scene.effective_modulus, law.work)


def expected_force(scene: Scene, separation: Floats, stated: float) -> Floats:
    """[N] at each step: refined until it changes by less than a tenth of the stated error.

    Twice, where several parameters are drawn: between kinks that no panel ends at two orders may agree by chance.
    """
    expected = Expected(scene, separation)
    force, agreed = expected.force(ORDERS[0]), 0
    for order in ORDERS[1:]:
        before, force = force, expected.force(order)
        near = np.abs(force - before).max() <= stated * np.abs(force).max() / FINER
        agreed = agreed + 1 if near else 0
        if agreed > expected.several:
            return force
    raise ArithmeticError("the reference is not right enough")
