"""numerical_error against the true error of the force, in random scenes.

The scenes are run, and their forces are computed again at least ten times finer: those of draws asperity by asperity
with 60 digits from the slopes of the profiles, the expected force by quadrature.
"""

from functools import cache
from typing import NamedTuple

import numpy as np
import xarray as xr
from oracles.dugdale import Array
from oracles.multiprecision import mp

import roughmdr as rm
from roughmdr.numerics.arguments import Floats
from roughmdr.scene import Scene, read
from roughmdr.shapes import SHAPES
from studies.comparison import cases_of, of_rows
from studies.stated_error.contacts import ContactPath, contact_path
from studies.stated_error.expected import ORDERS, ExpectedForce
from studies.stated_error.scenes import ESTIMATORS, RandomScene, scene
from studies.study import Study, in_two_processes, table, without_limits

SCENES, QUICK = 200, 60
FINER = 10.0  # how many times more accurate than the stated error a reference is at least
HONEST = 0.99  # the share of scenes whose true error is to be below the stated one
_WORDS = {
    "true_error": ("true error over the largest force", "1"),
    "stated_error": ("numerical_error", "1"),
    "honest": ("1 where the true error is within", "1"),
}


class Judged(NamedTuple):
    """The errors of the force of one scene along its path, over its largest magnitude."""

    true: float
    stated: float
    refused: str = ""  # why the scene was not computed; then there is no number that could be wrong

    @property
    def honest(self) -> bool:
        """Whether the true error is within the stated one."""
        return bool(self.true <= self.stated)


def judge(drawn: RandomScene, disturbance: float = 0.0) -> Judged:
    """Run a scene and compute it again; all forces of the run are off by ``disturbance`` times its stated error."""
    with without_limits():  # steep or not, the numbers are the same
        result = rm.run(drawn.table)
    if (result.status != 0).any():
        return Judged(np.nan, np.nan, str(result.remark.values.ravel()[0]))
    stated, given, separation = float(result.numerical_error.max()), read(drawn.table), result.separation.to_numpy()
    if drawn.estimator == "expected":
        exact: Array = expected_force(given, separation, stated)
    else:
        draws = [force_of_draws(given, each, separation) for each in range(given.batch.realizations)]
        exact = np.mean(draws, axis=0)
    computed = result.force_mean if "force_mean" in result else result.force.isel(realization=0)
    largest = np.abs(exact).max()
    error = np.abs(computed.to_numpy() + disturbance * stated * float(largest) - exact).max()
    return Judged(float(error / largest) if largest else float(error), stated)


def force_of_draws(scene: Scene, realization: int, separation: Floats) -> Array:
    """Return the force [N] at each step, of the asperities of one realisation of a scene without a sweep."""
    source = scene.asperities
    drawn = source.ensemble(scene.seed, realization, stratified=scene.batch.estimator == "stratified")
    columns = {} if drawn.shared_profile is not None else drawn.parameters
    deepest = float(drawn.height.max(initial=-np.inf) - separation.min())

    @cache
    def path_of(*values: float) -> ContactPath:
        shape = source.shared_profile or SHAPES[source.shape_name](**dict(zip(columns, values, strict=True)))
        return contact_path(shape, scene.effective_modulus, scene.adhesion_model, deepest)

    h, total = np.array([mp.mpf(each) for each in separation.tolist()]), np.full(separation.size, mp.mpf(0))
    for z, *values in zip(drawn.height.tolist(), *(column.tolist() for column in columns.values()), strict=True):
        total += path_of(*values).forces((z - h).tolist())
    return total


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
    return as_dataset(drawn, in_two_processes(judge, drawn, chunksize=4))


def as_dataset(drawn: list[RandomScene], judged: list[Judged]) -> xr.Dataset:
    """Return the errors of each scene that was not refused."""
    rows = [
        {"scene": one.number, "estimator": one.estimator, "adhesion": one.adhesion, "shape": one.shape}
        | {"true_error": errors.true, "stated_error": errors.stated, "honest": errors.honest}
        for one, errors in zip(drawn, judged, strict=True)
        if not errors.refused
    ]
    return of_rows(_WORDS, rows, "scene").assign_attrs(refused=len(drawn) - len(rows))


def report(result: xr.Dataset) -> str:
    """Return the share of honest scenes, those that are not, and how pessimistic the bound is."""
    rows = []
    for name in (each for each in ESTIMATORS if each in result.estimator):
        own = cases_of(result, estimator=name)
        true, stated = own.true_error.to_numpy(), own.stated_error.to_numpy()
        worst = float(np.max(true[stated > 0.0] / stated[stated > 0.0], initial=0.0))
        cells = [name, f"{own.sizes['scene']}", f"{int(own.honest.sum())}"]
        for values in (stated, stated[true > 0.0] / true[true > 0.0]):
            cells += [f"{q:.1g}" for q in np.quantile(values, [0.5, 0.95])] if values.size else ["", ""]
        rows.append([*cells, f"{worst:.2g}"])
    head = "estimator, scenes, honest, stated: median, 95 %, stated/true: median, 95 %, true/stated: at most"
    false = [f"- scene {n}: `{scene(n).table}`" for n in result.scene[result.honest == 0].to_numpy().tolist()]
    share = f"{100.0 * float(result.honest.mean()):.1f} % of {result.sizes['scene']} random scenes"
    asked = f"(at least {100 * HONEST:.0f} % are asked for; {result.attrs['refused']} more were refused)"
    parts = [f"The true error is within the stated one in {share} {asked}.", table(head.split(", "), rows)]
    return "\n\n".join([*parts, *(["Not within it:", "\n".join(false)] if false else [])])


STUDY = Study("stated_error", "Is the stated error honest?", measure, {}, report, f"{QUICK} of {SCENES} scenes")
