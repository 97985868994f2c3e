"""numerical_error against the true error of the force, in random scenes.

The scenes are run, and their forces are computed again at least ten times finer: those of draws asperity by asperity
with 40 digits from the slopes of the profiles, the expected force by dense quadrature.
"""

import warnings
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from typing import NamedTuple

import numpy as np
import xarray as xr
from oracles.multiprecision import Number, mp
from studies.stated_error.contacts import DIGITS, ContactPath, JkrPath, PunchPath
from studies.stated_error.expected import ORDERS, ExpectedForce
from studies.stated_error.finite_range import CohesivePath, CohesivePunchPath
from studies.stated_error.scenes import RandomScene, scene
from studies.study import named

import roughmdr as rm
from roughmdr.numerics.arguments import Floats
from roughmdr.scene import Scene, read
from roughmdr.shapes import SHAPES, FlatPunch, Shape

SCENES, QUICK = 200, 60
FINER = 10.0
"""How many times more accurate than the stated error a reference is at least."""
_WORKERS = 2


class Judged(NamedTuple):
    """The errors of the force of one scene along its path, over its largest magnitude."""

    true: float
    stated: float
    refused: str = ""
    """Why the scene was not computed; then there is no number that could be wrong."""

    @property
    def honest(self) -> bool:
        """Whether the true error is within the stated one."""
        return bool(self.true <= self.stated)


def judge(drawn: RandomScene, disturbance: float = 0.0) -> Judged:
    """Run a scene and compute it again; all forces of the run are off by ``disturbance`` times its stated error."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rm.LimitWarning)  # steep or not, the numbers are the same
        result = rm.run(drawn.table)
    if (result.status != 0).any():
        return Judged(np.nan, np.nan, str(result.remark.values.ravel()[0]))
    stated = float(result.numerical_error.max())
    exact = reference(drawn, result.separation.to_numpy(), stated)
    computed = result.force_mean if "force_mean" in result else result.force.isel(realization=0)
    largest = max(abs(each) for each in exact)
    disturbed = computed.to_numpy() + disturbance * stated * float(largest)
    error = max(abs(one - other) for one, other in zip(exact, disturbed.tolist(), strict=True))
    return Judged(float(error / largest) if largest else float(error), stated)


def reference(drawn: RandomScene, separation: Floats, stated: float) -> list[Number]:
    """Return the force [N] at each step, of any precision; the mean over all realisations."""
    given = read(drawn.table)
    if drawn.estimator == "expected":
        return list(expected_force(given, separation, stated))
    count = given.batch.realizations
    each = [force_of_draws(given, realization, separation) for realization in range(count)]
    return [sum(parts) / count for parts in zip(*each, strict=True)]


def force_of_draws(scene: Scene, realization: int, separation: Floats) -> list[Number]:
    """Return the force [N] at each step, of the asperities of one realisation of a scene without a sweep."""
    source = scene.asperities
    drawn = source.ensemble(scene.seed, realization, stratified=scene.batch.estimator == "stratified")
    columns = {} if drawn.shared_profile is not None else drawn.parameters
    with mp.workdps(DIGITS):
        path = [mp.mpf(h) for h in separation.tolist()]
        total = [mp.mpf(0)] * len(path)
        contacts: dict[tuple[float, ...], ContactPath] = {}
        deepest = float(drawn.height.max() - separation.min()) if drawn.height.size else 0.0
        for number, z in enumerate(drawn.height.tolist()):
            values = {name: float(column[number]) for name, column in columns.items()}
            key = tuple(values.values())
            if key not in contacts:
                shape = source.shared_profile or SHAPES[source.shape_name](**values)
                contacts[key] = contact_path(shape, scene, deepest)
            forces = contacts[key].forces([mp.mpf(z) - h for h in path])
            total = [one + other for one, other in zip(total, forces, strict=True)]
        return total


def contact_path(shape: Shape, scene: Scene, deepest: float) -> ContactPath:
    """Return the reference of one asperity of a scene, at indentations up to ``deepest`` [m]."""
    adhesion, effective_modulus = scene.adhesion_model, scene.effective_modulus
    if isinstance(shape, FlatPunch):
        if adhesion.cohesive:
            return CohesivePunchPath(shape.radius, effective_modulus, adhesion.work, adhesion.strength)
        return PunchPath(shape.radius, effective_modulus, adhesion.work)
    if adhesion.cohesive:
        return CohesivePath(shape, effective_modulus, adhesion.work, adhesion.strength, deepest)
    return JkrPath(shape, effective_modulus, adhesion.work)


def expected_force(scene: Scene, separation: Floats, stated: float) -> Floats:
    """Return the force [N] at each step, refined until it changes by less than a tenth of the stated error.

    Where several parameters are drawn it must do so twice: between kinks at which no panel ends, two orders may agree
    by chance.
    """
    expected = ExpectedForce(scene, separation)
    force, agreed = expected.force(ORDERS[0]), 0
    for order in ORDERS[1:]:
        before, force = force, expected.force(order)
        near = np.abs(force - before).max() <= stated * np.abs(force).max() / FINER
        agreed = agreed + 1 if near else 0
        if agreed > expected.several:
            return force
    raise ArithmeticError("the reference is not accurate enough")


def measure(quick: bool) -> xr.Dataset:
    """Judge all scenes, on two processes."""
    drawn = [scene(number) for number in range(QUICK if quick else SCENES)]
    with ProcessPoolExecutor(_WORKERS, get_context("spawn")) as pool:
        return as_dataset(drawn, list(pool.map(judge, drawn, chunksize=4)))


def as_dataset(drawn: list[RandomScene], judged: list[Judged]) -> xr.Dataset:
    """Return the errors of each scene that was not refused."""
    kept = [(one, errors) for one, errors in zip(drawn, judged, strict=True) if not errors.refused]
    scenes, errors = [one for one, _ in kept], [each for _, each in kept]
    honest = np.array([each.honest for each in errors], dtype=np.int8)
    return xr.Dataset(
        {
            "true_error": ("scene", [each.true for each in errors], named("true error over the largest force")),
            "stated_error": ("scene", [each.stated for each in errors], named("numerical_error")),
            "honest": ("scene", honest, named("1 where the true error is within")),
        },
        {
            "scene": ("scene", [one.number for one in scenes], named("number of the scene")),
            **{name: ("scene", [getattr(one, name) for one in scenes]) for name in ("estimator", "adhesion", "shape")},
        },
        {"refused": len(drawn) - len(kept)},
    )
