"""Make the reference tables of adhesion of finite range (Dugdale): 25 right digits or more, from the profile's slope.

    python data_gen/dugdale_references.py -o tests/data

``maugis.json`` holds Maugis's sphere, f = r^2/(2 R), in his units (K = 4 E*/3 = 1, pi w = 1, R = 1), by his equations
(J. Colloid Interface Sci. 150 (1992) 243) and by the integrals, which agree. ``dugdale_SHAPE.json`` holds the other
shapes. A row is a state of equilibrium; "answers" names the controls under which a slow retraction comes by it, each
with the state's distance to the fold of its branch, over that of the pull-off to 0.
"""

import sys
from pathlib import Path
from typing import Any, NamedTuple

import click
import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "pipelines"))
from oracles.dugdale import FIELDS, Cohesion, Punch, State
from oracles.dugdale_curve import CONTROLS, WORKING, Curve, Place
from oracles.multiprecision import Number, bracket, digits, mp, root
from oracles.profiles import Parameters, Profile, profile_of
from references import OUTPUT, head, write, written

MAUGIS_WRITTEN = 30
SPRINGS_DIGITS = 30
WRITTEN = 25
LAMBDAS = (1e-3, 0.01, 0.03, 0.1, 0.3, 0.6, 0.9, 0.93, 0.95, 1.0, 1.2, 2.0, 3.0, 5.0, 10.0, 30.0, 100.0, 1e3)
RADII = (0.01, 0.1, 0.3, 0.6, 1.0, 1.5, 3.0, 10.0)
LIFTED = (0.4, 0.75, 0.95)  # cohesive radii with a = 0, over that at which a begins to grow
ENERGIES = {"tabulated": 1}  # how many states of a case have their energy stated; else 2
TINY, SLOPPY, STEP = mp.mpf(10) ** -28, mp.mpf(10) ** -20, mp.mpf(10) ** -14
_UNEVEN = (0.0, 0.11, 0.2, 0.37, 0.45, 0.7, 0.81, 1.0, 1.3, 1.45, 1.8, 2.4)
_CONICAL = tuple(x * x if x < 0.5 else x - 0.25 for x in _UNEVEN)
_FLAT = (0.0, 0.3, 0.62, 1.0, 1.2, 1.5, 1.9, 2.3, 3.0)
_EDGE = tuple(0.5 * max(x - 1.0, 0.0) ** 2 for x in _FLAT)


def few(number: float) -> float:
    """Return ``number`` to four digits."""
    return float(f"{number:.4g}")


def stretched(width: float, rise: float, r: tuple[float, ...], f: tuple[float, ...]) -> Parameters:
    """Return the parameters of a table, stretched."""
    return {"r": [few(width * x) for x in r], "f": [few(rise * y) for y in f]}


class Case(NamedTuple):
    """One asperity and the Tabor numbers that it is wanted at.

    Radii are asked for up to ``most`` sizes, and folds are sought up to ``reach`` sizes.
    """

    shape: str
    parameters: Parameters
    effective_modulus: float
    work: float
    tabors: tuple[float, ...]
    most: float = 20.0
    reach: float = 100.0

    @property
    def profile(self) -> Profile:
        """Return the slope of the profile."""
        return profile_of(self.shape, self.parameters)

    def size(self) -> float:
        """Return the contact radius [m] of JKR's pull-off under fixed grips, roughly."""
        if self.shape == "flat_punch":
            return float(self.parameters["radius"])
        profile = self.profile
        least = max(float(profile.flat), 1e-12)
        a = np.geomspace(least, 1e-1 if profile.end is None else 0.5 * float(profile.end), 4000)
        g = Cohesion(profile, self.effective_modulus, self.work, 1.0, 0).integrals(a, a, 1.5 * a).g
        return float(a[np.argmin(g - np.sqrt(2.0 * np.pi * a * self.work / self.effective_modulus))])

    def strengths(self) -> list[float]:
        """Return the strengths [Pa] of the Tabor numbers."""
        stretch = float(np.sqrt(2.0 * np.pi * self.size() * self.work / self.effective_modulus))
        return [few(tabor * float(mp.pi) ** (2 / 3) * self.work / stretch) for tabor in self.tabors]


FOUR, THREE = (0.03, 0.3, 3.0, 30.0), (0.1, 1.0, 8.0)

CASES = [
    Case("paraboloid", {"radius": 3e-8}, 8e10, 0.6, (0.05, 0.5, 5.0)),
    Case("paraboloid", {"radius": 0.02}, 5e5, 0.05, THREE),
    Case("cone", {"slope": 0.2}, 3e6, 0.05, FOUR),
    Case("power_law", {"exponent": 0.7, "width": 2e-6, "rise": 3e-8}, 2e8, 0.08, THREE, 300.0, 1e4),
    Case("power_law", {"exponent": 1.5, "width": 4e-9, "rise": 1e-9}, 8e10, 1.2, THREE),
    Case("power_law", {"exponent": 3.2, "width": 3e-5, "rise": 2e-5}, 1e6, 0.03, FOUR),
    Case("power_law", {"exponent": 8.0, "width": 1e-3, "rise": 3e-4}, 5e9, 0.2, THREE, 3.0, 5.0),
    Case("flat_punch", {"radius": 2.5e-7}, 7e10, 0.8, FOUR),
    Case("flat_punch", {"radius": 4e-4}, 2e6, 0.03, (0.8, 1.3)),
    Case("sphere", {"radius": 3.5e-5}, 2e6, 0.04, FOUR, 6.0, 10.0),
    Case("truncated_cone", {"slope": 0.3, "flat_radius": 2e-7}, 1e7, 0.1, FOUR),
    Case("truncated_cone", {"slope": 0.12, "flat_radius": 2e-7}, 1e7, 0.1, THREE),
    Case("truncated_paraboloid", {"radius": 5e-5, "flat_radius": 3e-6}, 4e6, 0.05, FOUR),
    Case("rounded_cone", {"slope": 0.25, "blend_radius": 4e-8}, 5e9, 0.5, THREE),
    Case("rounded_cone", {"slope": 0.25, "blend_radius": 4e-8}, 1e8, 0.5, FOUR),
    Case("capped_paraboloid", {"radius": 1e-6, "cap_radius": 2e-5, "blend_radius": 2e-7}, 1e9, 0.2, FOUR),
    Case("capped_paraboloid", {"radius": 1e-6, "cap_radius": 2e-6, "blend_radius": 2e-7}, 5e7, 0.2, THREE),
    Case("capped_paraboloid", {"radius": 1.331e-5, "cap_radius": 1.725e-5, "blend_radius": 2e-7}, 1e9, 0.2, (7.9,)),
    Case("rounded_punch", {"flat_radius": 1e-4, "edge_radius": 2e-4}, 1e6, 0.03, FOUR),
    Case("rounded_punch", {"flat_radius": 1e-5, "edge_radius": 1e-7}, 1e9, 0.05, (1.2, 5.5, 25.0), 2.0, 4.0),
    Case("rounded_punch", {"flat_radius": 3e-9, "edge_radius": 6e-12}, 2e11, 1.5, (4.0, 60.0), 2.0, 4.0),
    Case("power_series", {"terms": {"2.0": 2e5, "4.0": 1e17}}, 2e9, 0.05, FOUR),
    Case("power_series", {"terms": {"1.0": 0.05, "2.0": 5e4}}, 4e7, 0.06, THREE),
    Case("tabulated", stretched(3e-6, 4e-7, _UNEVEN, _CONICAL), 1e7, 0.04, (0.1, 2.0), 4.0),
    Case("tabulated", stretched(5e-8, 1e-8, _FLAT, _EDGE), 1e9, 0.5, THREE, 4.0),
]


def agree(one: Number, other: Number, relative: Number) -> None:
    """Raise ArithmeticError unless two numbers are the same to almost all digits."""
    if abs(one - other) > relative * max(abs(one), abs(other)):
        raise ArithmeticError(f"{mp.nstr(one, 35)} is not {mp.nstr(other, 35)}")


def maugis_equations(lam: Number, A: Number) -> tuple[Number, Number, Number]:
    """Return c/a, delta and N of Maugis's sphere by his own equations (1992, eq. 6.16 to 6.18 in his units)."""

    def left(y: Number) -> Number:
        s = mp.exp(y)  # sqrt(m^2 - 1)
        angle, m = mp.atan(s), mp.sqrt(1 + s * s)
        near = lam * A * A / 2 * (s + (s * s - 1) * angle)
        return mp.log(near + 4 * lam * lam * A / 3 * (s * angle - s * s / (m + 1)))

    s = mp.exp(root(left, *bracket(left)))
    angle, m = mp.atan(s), mp.sqrt(1 + s * s)
    return m, A * A - 4 * lam * A * s / 3, A**3 - lam * A * A * (s + m * m * angle)


def row(state: State, answers: dict[str, Number], count: int) -> dict[str, Any]:
    """Return a state as a row of a table."""
    line: dict[str, Any] = numbers_of(state, count)
    if mp.mpf(float(state.a)) == state.a:
        line["contact_radius"] = float(state.a)
    line["stiffness"] = digits(state.stiffness, count)
    return {**line, "answers": {control: float(mp.nstr(X, 3)) for control, X in answers.items()}}


def numbers_of(state: State, count: int) -> dict[str, str]:
    """Return radii, indentation and force by their names."""
    return written({name: getattr(state, field) for name, field in FIELDS.items()}, count)


def ends(curve: Curve | Punch, count: int) -> dict[str, dict[str, str]]:
    """Return the two pull-offs."""
    return {control: numbers_of(curve.pull_off(control), count) for control in CONTROLS}


def maugis(lam: float) -> dict[str, Any]:
    """Return the entry of one of Maugis's lambda."""
    with mp.workdps(WORKING):
        profile = profile_of("paraboloid", {"radius": 1.0})
        curve = Curve(profile, mp.mpf(3) / 4, 1 / mp.pi, mp.mpf(lam) / 2, 1.0, 100.0)
        rows = []
        for A in RADII:
            state = curve.state(Place(A, False))
            m, delta, N = maugis_equations(mp.mpf(lam), mp.mpf(A))
            agree(state.c, m * A, TINY)
            agree(state.delta, delta, TINY)
            agree(state.force, N, TINY)
            (_, up, N_up), (_, down, N_down) = (maugis_equations(mp.mpf(lam), A + A * h) for h in (STEP, -STEP))
            agree(state.stiffness, (N_up - N_down) / (up - down), SLOPPY)
            rows.append(row(state, curve.answers(state), MAUGIS_WRITTEN))
        for part in LIFTED:
            state = curve.state(Place(float(mp.nstr(part * curve.touch, 6)), True))
            rows.append(row(state, curve.answers(state), MAUGIS_WRITTEN))
        return {"lambda": lam, "pull_off": ends(curve, MAUGIS_WRITTEN), "rows": rows}


def table(case: Case, strength: float) -> dict[str, Any]:
    """Return the entry of one asperity."""
    with mp.workdps(WORKING):
        given = case.effective_modulus, case.work, strength
        entry = head(case.shape, case.parameters, modulus=given[0], work=given[1], strength=given[2])
        if case.shape == "flat_punch":
            punch = Punch(case.parameters["radius"], *given)
            return entry | {"pull_off": ends(punch, WRITTEN), "rows": punch_rows(punch)}
        size = case.size()
        curve = Curve(case.profile, *given, size, size * case.reach)
        rows, stated = [], 0
        for a in radii(case, size):
            state = curve.state(Place(a, False))
            answers = curve.answers(state)
            if a < case.profile.flat and not answers:
                continue
            rows.append(row(state, answers, WRITTEN))
            if "displacement" in answers and a > 0.5 * size and stated < ENERGIES.get(case.shape, 2):
                stated += 1
                rows[-1]["energy"] = digits(energy(curve.exact, state), WRITTEN)
        for part in LIFTED:
            state = curve.state(Place(few(float(part * curve.touch)), True))
            if answers := curve.answers(state):
                rows.append(row(state, answers, WRITTEN))
        return {**entry, "pull_off": ends(curve, WRITTEN), "rows": rows}


def radii(case: Case, size: float) -> list[float]:
    """Return contact radii [m] from well below the sizes of interest to well above."""
    found = {few(size * part) for part in (0.02, 0.3, 0.7, 0.95, 1.3, 3.0, case.most)}
    kinks = [float(b) for b in case.profile.kinks]
    found |= {few(b * part) for b in {min(kinks, default=0.0), max(kinks, default=0.0)} for part in (0.5, 1.01, 1.5)}
    return sorted(found - {0.0})


def energy(cohesion: Cohesion, state: State) -> Number:
    """Return the energy U [J] of the springs, with g by quadrature, once their force and the gap at c are the state's.

    Their lengths are u1 = delta - g(x) for x < a and -beta sqrt(c^2 - x^2) for a < x < c, and
    U = E* ∫_0^c u1^2 dx - w pi a^2 - ∫_a^c (w - sigma0 gap(r)) 2 pi r dr, of which the last, by exchange of the order,
    is pi w (c^2 - a^2) - 4 sigma0 ∫_a^c [g(x) - delta + u1(x)] sqrt(c^2 - x^2) dx.
    """
    a, c, delta, beta = state.a, state.c, state.delta, cohesion.beta
    straight, weighted, squared, pull = mp.mpf(0), mp.mpf(0), mp.mpf(0), mp.mpf(0)
    for x, dx in cohesion.profile.nodes(mp.mpf(0), a, SPRINGS_DIGITS):
        u = delta - cohesion.profile.mdr(x)[0]
        straight += dx * u
        weighted += dx * u / mp.sqrt((c - x) * (c + x))
        squared += dx * u * u
    for x, dx in cohesion.profile.nodes(a, c, SPRINGS_DIGITS):
        height = mp.sqrt((c - x) * (c + x))
        u = -beta * height
        straight += dx * u
        weighted -= dx * beta
        squared += dx * u * u
        pull += dx * (cohesion.profile.mdr(x)[0] - delta + u) * height
    agree(2 * cohesion.effective_modulus * straight, state.force, SLOPPY)
    agree(cohesion.height(c) - delta + 2 / mp.pi * weighted, cohesion.range, SLOPPY)
    return cohesion.effective_modulus * squared - mp.pi * cohesion.work * c * c + 4 * cohesion.strength * pull


def punch_rows(punch: Punch) -> list[dict[str, Any]]:
    """Return the states of a flat punch, from next to its end to pressed in."""
    rows = []
    off = {control: punch.pull_off(control) for control in CONTROLS}
    for part in (-0.99, -0.9, -0.5, -0.1, 0.3, 5.0):
        found = punch.state(mp.mpf(few(float(abs(off["displacement"].delta) * part))))
        held = CONTROLS if found.a > 0 else CONTROLS[:1]
        answers = {control: 1 - found.under(control) / off[control].under(control) for control in held}
        rows.append({**row(found, answers, WRITTEN), "energy": digits(punch.energy(found), WRITTEN)})
    return rows


@click.command(help=(__doc__ or "").split("\n")[0])
@OUTPUT
@click.option("--shape", "shapes", multiple=True, help='Only these, or "maugis"; default all.')
def main(output: Path, shapes: tuple[str, ...]) -> None:
    """Write one table a shape."""
    for shape in dict.fromkeys(shapes or ["maugis", *(case.shape for case in CASES)]):
        if shape == "maugis":
            write(output / "maugis.json", shape, [maugis(lam) for lam in LAMBDAS])
        else:
            cases = [case for case in CASES if case.shape == shape]
            entries = [table(case, strength) for case in cases for strength in case.strengths()]
            write(output / f"dugdale_{shape}.json", shape, entries)


if __name__ == "__main__":
    main()
