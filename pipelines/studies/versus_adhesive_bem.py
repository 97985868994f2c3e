"""Adhesive paraboloids in a periodic patch, by models and by boundary elements on two grids, along the same path.

All is in units in which E* is 1, the mean radius R is 1, and 2 pi w R^2/E* = a0^3 is 1: a0 is the contact radius to
which one alone jumps on. Lengths along the plane are in a0, across it in a0^2/R, forces in E* a0^3/R.
"""

import math
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from oracles.adhesive_elements import AdhesiveMap

import roughmdr as rm
from roughmdr.numerics.arguments import Floats
from studies.comparison import INTERACTIONS, PAIRS, cases_of, each_of, in_cases, law_of, panels
from studies.study import Axes, Figure, Study, table
from studies.versus_bem.ensembles import height_map

WORK = 0.5 / math.pi
DETACHED = -(3.0 * 0.25 ** (4.0 / 3.0))
"""The indentation at which one alone lets go under fixed grips, t^4 - t at t^3 = 1/4: a measure of separations."""
MODELS: dict[str, Any] = {name: INTERACTIONS[name] for name in ("independent", "order 1", "order 2")}
"""Interactions by name; images of the patch are felt by pairs only."""
_STD_RADIUS = 0.1
_LEAST_DISTANCE = 0.7  # least distance over the mean spacing
_ABOVE, _BEYOND = 0.55, 0.85  # path: start and end above the top
_SCANNED = 400  # separations in which the last jump-on is found
_COLOURS = {"independent": "0.6", "order 2": "#c8553d"}
_SHOWN = 4.0  # Tabor number of the curves, or that next to it
_QUANTITIES = {
    "force": ("force over E* a0^3/R", "1"),
    "area": ("contact area over a0^2; of boundary elements the mean of those closed and within the range", "1"),
    "count": ("asperities in contact", "1"),
}
_COLUMNS = {
    "asperities": ("asperities in the patch", "1"),
    "spacing": ("mean spacing over a0", "1"),
    "tabor": ("Tabor number of the mean radius", "1"),
}


class Case(NamedTuple):
    """An ensemble, its adhesion and its grid."""

    asperities: int
    spacing: float  # the side of the area for each [a0]
    tabor: float
    points: int  # a side of the grid of boundary elements
    seed: int = 1
    step: float = 0.05  # between separations
    below: float = 0.15  # distance by which it is pressed beyond the last jump-on
    spread: float = 0.15  # standard deviation of the heights

    @property
    def size(self) -> float:
        """The side of the patch."""
        return self.spacing * math.sqrt(self.asperities)

    @property
    def reach(self) -> float:
        """The range of the attraction, w over its strength."""
        tip = rm.Paraboloid(radius=1.0)
        return float(WORK * rm.tabor(tip, effective_modulus=1.0, work=WORK, strength=1.0) / self.tabor)

    @property
    def coarse(self) -> int:
        """A side of the grid that shows the error of the grid."""
        return 2 * self.points // 3

    def generate(self) -> xr.Dataset:
        """Return the ensemble: lognormal radii, normal heights, none too near another; one alone has radius 1."""
        section: dict[str, object] = {
            "source": "random", "count": self.asperities, "patch": self.size, "shape": "paraboloid", "radius": 1.0,
            "height": {"distribution": "normal", "std": self.spread}, "placement": "random",
        }  # fmt: skip
        if self.asperities > 1:
            section["radius"] = {"distribution": "lognormal", "mean": 1.0, "std": _STD_RADIUS}
            section |= {"placement": "hard_core", "min_distance": _LEAST_DISTANCE * self.spacing}
        return rm.generate(section, seed=self.seed)

    def separations(self, ensemble: xr.Dataset) -> Floats:
        """Return the path: until all are in contact to second order, a little beyond, and until all have let go."""
        height = ensemble["height"].to_numpy()
        scanned = np.linspace(height.max(), height.min() - 1.5, _SCANNED)
        count = law(ensemble, scanned, MODELS["order 2"])["count"]
        deepest = float(scanned[np.flatnonzero(count == self.asperities)[0]]) - self.below
        loading = np.arange(height.max() + _ABOVE, deepest - 0.5 * self.step, -self.step)
        unloading = np.arange(loading[-1] + self.step, height.max() + _BEYOND, self.step)
        return np.concatenate([loading, unloading])


CASES = (
    *(Case(1, 8.0, tabor, points) for tabor, points in ((2.0, 192), (3.0, 288), (4.0, 384), (6.0, 576))),
    *(Case(4, 5.0, tabor, points) for tabor, points in ((2.0, 256), (3.0, 384), (4.0, 512), (6.0, 720))),
    *(Case(4, 7.0, tabor, points) for tabor, points in ((2.0, 352), (4.0, 672))),
    Case(9, 5.0, 2.0, 384, 2),
)
QUICK = (Case(1, 8.0, 2.0, 144, step=0.08), Case(4, 5.0, 2.0, 192, step=0.08))
STATED: dict[str, Any] = {
    "independent, JKR": {"adhesion": "jkr"}, "independent, Dugdale": {"adhesion": "dugdale"},
    "pairs, JKR": {"adhesion": "jkr", "interaction": PAIRS[2]},
}  # fmt: skip
"""Models whose stated errors are held against boundary elements (``pipelines/study.py at_pressure``)."""
FLATTER = 1e3  # radii over those of the case: slopes are small, and nothing else changes
PRESSED = (
    Case(4, 7.0, 1.0, 180, 21, below=1.2), Case(1, 12.0, 1.2, 180, below=2.0),
    Case(4, 8.0, 2.0, 402, 22, below=1.2), Case(9, 7.0, 1.5, 396, 23, below=1.0),
    Case(4, 10.0, 2.0, 504, 24, below=1.5), Case(9, 7.0, 2.0, 528, 25, below=1.0),
    Case(4, 6.0, 3.0, 450, 26, below=0.9), Case(16, 7.0, 1.0, 354, 27, below=1.2),
    Case(16, 5.0, 1.0, 252, 51, below=0.3, spread=0.6), Case(16, 5.0, 1.5, 378, 52, below=0.3, spread=0.6),
    Case(9, 6.0, 2.0, 450, 53, below=0.5, spread=0.6), Case(16, 5.0, 2.0, 504, 54, below=0.3, spread=0.6),
)  # fmt: skip
"""Cases for these; others have set the constants."""


def law(ensemble: xr.Dataset, separation: Floats, interaction: Any) -> dict[str, Floats]:
    """Return force, contact area and number of contacts by roughmdr along a path."""
    names = {"force": "force", "area": "contact_area", "count": "contact_count"}
    asked = {"effective_modulus": 1.0, "work": WORK, "adhesion": "jkr", "interaction": interaction}
    found = law_of(ensemble, separation=separation, variables=[*names.values()], **asked)
    return {short: found[name].to_numpy() for short, name in names.items()}


def flat_law(case: Case, ensemble: xr.Dataset, separation: Floats, variables: list[str], **asked: Any) -> xr.Dataset:
    """Return the law of flatter asperities along a path, in eight steps from one separation to the next."""
    flat = ensemble.assign(height=ensemble["height"] / FLATTER, radius=ensemble["radius"] * FLATTER)
    along = np.interp(np.arange(8 * separation.size - 7) / 8, np.arange(separation.size), separation) / FLATTER
    asked = asked | {"work": WORK / FLATTER**2, "range": case.reach / FLATTER, "effective_modulus": 1.0}
    return law_of(flat, separation=along, variables=variables, **asked)


def by_elements(case: Case, ensemble: xr.Dataset, separation: Floats, points: int) -> dict[str, Floats]:
    """Return force, contact area, number of contacts and closed area by boundary elements.

    There is a contact where the gap at a tip is 0, and the closed area is where it is anywhere.
    """
    surface = AdhesiveMap(height_map(ensemble, points), case.size, WORK, case.reach)
    tips = tuple((ensemble[axis].to_numpy() * points / case.size).astype(int) % points for axis in "xy")
    rows = []
    for h in separation.tolist():
        state = surface.move(h)
        area, count = 0.5 * (state.closed + state.attracted), np.count_nonzero(surface.gap[tips] == 0.0)
        rows.append((state.force, area, count, state.closed))
    return dict(zip((*_QUANTITIES, "closed"), np.array(rows, dtype=float).T, strict=True))


def compare(case: Case) -> dict[str, Any]:
    """Return force, area and count by each source along the path of a case."""
    ensemble = case.generate()
    separation = case.separations(ensemble)
    laws = [law(ensemble, separation, interaction) for interaction in MODELS.values()]
    laws += [by_elements(case, ensemble, separation, points) for points in (case.points, case.coarse)]
    return {
        **{name: [each[name] for each in laws] for name in _QUANTITIES},
        **{name: getattr(case, name) for name in _COLUMNS},
        "separation": separation - float(ensemble["height"].max()),
    }


def measure(quick: bool) -> xr.Dataset:
    """Compare all cases, or two of them on coarse grids; NaN beyond the end of a path."""
    compared = [compare(case) for case in (QUICK if quick else CASES)]
    along = {"separation": ("separation from the highest asperity over a0^2/R", "1")}
    return xr.Dataset(
        in_cases(_QUANTITIES, compared, "case", "source", "step") | in_cases(along, compared, "case", "step"),
        {"source": [*MODELS, "elements", "coarse grid"], **in_cases(_COLUMNS, compared, "case")},
    )


class Judged(NamedTuple):
    """Differences of a source from boundary elements."""

    loading: float
    """The largest of the force over the largest tension, at steps where as many are in contact, and not none."""
    unloading: float
    pull_off: float  # relative error of the largest tension on unloading
    on: float
    """Mean lag of the jumps on over the stretch at which one alone lets go; > 0 where it jumps on at a smaller gap."""


def known(case: xr.Dataset) -> tuple[xr.Dataset, Floats, int]:
    """Return a case without what lies beyond the end of its path, the separations, and the step at which it turns."""
    case = case.dropna("step", subset=["separation"])
    separation = case["separation"].to_numpy()
    return case, separation, int(np.argmin(separation))


def judge(case: xr.Dataset, source: str) -> Judged:
    """Judge a source against boundary elements on the fine grid."""
    case, separation, turn = known(case)
    (force, count), (true, true_count) = (
        [case[name].sel(source=each).to_numpy() for name in ("force", "count")] for each in (source, "elements")
    )
    tension = -true[turn:].min()
    alike, contact = count == true_count, (count > 0) | (true_count > 0)
    off = np.where(alike & contact, np.abs(force - true), 0.0) / tension
    middle = 0.5 * (separation[1 : turn + 1] + separation[:turn])
    made, truly_made = (np.repeat(middle, np.maximum(np.diff(each[: turn + 1]), 0).astype(int))
                        for each in (count, true_count))  # fmt: skip
    return Judged(
        loading=float(off[: turn + 1].max()),
        unloading=float(off[turn:].max()),
        pull_off=float(-force[turn:].min() / tension - 1.0),
        on=float(np.mean(truly_made - made)) / -DETACHED if made.size == truly_made.size else np.nan,
    )


def _curves(panel: Axes, case: xr.Dataset, quantity: str, share: float) -> None:
    """Draw a quantity over the separation: loading hollow and thin, unloading full."""
    case, separation, turn = known(case)
    loading, unloading = slice(turn + 1), slice(turn, None)
    drawn = {name: share * case[quantity].sel(source=name).to_numpy() for name in (*_COLOURS, "elements")}
    for name, style in (("independent", "--"), ("order 2", "-")):
        for part, width, label in ((loading, 1.0, None), (unloading, 2.0, name)):
            panel.plot(separation[part], drawn[name][part], style, color=_COLOURS[name], lw=width, label=label)
    for part, fill, label in ((loading, "w", "loading"), (unloading, "k", "unloading")):
        panel.plot(separation[part], drawn["elements"][part], "ko", ms=4, mfc=fill, label=f"boundary elements, {label}")
    panel.set(xlabel="separation from the highest asperity [a0²/R]")


def _by_tabor(panel: Axes, result: xr.Dataset) -> None:
    """Draw the largest error of the force over the Tabor number, by ensemble and model; one in a patch for comparison.

    Its neighbours, the periodic images, are so far away that it shows the range alone.
    """
    numbers, spacings = (result[name].to_numpy().tolist() for name in ("asperities", "spacing"))
    groups = sorted(set(zip(numbers, spacings, strict=True)))
    for (number, spacing), marker in zip(groups, "Dsov", strict=False):
        own = cases_of(result, asperities=number, spacing=spacing)
        for name in ("order 2",) if number == 1 else ("independent", "order 2"):
            errors = [100.0 * max(judge(case, name)[:2]) for case in each_of(own)]
            label = f"{'one' if number == 1 else f'{number:g}'}, {spacing:g} a0 apart: {name}"
            colour, line = ("k", ":") if number == 1 else (_COLOURS[name], "-")
            panel.loglog(own["tabor"], errors, line, marker=marker, color=colour, label=label)
    panel.set(xlabel="Tabor number", ylabel="largest error of the force over pull-off [%]")
    panel.set_xticks([2, 3, 4, 6], ["2", "3", "4", "6"])
    panel.set_xticks([], minor=True)
    panel.set_yticks([1, 2, 5, 10, 20, 50], ["1", "2", "5", "10", "20", "50"])
    panel.set_title("Steps with as many in contact")
    panel.legend(fontsize=8)


def draw(result: xr.Dataset) -> Figure:
    """Draw force and contact area over the separation of one case, and errors over the Tabor number of all."""
    figure, (left, middle, right) = panels(16, 5.2, 3)
    several = result.isel(case=np.flatnonzero(result["asperities"].to_numpy() > 1))
    case = several.isel(case=int(np.argmin(np.abs(several["tabor"].to_numpy() - _SHOWN))))
    number, spacing, tabor = int(case["asperities"]), float(case["spacing"]), float(case["tabor"])
    _curves(left, case, "force", 1.0)
    left.set(ylabel="force [E* a0³/R]", title=f"{number} asperities, {spacing:g} a0 apart, Tabor number {tabor:g}")
    left.legend(fontsize=8, loc="lower right")
    _curves(middle, case, "area", 1.0 / (number * spacing**2))
    middle.set(ylabel="contact area over nominal area", title="Thin lines: loading; thick: unloading")
    _by_tabor(right, result)
    return figure


def report(result: xr.Dataset) -> str:
    """Return errors, and where jumps are, by case and source."""
    rows = []
    for case in each_of(result):
        labels = [f"{float(case[name]):g}" for name in _COLUMNS]
        for source in (*MODELS, "coarse grid"):
            found = [f"{100.0 * each:.2g} %" for each in judge(case, source)]
            rows.append([*labels, source, *found])
    head = ["asperities", "apart [a0]", "Tabor number", "source", "loading", "unloading", "pull-off force", "jumps on"]
    return f"""Errors against boundary elements: of the force over the largest tension, the largest of the steps where
as many asperities are in contact, and of the pull-off force. Lags of jumps, means over the asperities: how much farther
away they jump on by boundary elements, over the stretch at which one alone lets go. One alone has its periodic images
as neighbours. The coarse grid has 2/3 as many points a side:

{table(head, rows)}
"""


STUDY = Study(
    "versus_adhesive_bem", "Adhesive pairs against boundary elements", measure, draw, report,
    f"{len(QUICK)} cases in place of {len(CASES)}, on coarser grids",
)  # fmt: skip
