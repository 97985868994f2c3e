"""Ensembles of power laws placed over seven axes, and the questions asked of each under each adhesion model.

Answers are right, refused or wrong.
"""

import math
import re
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from oracles.dugdale_power_law import DugdalePowerLaw
from oracles.jkr import JkrPowerLaw
from oracles.multiprecision import Number, mp
from oracles.promises import Judged, Results, judge, judge_dugdale, natural_scales, numbers_at, representable
from scipy.stats import qmc

import roughmdr as rm
from studies.study import without_limits

SEED = 20260
ASPERITIES = 3  # asperities of a case
_WIDTHS = (0.0, -0.5, 0.5)  # logarithms of the widths of the asperities, in spreads [decades]
_MARGIN = 0.04  # part of the cases that lies at each end of an axis
MODELS = ("elastic", "jkr", "dugdale")
OUTCOMES = RIGHT, REFUSED, WRONG = ("right", "refused", "wrong")
CONTROLS = ("indentation", "force", "contact_radius")
_TINY = 1e-300  # replaces no force at all


class Axis(NamedTuple):
    """A quantity between two ends, varied in the logarithm of its distance to ``origin``, or linearly (None)."""

    long_name: str
    label: str
    units: str
    low: float
    high: float
    origin: float | None = 0.0

    def at(self, fraction: float) -> float:
        """Return the value at a fraction of the axis."""
        if self.origin is None:
            return self.low + fraction * (self.high - self.low)
        near, far = self.low - self.origin, self.high - self.origin
        return float(np.clip(self.origin + near * (far / near) ** fraction, self.low, self.high))

    def fraction(self, values: Any) -> Any:
        """Return the fractions of the axis at which ``values`` lie."""
        if self.origin is None:
            return (values - self.low) / (self.high - self.low)
        near, far = self.low - self.origin, self.high - self.origin
        return np.log((values - self.origin) / near) / np.log(far / near)


AXES = {
    "effective_modulus": Axis("effective modulus", "E* [Pa]", "Pa", 1e3, 1e13),
    "width": Axis("width of the asperities", "width [m]", "m", 1e-10, 1.0),
    "work": Axis("work of adhesion", "w [J/m²]", "J m-2", 1e-9, 10.0),
    "exponent": Axis("exponent of the profile", "exponent", "1", 0.51, 200.0, 0.5),
    "tabor": Axis("Tabor number", "Tabor number", "1", 1e-3, 1e3),
    "distance": Axis("distance to the fold over its depth", "distance to fold", "1", 1e-12, 1e3),
    "spread": Axis("decades over which the widths are spread", "spread [decades]", "1", 0.0, 6.0, None),
}
_ASPECT = Axis("rise over width", "aspect", "1", 1e-4, 10.0)


class Case(NamedTuple):
    """An ensemble of power-law asperities, each at a distance from its fold, the first at ``distance``."""

    effective_modulus: float
    width: float
    work: float
    exponent: float
    tabor: float
    distance: float
    spread: float
    aspect: float
    other_distances: tuple[float, ...]

    def shapes(self) -> list[rm.PowerLaw]:
        """Return the asperities."""
        widths = [self.width * 10.0 ** (self.spread * position) for position in _WIDTHS]
        return [rm.PowerLaw(exponent=self.exponent, width=width, rise=self.aspect * width) for width in widths]

    def distances(self) -> tuple[float, ...]:
        """Return the distance of each asperity from its fold, over the depth of the fold."""
        return (self.distance, *self.other_distances)


def design(count: int) -> list[Case]:
    """Return cases that fill the space of all axes evenly, in every leading part of the list too (Sobol's sequence)."""
    fractions = qmc.Sobol(len(AXES) + ASPERITIES, rng=SEED).random(count)
    fractions = np.clip((fractions - _MARGIN) / (1.0 - 2.0 * _MARGIN), 0.0, 1.0)
    axes = [*AXES.values(), _ASPECT, *[AXES["distance"]] * (ASPERITIES - 1)]
    rows = [[axis.at(float(fraction)) for axis, fraction in zip(axes, row, strict=True)] for row in fractions]
    first = len(AXES) + 1
    return [Case._make([*row[:first], tuple(row[first:])]) for row in rows]


class Reference:
    """One asperity without adhesion or with JKR adhesion, with 60 digits."""

    def __init__(self, shape: rm.PowerLaw, effective_modulus: float, work: float) -> None:
        self.jkr, self.width = JkrPowerLaw(shape, effective_modulus, work), shape.nondimensional()[0]

    def depth(self) -> Number:
        """Return how far it is pulled before it detaches [m], 0 without adhesion."""
        return -self.jkr.state(self.jkr.fold("indentation"))["indentation"]

    def value(self, control: str, distance: float) -> Number:
        """Return the control at a distance to the fold; where the state does not touch, the radius at pull-off."""
        jkr, branch = self.jkr, "force" if control == "force" else "indentation"
        if jkr.work:
            value = jkr.state(jkr.fold(branch))[branch] * (1 - mp.mpf(distance))
        else:
            value = jkr.state(mp.mpf(self.width))[branch] * distance
        return jkr.radius(branch, value) if control == "contact_radius" else value

    def numbers(self, control: str, value: Number) -> list[Number]:
        """Return the numbers of the result that floats must hold."""
        a = value if control == "contact_radius" else self.jkr.radius(control, value)
        return [*natural_scales(self.jkr), *numbers_at(self.jkr, a)]

    def judge(self, control: str, got: Results) -> dict[str, Judged]:
        """Return the errors and those allowed."""
        return judge(self.jkr, control, got)

    def contact(self, indentation: Number) -> tuple[Number, Number]:
        """Return contact radius [m] and force [N] in a slow retraction."""
        a = self.jkr.radius("indentation", indentation)
        return a, self.jkr.state(a)["force"]


class DugdaleReference(Reference):
    """One asperity with Dugdale adhesion, with 60 digits."""

    def __init__(self, shape: rm.PowerLaw, effective_modulus: float, work: float, strength: float) -> None:
        super().__init__(shape, effective_modulus, work)
        self.dugdale = DugdalePowerLaw(shape, effective_modulus, work, strength)

    def depth(self) -> Number:
        return -self.dugdale.pull_off("indentation").delta

    def value(self, control: str, distance: float) -> Number:
        branch = "force" if control == "force" else "indentation"
        value = self.dugdale.pull_off(branch).under(branch) * (1 - mp.mpf(distance))
        if control != "contact_radius":
            return value
        return self.dugdale.retracted(branch, value).a or self.dugdale.pull_off("force").a

    def numbers(self, control: str, value: Number) -> list[Number]:
        exact = self.dugdale
        state = exact.at_radius(value) if control == "contact_radius" else exact.retracted(control, value)
        folds = [exact.pull_off(control) for control in ("indentation", "force")]
        radii = [each.c for each in (state, *folds)] + [each.a for each in (state, *folds) if each.a > 0]
        controls = [number for fold in folds for number in (fold.delta, fold.force)]
        return [*radii, *(r * r for r in radii), *controls, state.stiffness]

    def judge(self, control: str, got: Results) -> dict[str, Judged]:
        return judge_dugdale(self.dugdale, control, got)

    def contact(self, indentation: Number) -> tuple[Number, Number]:
        state = self.dugdale.retracted("indentation", indentation)
        return state.a, state.force


class Verdict(NamedTuple):
    """The judgement on one question, with the worst error over what is allowed, and why it was refused or is wrong."""

    outcome: str
    excess: float = 0.0
    reason: str = ""


def on_results(judged: dict[str, Judged]) -> Verdict:
    """Return "right" where no error is above the one that is allowed."""
    if not judged:
        return Verdict(RIGHT)
    name, worst = max(judged.items(), key=lambda item: math.inf if math.isnan(item[1].excess) else item[1].excess)
    if worst.excess <= 1.0:
        return Verdict(RIGHT, worst.excess)
    return Verdict(WRONG, worst.excess, f"{name} is off by {worst.error:.2g}, allowed {worst.allowed:.2g}")


def on_error(error: Exception, numbers: list[Number]) -> Verdict:
    """Return "refused" only where floats do not hold all the numbers of the exact result."""
    if not isinstance(error, rm.RoughmdrError):
        return Verdict(WRONG, reason=f"{type(error).__name__}: {error}")
    if representable(numbers):
        return Verdict(WRONG, reason=f"refused without need: {error}")
    message = re.sub(r" \(.*?\)", "", re.split("[:;]", str(error))[0])
    return Verdict(REFUSED, reason=re.sub(r"-?(\d|inf)\S*", "...", message))


def verdicts(case: Case, model: str) -> list[Verdict]:
    """Judge all questions: each asperity under each control, and their sum along a loading and unloading path."""
    dugdale = model == "dugdale"
    shapes = case.shapes()[: 2 if dugdale else None]  # its reference is slow
    given: dict[str, Any] = {
        "effective_modulus": case.effective_modulus, "work": 0.0 if model == "elastic" else case.work
    }  # fmt: skip
    with without_limits():  # steep slopes have right results too
        if dugdale:
            try:
                given["strength"] = case.tabor / rm.tabor(shapes[0], **given, strength=1.0)
            except Exception as error:
                return [on_error(error, natural_scales(JkrPowerLaw(shapes[0], **given)))]
        references = [(DugdaleReference if dugdale else Reference)(shape, **given) for shape in shapes]
        given |= {"adhesion": "dugdale"} if dugdale else {}
        alone = zip(shapes[: 1 if dugdale else None], references, case.distances(), strict=False)
        found = [_one(*each, control, given) for each in alone for control in CONTROLS]
        depths = [reference.depth() for reference in references]
        if model == "elastic" or representable(depths):
            found.append(_sum(case, references, depths, given))
        return found


def _one(shape: rm.PowerLaw, reference: Reference, distance: float, control: str, given: dict[str, Any]) -> Verdict:
    """Judge one asperity under one control."""
    value = reference.value(control, distance)
    try:
        contact = rm.indent(shape, **given, **{control: float(value)})  # type: ignore[arg-type]
    except Exception as error:
        return on_error(error, reference.numbers(control, value))
    return on_results(reference.judge(control, {str(name): float(contact[name]) for name in contact.variables}))


def _sum(case: Case, references: Sequence[Reference], depths: list[Number], given: dict[str, Any]) -> Verdict:
    """Judge the sum: pressed until all touch, back to the distances to the folds, and until the first detaches.

    The error of the force must be within the stated one, and the number of contacts right.
    """
    shapes, pairs = case.shapes()[: len(references)], zip(references, case.distances(), strict=False)
    targets = [reference.value("indentation", each) for reference, each in pairs]
    height = [float(value) for value in targets]
    ends = sorted(float(z + depth) for z, depth in zip(targets, depths, strict=True))
    low = float(min(z - depth for z, depth in zip(targets, depths, strict=True))) if any(depths) else 0.5 * min(height)
    path = [low, 0.0, 0.5 * (ends[0] + ends[1])]
    pressed = [[mp.mpf(z) - mp.mpf(h) for z in height] for h in path]
    columns = {name: [shape.parameters[name] for shape in shapes] for name in shapes[0].parameters}
    data = {name: ("asperity", column) for name, column in {"height": height, **columns}.items()}
    asperities = xr.Dataset(data, attrs={"shape": shapes[0].name})
    try:
        curve = rm.load_separation(asperities, separation=path, variables=["force", "contact_count"], **given)
    except Exception as error:
        # The bound on the error combines the largest of all natural scales and distances.
        farthest = (max(height) - low) / min(depths) if any(depths) else 0
        indentations = zip(references, (depth * farthest for depth in depths), *pressed[:2], strict=True)
        return on_error(error, [number for reference, *deltas in indentations for delta in deltas if delta
                                for number in reference.numbers("indentation", delta)])  # fmt: skip
    contacts = [
        [reference.contact(delta) for reference, delta, depth in zip(references, step, depths, strict=True)
         if delta > -depth]
        for step in pressed
    ]  # fmt: skip
    count = [sum(a > 0 for a, _ in step) for step in contacts]
    if curve.contact_count.to_numpy().tolist() != count:
        return Verdict(WRONG, reason=f"{curve.contact_count.to_numpy().tolist()} contacts, not {count}")
    force = [mp.fsum(each for _, each in step) for step in contacts]
    largest = max(*map(abs, force), mp.mpf(_TINY))
    worst = max(abs(true - mp.mpf(got)) for true, got in zip(force, curve.force.to_numpy().tolist(), strict=True))
    return on_results({"force of all": Judged(float(worst / largest), float(curve.numerical_error))})
