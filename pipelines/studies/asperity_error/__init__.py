"""One random asperity at a random point of its stable branches: the error of its force, and the bound on it."""

import contextlib
import math
from typing import NamedTuple

import numpy as np
import xarray as xr
from oracles.exact_contact import ExactContact, ExactPunch
from oracles.multiprecision import Number, mp

import roughmdr as rm
from roughmdr.aggregate import loop, totals
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.kernels.choose import choose
from roughmdr.kernels.interface import Columns
from roughmdr.kernels.profile.layout import COUNT, FOOT, TOP
from roughmdr.loading.staircase import staircase
from roughmdr.shapes import SHAPES, Shape
from studies.asperity_error.asperities import DRAW, Rng, power_of_ten
from studies.study import Study, in_two_processes, named, table, without_limits

NEAREST = 1e-12
"""Smallest distance to a fold, over its depth."""
_PRESSED = 1e3  # depths beyond first touch, to which some are pressed first
_MIN_FORCE = 1e-290
_TRIES = 50
ASPERITIES, QUICK = 100_000, 480
_GROUP_SIZE = 100
_WEIGHT = {"tabulated": 0.2}  # share of cases of a shape, else 1: its reference is slow
_MODELS = ("none", "JKR")
COLUMNS = {
    "shape": {"long_name": "shape of the asperity"},
    "adhesive": named("with JKR adhesion"),
    "seed": named("number of the asperity"),
    "true_error": named("true error of the force"),
    "stated_error": named("bound on it"),
    "distance": named("distance to the end of the branch"),
}
Group = tuple[str, bool, range]
"""Some asperities: shape, whether with adhesion, and their numbers."""


class ForceError(NamedTuple):
    """One asperity on a path of separations, and the error of its force at the last of them, in SI units."""

    shape: Shape
    effective_modulus: float
    work: float
    height: float
    path: list[float]
    error: float
    """The true error of the force, of the sum over this asperity alone."""
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
        width, rise, params = shape.nondimensional()
        self.shape, self.effective_modulus, self.adhesion = shape, effective_modulus, Adhesion(work)
        self.columns = Columns(np.array([width]), np.array([rise]), np.asarray(params, dtype=np.float64)[None])
        self.kernels = choose(shape.name, self.adhesion, self.columns.params)
        material = self.kernels.material(effective_modulus, self.adhesion)
        prepared = self.kernels.prepare(material, self.columns, 0, 1, 0.0, math.inf)
        self.params = self.kernels.params_of(prepared, 0)
        self.solvable = not (self.kernels.iterative and self.params[COUNT] == 0.0)
        if self.solvable:
            (self.depth, _), self.radius, *_ = self.kernels.scales(effective_modulus, work, width, rise, self.params)
            kind = ExactPunch if isinstance(shape, rm.FlatPunch) else ExactContact
            self.exact = kind(shape, effective_modulus, work)  # type: ignore[arg-type]
            self.branches = self._branches() if work else []

    def _branches(self) -> list[Branch]:
        indentation = self.exact.indentation
        if not self.kernels.iterative:
            return [Branch(self.exact.fold(), mp.inf, indentation(self.exact.fold()), mp.inf)]
        count = int(self.params[COUNT])
        feet, tops = ([mp.mpf(float(t)) for t in self.params[start : start + count]] for start in (FOOT, TOP))
        return [Branch(foot, top, indentation(foot), indentation(top) if top < mp.inf else mp.inf)
                for foot, top in zip(feet, tops, strict=True)]  # fmt: skip

    @property
    def fold_depth(self) -> Number:
        """The largest depth [m] of a fold below first touch."""
        return max(-branch.lowest for branch in self.branches)

    def random_indentation(self, rng: Rng) -> float:
        """Return one at 1e-12 to 1e3 depths from the end of a branch; without adhesion at a t of 1e-4 to 1e2."""
        if not self.branches:
            return float(self.depth * self.kernels.reduced_control(power_of_ten(rng, -4.0, 2.0), self.params))
        depth, branch = self.fold_depth, self.branches[int(rng.integers(len(self.branches)))]
        distance = depth * power_of_ten(rng, math.log10(NEAREST), -3.0 if rng.random() < 0.5 else 3.0)
        if branch.highest < mp.inf and rng.random() < 0.5:
            return float(branch.highest - distance)
        return float(branch.lowest + distance)

    def force_error(self, height: float, path: list[float]) -> ForceError | None:
        """Compare the sum over the asperity with the exact force; None where it detaches, or is too near to that."""
        h, asked = np.array(path), {totals.FORCE, totals.ERROR}
        modulus = self.effective_modulus
        total, _, _ = loop.sum_over_asperities(
            self.kernels, np.array([height]), self.columns, modulus, self.adhesion, h, staircase(h), asked
        )
        offset = self.depth if self.branches else 0.0
        x = [((height - each) + offset) / self.depth for each in path]
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
            raise ArithmeticError(f"no equilibrium of {self.shape} at {indentation}")
        force = self.exact.force(t)
        if not _MIN_FORCE < abs(force) < 1 / _MIN_FORCE:  # beyond, floats lose digits
            return None
        error, stated = abs(mp.mpf(float(total[totals.FORCE, -1])) - force), float(total[totals.ERROR, -1])
        asperity = self.shape, self.effective_modulus, self.adhesion.work, height, path
        return ForceError(*asperity, float(error), stated, float(force), distance)

    def _branch_at_end(self, x: list[float]) -> int:
        """Return the number of the branch at the end of a path of reduced controls, from 1; 0 out of contact."""
        if not self.kernels.branched:
            return 1
        number = 0.0
        for each in x:
            number = self.kernels.branch(max(each, 0.0), number, True, self.params)
        return int(number)

    def _state_found(self, x: float, number: float) -> float:
        """Return the state that the kernels find, where the exact search begins."""
        kernels, params = self.kernels, self.params
        state = kernels.state_on_branch(x, number, params) if kernels.branched else kernels.state(x, params)
        return state if kernels.iterative else self.radius * kernels.radius(state, params)


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
    subject = _Subject(shape, power_of_ten(rng, 3.0, 13.0), power_of_ten(rng, -9.0, 1.0) if adhesive else 0.0)
    if not subject.solvable:
        return None
    indentation = subject.random_indentation(rng)
    if not math.isfinite(indentation) or indentation == 0.0 or (indentation < 0.0 and not adhesive):
        return None
    height = 0.0
    if rng.random() >= 0.5:
        height = float(rng.normal()) * abs(indentation) * power_of_ten(rng, 0.0, 3.0)
    before = [height, height - _PRESSED * subject.depth] if rng.random() < 0.3 else [height]
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


def rows_of(group: Group) -> list[tuple[str, int, int, float, float, float]]:
    """Return a row of ``COLUMNS`` for each asperity of a group."""
    kind, adhesive, seeds = group
    rows = []
    for seed in seeds:
        one = random_error(kind, adhesive, seed)
        relative = abs(one.error / one.force), abs(one.stated / one.force)
        rows.append((kind, int(adhesive), seed, *relative, one.distance))
    return rows


def measure(quick: bool) -> xr.Dataset:
    """Return the errors of all asperities, from two processes."""
    rows = [row for part in in_two_processes(rows_of, groups(QUICK if quick else ASPERITIES)) for row in part]
    columns = zip(COLUMNS.items(), zip(*rows, strict=True), strict=True)
    return xr.Dataset({name: ("asperity", np.array(values), attributes) for (name, attributes), values in columns})


def report(result: xr.Dataset) -> str:
    """Return how many are within the bound, and how near the worst of each shape comes to it."""
    excess, stated = (result.true_error / result.stated_error).to_numpy(), result.stated_error.to_numpy()
    rows = []
    for kind in SHAPES:
        for adhesive, model in enumerate(_MODELS):
            chosen = np.flatnonzero((result["shape"] == kind) & (result.adhesive == adhesive))
            worst = chosen[np.argmax(excess[chosen])]
            cells = [f"{excess[worst]:.2g}", f"{float(result.distance[worst]):.1g}", f"{int(result.seed[worst])}"]
            quantiles = [f"{value:.1g}" for value in np.quantile(stated[chosen], [0.5, 0.99])]
            rows.append([kind, model, f"{chosen.size}", *cells, *quantiles])
    head = ["shape", "adhesion", "asperities", "true/stated: largest", "at", "number", "stated: median", "99 %"]
    return f"Outside the bound: {int((excess > 1.0).sum())} of {excess.size} asperities.\n\n{table(head, rows)}"


TITLE = "Single asperities up to their folds: is the bound on the error a bound?"
STUDY = Study("asperity_error", TITLE, measure, {}, report, f"{QUICK} of {ASPERITIES} asperities")
