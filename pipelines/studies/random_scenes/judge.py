"""Judge any scene: it is refused in words, or its numbers are finite and physically right."""

import math
import warnings
from collections.abc import Iterator
from itertools import pairwise
from typing import Any, NamedTuple, TypeAlias

import numpy as np
import xarray as xr
from numpy.typing import NDArray

import roughmdr as rm
from roughmdr import errors
from roughmdr.errors import FailedRuns, LimitWarning, RoughmdrError, Unfinished
from roughmdr.numerics.arguments import Floats
from roughmdr.result.view import ResultView
from roughmdr.scene import Scene, read
from roughmdr.stages.viscoelastic import Viscoelastic
from roughmdr.variables import DONE

COMPUTED, FAILED, REFUSED = OUTCOMES = ("computed", "a run failed", "refused")
ROUNDING = 1e-12  # relative rounding of a sum, to which the kernels are tested
FORCES = ("force", "pressure")
_CONDUCTION = ("conductance_radius", "thermal_conductance", "electrical_conductance")
_CONTACTS = ("contact_count", "contact_area", "contact_radius_sum", "contact_fraction", *_CONDUCTION)

Bools: TypeAlias = NDArray[np.bool_]
Claims: TypeAlias = Iterator[tuple[str, Bools | bool]]
"""Claims about numbers, in words, and where they hold."""


class Defect(AssertionError):  # noqa: N818 - it is what is looked for
    """Something that no scene may lead to."""


class Verdict(NamedTuple):
    """The outcome of a scene."""

    outcome: str
    reason: str = ""  # why it was refused, or a run failed
    comparisons: int = 0  # how many pairs of numbers were compared


class Curves(NamedTuple):
    """The curves of one cell."""

    scene: Scene
    separation: Floats  # [step]
    values: dict[str, Floats]  # [row, step]: each realisation that is done, or mean, least and greatest
    error: Floats  # [row], over the largest force
    realizations: bool  # whether each row is one realisation
    expected: bool  # whether it is the expected curve, whose error is that of an integral

    def tolerance(self, name: str) -> Floats:
        """Return by how much values may be off: [row, 1]."""
        rounding = 0.0 if name in FORCES else ROUNDING
        error = np.maximum(self.error[:, None], rounding) if name in FORCES or self.expected else rounding
        return np.asarray(error * np.abs(self.values[name]).max(axis=1, keepdims=True))

    def given(self, *names: str) -> Iterator[tuple[str, Floats, Floats]]:
        """Yield name, values and tolerance of each of these variables that was asked for."""
        return ((name, self.values[name], self.tolerance(name)) for name in names if name in self.values)


def curves_of(result: xr.Dataset, scene: Scene) -> Iterator[Curves]:
    """Yield the curves of each cell, in the order of the cells."""
    view = ResultView(result)
    path = view.over_steps("separation")
    for index, cell in zip(view.cells, scene.cells, strict=True):

        def values(name: str, index: tuple[int, ...] = index) -> Floats:
            return np.asarray(view.variables[name].values[index])

        expected = (view.method(index) or cell.batch.estimator) == "expected"
        error, done = values("numerical_error"), view.done[index]
        if view.keeps_runs:
            curves, error = {name: values(name)[done] for name in scene.output.variables}, error[done]
        else:
            rows = ("mean", "min", "max") if done else ()
            error, shape = np.repeat(error, len(rows)), (len(rows), path.shape[-1])
            curves = {
                name: np.array([values(f"{name}_{row}") for row in rows]).reshape(shape)
                for name in scene.output.variables
            }
        yield Curves(cell, path[index], curves, error, not expected and view.keeps_runs, expected)


def returns(separation: Floats) -> list[tuple[int, int]]:
    """Return pairs of steps at the same separation between which the flat was lower only.

    Pairs between which it was higher only are swapped.
    """
    last: dict[float, int] = {}
    pairs = []
    for step, h in enumerate(separation.tolist()):
        if h in last:
            between = separation[last[h] : step]
            if (between <= h).all():
                pairs.append((last[h], step))
            elif (between >= h).all():
                pairs.append((step, last[h]))
        last[h] = step
    return pairs


def judge(table: dict[str, Any]) -> Verdict:
    """Run a scene in memory and check its result; raise Defect where that is wrong."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            warnings.simplefilter("ignore", LimitWarning)
            warnings.simplefilter("ignore", FailedRuns)
            scene = read(table)
            result = rm.run(scene, workers=1)
    except Exception as error:
        message = f"{type(error).__name__}: {error}"
        if isinstance(error, RoughmdrError) and not isinstance(error, Unfinished):
            return Verdict(REFUSED, message)
        raise Defect(f"an unhandled {message}") from error
    comparisons = check(result, scene)
    failed = result.status.to_numpy() == 1
    if failed.any():
        return Verdict(FAILED, str(result.remark.to_numpy()[failed][0]), comparisons)
    return Verdict(COMPUTED, comparisons=comparisons)


def check(result: xr.Dataset, scene: Scene) -> int:
    """Check all that must be true of a result, and count the numbers compared; raise Defect where one is wrong."""
    made = 0
    for claim, holds in _claims(result, scene):
        each = np.atleast_1d(holds)
        made += each.size
        if not each.all():
            raise Defect(f"{claim}: not so at {np.argwhere(~each)[0].tolist()}")
    return made


def _claims(result: xr.Dataset, scene: Scene) -> Claims:
    """Claim all that must be true of a result."""
    yield from _claims_on_numbers(result)
    cells = list(curves_of(result, scene))
    for curves in cells:
        yield from _claims_on_each_step(curves)
        if curves.scene.stage(Viscoelastic) is not None:
            yield from _claims_with_relaxation(curves)
        else:
            yield from (_claims_with_adhesion if curves.scene.work > 0.0 else _claims_without_adhesion)(curves)
    if scene.accuracy is None:
        yield from _claims_over_work(scene, cells)
    else:
        missed = result.variables["accuracy_reached"].values > scene.accuracy.relative
        yield "an error that is missed is told of", ~missed | ("was not reached" in str(result.attrs))


def _claims_on_numbers(result: xr.Dataset) -> Claims:
    """Nothing is infinite; a computed value is a number; a failed run has a reason, one of the package's errors."""
    status = result.variables["status"]
    for name, variable in result.variables.items():
        values = variable.values
        if values.dtype.kind != "f":
            continue
        yield f"{name} is not infinite", ~np.isinf(values)
        if "step" in variable.dims and name != "separation" and not str(name).endswith("_sem"):
            failed = (status != DONE).all([dim for dim in status.dims if dim not in variable.dims])
            yield f"{name} is a number", (variable.notnull() | failed).values
    error = result.variables["numerical_error"].values
    yield "an error is a number, and not negative", (error >= 0.0) | (status.values != DONE)
    for remark in result.variables["remark"].values[status.values == 1] if "remark" in result.coords else ():
        found = (getattr(errors, part, None) for part in str(remark).split(": "))
        kind = next((each for each in found if isinstance(each, type)), object)
        yield f"a run fails for a reason, not with {remark}", issubclass(kind, RoughmdrError)


def _claims_on_each_step(curves: Curves) -> Claims:
    """Signs, contacts that are none, ratios to the nominal area, means and areas, at every step of its own."""
    values = curves.values
    for name, each, slack in curves.given(*_CONTACTS):
        yield f"{name} is not negative", each >= -slack * curves.expected
    if curves.realizations and "contact_count" in values:
        count = values["contact_count"]
        yield "contact_count is whole", count == np.round(count)
        attracts_at_a_distance = curves.scene.work > 0.0 and "dugdale" in curves.scene.adhesion_model.candidates
        loads = () if attracts_at_a_distance else (*FORCES, "stiffness", "energy")
        for name, each, _ in curves.given(*_CONTACTS[1:], *loads):
            yield f"no contact, no {name}", each[count == 0.0] == 0.0
    area = curves.scene.asperities.nominal_area
    for ratio, whole in (("pressure", "force"), ("contact_fraction", "contact_area")):
        if ratio in values and whole in values and area:
            with np.errstate(under="ignore"):
                same = np.isclose(values[ratio], values[whole] / area, rtol=ROUNDING, atol=1e-300)
            yield f"{ratio} is {whole} over the nominal area", same
    if not curves.realizations and not curves.expected and len(curves.error):
        for name, (mean, least, greatest), tolerance in curves.given(*values):
            slack = tolerance[1:].max()
            yield f"the mean of {name} is no extreme", (least - slack <= mean) & (mean <= greatest + slack)
    if curves.realizations and {"contact_area", "contact_radius_sum", "contact_count"} <= values.keys():
        one = np.sqrt(values["contact_area"] / math.pi)
        total, count = values["contact_radius_sum"], values["contact_count"]
        inside = (one * (1.0 - ROUNDING) <= total) & (total <= one * np.sqrt(count) * (1.0 + ROUNDING))
        yield "radii and areas go together", inside[values["contact_area"] > 1e-290]


def _claims_without_adhesion(curves: Curves) -> Claims:
    """All grows as the flat comes down, without memory, the force between the lines that the stiffness draws."""
    order = np.argsort(-curves.separation, kind="stable")
    down = -np.diff(curves.separation[order])
    values = {name: each[:, order] for name, each in curves.values.items()}
    for name, each in values.items():
        if name == "dissipated_energy":
            yield "nothing is lost without adhesion", each == 0.0
            continue
        rises, slack = np.diff(each, axis=1), 2.0 * curves.tolerance(name)
        yield f"{name} does not fall as the flat comes down", rises >= -slack
        if not curves.expected:
            yield f"{name} has no memory", rises[:, down == 0.0] == 0.0
        yield f"{name} is not negative", each >= -0.5 * slack
    if {"force", "stiffness"} <= values.keys() and (curves.realizations or curves.expected):
        rises, stiffness = np.diff(values["force"], axis=1), values["stiffness"]
        with np.errstate(over="ignore", under="ignore"):
            least, greatest = stiffness[:, :-1] * down, stiffness[:, 1:] * down
        slack = 2.0 * curves.tolerance("force") + 1e-9 * greatest
        yield "force and stiffness agree", (rises >= least - slack) & (rises <= greatest + slack)
    if {"contact_radius_sum", "stiffness"} <= values.keys():
        exact = 2.0 * curves.scene.effective_modulus * values["contact_radius_sum"]
        slack = np.maximum(2.0 * ROUNDING * exact, curves.expected * 2.0 * curves.tolerance("stiffness"))
        yield "stiffness is 2 E* times the sum of the radii", np.abs(values["stiffness"] - exact) <= slack


def _claims_on_moves(curves: Curves, names: tuple[str, ...], falls: Bools, rises: Bools) -> Claims:
    """Variables do not fall where the flat comes down, nor rise where it goes up: in these masks of all moves."""
    for name, each, tolerance in curves.given(*names):
        change, slack = np.diff(each, axis=1), 2.0 * tolerance
        yield f"{name} does not fall as the flat comes down", change[:, falls] >= -slack
        yield f"{name} does not rise as the flat does", change[:, rises] <= slack


def _claims_on_returns(curves: Curves, names: tuple[str, ...], sign: float) -> Claims:
    """Variables, times a sign, have not become less after the flat was lower than at both of two steps."""
    for before, after in returns(curves.separation):
        for name, each, tolerance in curves.given(*names):
            gain = sign * (each[:, after] - each[:, before])
            yield f"{name} after the flat was lower, against before", gain >= -2.0 * tolerance[:, 0]


def _claims_with_adhesion(curves: Curves) -> Claims:
    """After deeper loading contacts are larger and pull more, and nothing lost comes back."""
    values, move = curves.values, np.diff(curves.separation)
    yield from _claims_on_moves(curves, _CONTACTS, move <= 0.0, move >= 0.0)
    if {"dissipated_energy", "energy", "force"} <= values.keys():
        # A loss is a difference of energies, and no more accurate than they are.
        lost, stored, force = (values[name] for name in ("dissipated_energy", "energy", "force"))
        whole = np.abs(stored).max(axis=1) + np.abs(force).max(axis=1) * np.ptp(curves.separation)
        slack = 2.0 * curves.tolerance("dissipated_energy") + ROUNDING * whole[:, None]
        yield "what is lost is lost", np.diff(lost, axis=1, prepend=0.0) >= -slack
    yield from _claims_on_returns(curves, _CONTACTS, 1.0)
    yield from _claims_on_returns(curves, FORCES, -1.0)


def _claims_with_relaxation(curves: Curves) -> Claims:
    """On unloading contacts are smaller and bear less; nothing pulls."""
    for name, each, tolerance in curves.given(*FORCES):
        yield f"{name} is not negative", each >= -tolerance
    move = np.diff(curves.separation)
    yield from _claims_on_moves(curves, _CONTACTS, move <= 0.0, move >= 0.0)
    yield from _claims_on_moves(curves, FORCES, move < 0.0, move >= 0.0)
    yield from _claims_on_returns(curves, (*_CONTACTS, *FORCES), -1.0)


def _claims_over_work(scene: Scene, cells: list[Curves]) -> Claims:
    """More adhesion: larger contacts, and less force, at every step."""
    axes = [axis.key for axis in scene.sweep.axes]
    if scene.sweep.mode != "product" or "adhesion.work" not in axes:
        return
    axis, shape = axes.index("adhesion.work"), tuple(scene.sweep.sizes.values())
    numbers = np.moveaxis(np.arange(len(cells)).reshape(shape), axis, 0).reshape(shape[axis], -1)
    for row in numbers.T:
        ordered = sorted((cells[number] for number in row), key=lambda curves: curves.scene.work)
        for weak, strong in pairwise(ordered):
            if strong.scene.adhesion_model.model == "auto" or len(weak.error) != len(strong.error):
                continue
            for name, each, tolerance in weak.given(*_CONTACTS, *FORCES):
                gain = (strong.values[name] - each) * (-1.0 if name in FORCES else 1.0)
                yield f"{name} with more work", gain >= -(tolerance + strong.tolerance(name))
