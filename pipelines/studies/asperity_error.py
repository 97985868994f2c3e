"""One random asperity at a random point of its stable branches: the error of its force, and the bound on it."""

import contextlib
import math
from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from oracles.jkr import ExactContact, ExactPunch
from oracles.multiprecision import Number, mp

import roughmdr as rm
from roughmdr.aggregate import loop, totals
from roughmdr.asperity.contact import FIXED_GRIPS, Contact, prepared
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.kernels.choose import choose
from roughmdr.kernels.interface import Columns
from roughmdr.kernels.profile.layout import COUNT, FOOT, TOP
from roughmdr.loading.staircase import staircase
from roughmdr.shapes import SHAPES, Shape
from studies.comparison import groups_of, of_rows
from studies.stated_error.scenes import Rng, decades
from studies.study import Study, in_two_processes, table, without_limits

NEAREST = 1e-12  # smallest distance to a fold, over its depth
_PRESSED = 1e3  # depths beyond first touch, to which some are pressed first
_MIN_FORCE = 1e-290
_TRIES = 50
ASPERITIES, QUICK = 100_000, 480
_GROUP_SIZE = 100
_WEIGHT = {"tabulated": 0.2}  # share of cases of a shape, else 1: its reference is slow
_COLUMNS = {
    "true_error": ("true error of the force", "1"),
    "stated_error": ("bound on it", "1"),
    "distance": ("distance to the end of the branch", "1"),
}
Group = tuple[str, bool, range]  # some asperities: shape, whether with adhesion, and their numbers


def _length(rng: Rng) -> float:
    return decades(rng, -10.0, 0.0)


def _slope(rng: Rng) -> float:
    return decades(rng, -4.0, 2.0)


def _exponent(rng: Rng) -> float:
    """Return an exponent; half of them are near 1/2, where contacts are most sensitive."""
    return 0.5 + decades(rng, -2.0, 0.0 if rng.random() < 0.5 else 2.0)


def _series(rng: Rng) -> Shape:
    """Return a series whose terms are equal within some decades of one width."""
    width, count = np.float64(decades(rng, -8.0, -1.0)), int(rng.integers(1, 6))
    exponents = sorted({round(_exponent(rng), 6) if rng.random() < 0.7 else _exponent(rng) for _ in range(count)})
    rise = width * _slope(rng)
    return rm.PowerSeries({n: float(rise * decades(rng, -3.0, 3.0) / width**n) for n in exponents})


def _table(rng: Rng) -> Shape:
    """Return a table of powers, some with a flat tip, a wear flat or unevenly spaced points."""
    r = np.concatenate([[0.0], np.cumsum(10.0 ** rng.uniform(-1.5, 0.0, int(rng.integers(3, 12))))])
    f = (r / r[-1]) ** rng.uniform(1.0, 6.0) + (rng.random() < 0.3) * rng.random() * r / r[-1]
    if rng.random() < 0.2:
        f[: int(rng.integers(2, r.size))] = 0.0
    length = _length(rng)
    return rm.Tabulated(r * length / r[-1], f * length * decades(rng, -4.0, 0.0))


def _mdr_table(rng: Rng) -> Shape:
    """Return an MDR table of rises of any size at radii near to each other or far apart."""
    count = int(rng.integers(1, 20))
    a, g = (np.cumsum(10.0 ** rng.uniform(-2.0, 0.0, count)) for _ in range(2))
    return rm.MdrTable(a * _length(rng), g * _length(rng))


def _capped(rng: Rng) -> Shape:
    radius = _length(rng)
    return rm.CappedParaboloid(radius, radius * decades(rng, 0.0, 4.0), _length(rng))


def _plain(shape: type[Shape], rng: Rng) -> Shape:
    """Return a shape of lengths, slopes and exponents of any size."""
    others = {"slope": _slope, "exponent": _exponent}
    return shape(**{name: others.get(name, _length)(rng) for name in shape.parameter_sets[-1]})


DRAW: dict[str, Callable[[Rng], Shape]] = {name: partial(_plain, shape) for name, shape in SHAPES.items()} | {
    "capped_paraboloid": _capped, "power_series": _series, "tabulated": _table, "mdr_table": _mdr_table
}  # fmt: skip


class ForceError(NamedTuple):
    """One asperity on a path of separations, and the error of its force at the last of them, in SI units."""

    shape: Shape
    effective_modulus: float
    work: float
    height: float
    path: list[float]
    error: float  # the true error of the force, of the sum over this asperity alone
    stated: float
    force: float
    distance: float
    """From the indentation to the nearer end of the branch, over the depth of the fold; inf without adhesion."""


class Branch(NamedTuple):
    """A stable branch: t at its foot and its top, and the indentations [m] there."""

    foot: Number
    top: Number
    lowest: Number
    highest: Number


class _Subject:
    """A shape on its half-space, as the kernels have it and exactly."""

    def __init__(self, shape: Shape, effective_modulus: float, work: float) -> None:
        adhesion, (width, rise, numbers) = Adhesion(work), shape.nondimensional()
        kernels = choose(shape.name, adhesion, np.array([numbers]))
        params = prepared(kernels, shape, effective_modulus, adhesion, FIXED_GRIPS)
        if kernels.iterative and params[COUNT] == 0.0:
            raise rm.OutOfRange("no float holds the fold")
        scales = kernels.scales(effective_modulus, work, width, rise, params)
        self.contact = Contact(kernels, shape, effective_modulus, adhesion, params, *scales)
        kind = ExactPunch if isinstance(shape, rm.FlatPunch) else ExactContact
        self.exact = kind(shape, effective_modulus, work)  # type: ignore[arg-type]
        self.branches = self._branches() if work else []

    def _branches(self) -> list[Branch]:
        indentation, params = self.exact.indentation, self.contact.params
        if not self.contact.kernels.iterative:
            return [Branch(self.exact.fold(), mp.inf, indentation(self.exact.fold()), mp.inf)]
        count = int(params[COUNT])
        feet, tops = ([mp.mpf(float(t)) for t in params[start : start + count]] for start in (FOOT, TOP))
        return [Branch(foot, top, indentation(foot), indentation(top) if top < mp.inf else mp.inf)
                for foot, top in zip(feet, tops, strict=True)]  # fmt: skip

    @property
    def fold_depth(self) -> Number:
        """The largest depth [m] of a fold below first touch."""
        return max(-branch.lowest for branch in self.branches)

    def random_indentation(self, rng: Rng) -> float:
        """Return one at 1e-12 to 1e3 depths from the end of a branch; without adhesion at a t of 1e-4 to 1e2."""
        if not self.branches:
            contact = self.contact
            return float(contact.depth[0] * contact.kernels.reduced_control(decades(rng, -4.0, 2.0), contact.params))
        depth, branch = self.fold_depth, self.branches[int(rng.integers(len(self.branches)))]
        distance = depth * decades(rng, math.log10(NEAREST), -3.0 if rng.random() < 0.5 else 3.0)
        if branch.highest < mp.inf and rng.random() < 0.5:
            return float(branch.highest - distance)
        return float(branch.lowest + distance)

    def force_error(self, height: float, path: list[float]) -> ForceError | None:
        """Compare the sum over the asperity with the exact force; None where it detaches, or is too near to that."""
        h, asked = np.array(path), {totals.FORCE, totals.ERROR}
        kernels, shape, modulus, adhesion, _, (depth, _), *_ = self.contact
        columns = Columns(*(np.asarray(part, dtype=np.float64)[None] for part in shape.nondimensional()))
        total, _, _ = loop.sum_over_asperities(
            kernels, np.array([height]), columns, modulus, adhesion, h, staircase(h), asked
        )
        x = [((height - each) + (depth if self.branches else 0.0)) / depth for each in path]
        number = self._branch_at_end(x)
        indentation, distance = mp.mpf(height) - mp.mpf(path[-1]), math.inf
        low, high = mp.mpf(0), mp.mpf(10) ** 400
        if self.branches:
            if number == 0 or not x[-1] > 0.0:
                return None
            branch = self.branches[number - 1]
            low, high = branch.foot, min(branch.top, high)
            distance = float(min(indentation - branch.lowest, branch.highest - indentation) / self.fold_depth)
            if not distance >= NEAREST:
                return None
        begin = self._state_found(x[-1], float(number))
        if not 0.0 <= begin < math.inf:
            return None
        t = self.exact.state(indentation, begin, low, high)
        if t is None:
            raise ArithmeticError(f"no equilibrium of {shape} at {indentation}")
        force = self.exact.force(t)
        if not _MIN_FORCE < abs(force) < 1 / _MIN_FORCE:  # beyond, floats lose digits
            return None
        error, stated = abs(mp.mpf(float(total[totals.FORCE, -1])) - force), float(total[totals.ERROR, -1])
        return ForceError(shape, modulus, adhesion.work, height, path, float(error), stated, float(force), distance)

    def _branch_at_end(self, x: list[float]) -> int:
        """Return the number of the branch at the end of a path of reduced controls, from 1; 0 out of contact."""
        if not self.contact.kernels.branched:
            return 1
        number = 0.0
        for each in x:
            number = self.contact.kernels.branch(max(each, 0.0), number, True, self.contact.params)
        return int(number)

    def _state_found(self, x: float, number: float) -> float:
        """Return the state that the kernels find, where the exact search begins."""
        kernels, params = self.contact.kernels, self.contact.params
        state = kernels.state_on_branch(x, number, params) if kernels.branched else kernels.state(x, params)
        return state if kernels.iterative else self.contact.radius * kernels.radius(state, params)


def random_error(kind: str, adhesive: bool, seed: int) -> ForceError:
    """Return the error of a random asperity, with JKR adhesion or without; skip what floats cannot hold."""
    rng = np.random.default_rng([list(SHAPES).index(kind), adhesive, seed])
    with without_limits(), np.errstate(all="ignore"):
        for _ in range(_TRIES):
            with contextlib.suppress(rm.RoughmdrError):
                if (found := _draw(rng, kind, adhesive)) is not None:
                    return found
    raise ArithmeticError(f"no {kind} of {_TRIES} that floats hold")


def _draw(rng: Rng, kind: str, adhesive: bool) -> ForceError | None:
    shape = DRAW[kind](rng)
    subject = _Subject(shape, decades(rng, 3.0, 13.0), decades(rng, -9.0, 1.0) if adhesive else 0.0)
    indentation = subject.random_indentation(rng)
    if not math.isfinite(indentation) or indentation == 0.0 or (indentation < 0.0 and not adhesive):
        return None
    height = 0.0
    if rng.random() >= 0.5:
        height = float(rng.normal()) * abs(indentation) * decades(rng, 0.0, 3.0)
    before = [height, height - _PRESSED * subject.contact.depth[0]] if rng.random() < 0.3 else [height]
    return subject.force_error(height, [*(before if adhesive else []), height - indentation])


def groups(count: int) -> list[Group]:
    """Return about ``count`` asperities."""
    weights = {kind: _WEIGHT.get(kind, 1.0) for kind in SHAPES}
    found = []
    for kind, weight in weights.items():
        size = round(0.5 * count * weight / sum(weights.values()) + 0.5)
        seeds = [range(start, min(start + _GROUP_SIZE, size)) for start in range(0, size, _GROUP_SIZE)]
        found += [(kind, adhesive, each) for adhesive in (False, True) for each in seeds]
    return found


def errors_of(group: Group) -> list[dict[str, Any]]:
    """Return the numbers of ``_COLUMNS`` of each asperity of a group, with its labels."""
    kind, adhesive, seeds = group
    rows = []
    for seed in seeds:
        one = random_error(kind, adhesive, seed)
        errors = {"true_error": abs(one.error / one.force), "stated_error": abs(one.stated / one.force)}
        labels = {"shape": kind, "adhesion": "JKR" if adhesive else "none", "seed": seed}
        rows.append(labels | errors | {"distance": one.distance})
    return rows


def measure(quick: bool) -> xr.Dataset:
    """Return the errors of all asperities, from two processes."""
    found = in_two_processes(errors_of, groups(QUICK if quick else ASPERITIES))
    return of_rows(_COLUMNS, [row for part in found for row in part], "asperity")


def report(result: xr.Dataset) -> str:
    """Return how many are within the bound, and how near the worst of each shape comes to it."""
    excess, rows = result.true_error / result.stated_error, []
    for labels, own in groups_of(result.assign(excess=excess), "shape", "adhesion"):
        worst = own.isel(asperity=int(np.argmax(own.excess.to_numpy())))
        cells = [f"{float(worst.excess):.2g}", f"{float(worst.distance):.1g}", f"{int(worst.seed)}"]
        quantiles = [f"{value:.1g}" for value in np.quantile(own.stated_error, [0.5, 0.99])]
        rows.append([*labels, f"{own.sizes['asperity']}", *cells, *quantiles])
    head = ["shape", "adhesion", "asperities", "true/stated: largest", "at", "number", "stated: median", "99 %"]
    return f"Outside the bound: {int((excess > 1.0).sum())} of {excess.size} asperities.\n\n{table(head, rows)}"


TITLE = "Single asperities up to their folds: is the bound on the error a bound?"
STUDY = Study("asperity_error", TITLE, measure, {}, report, f"{QUICK} of {ASPERITIES} asperities")
