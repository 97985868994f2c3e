"""Make the reference tables of single asperities: 40 right digits, from the integrals over the profile's slope.

    python data_gen/references.py -o tests/data --shape cone --shape sphere

Nothing here knows g or G of a shape. A shape is its slope f'(r) alone, piecewise a sum of powers, and with r = a
cos(psi) g(a) = a ∫ f' dpsi and G(a) = a^2 ∫ f' sin(psi)^2 dpsi over 0 < psi < pi/2, piece by piece (H 17). The
asperities of ``reference_cases.json`` cover at random what double precision can hold; ``width`` and ``rise`` [m] are
the lengths in which their rows without adhesion are measured. The inputs are doubles, written so that they read back to
the last bit; the results are the exact ones of these doubles.
"""

import json
import multiprocessing
import sys
from pathlib import Path
from typing import Any, NamedTuple

import click

sys.path.insert(0, str(Path(__file__).parents[1] / "pipelines"))
from oracles.jkr import ENERGY_WRITTEN, WRITTEN, Asperity, Branch
from oracles.multiprecision import Number, digits, mp
from oracles.profiles import Parameters, Profile, knot_slopes, profile_of

WORKING = 100  # digits carried. Next to a corner fold a - b may be 1e-32 of b, so far more than the 40 that are written
DISTANCES = {
    "indentation": (1e-12, 1e-9, 1e-6, 1e-3, 0.1, 0.9, 1.0, 3.0, 30.0, 1001.0),
    "force": (1e-12, 1e-6, 1e-2, 1.0, 10.0, 1001.0),
}
"""X = 1 - control/pull-off: 0 at the fold, 1 where the control is 0."""
ENERGY_DISTANCES = (1e-3, 1.0, 30.0)
DECADES = {"indentation": (-8.0, -5.0, -2.0, -0.5, 0.4, 3.0), "force": (-8.0, -4.0, -1.0, 0.5, 3.0)}
"""Without adhesion: powers of ten of the rise, and of effective_modulus * width * rise."""
ENERGY_DECADES = (-2.0, 0.4)
CASES: dict[str, list[dict[str, Any]]] = json.loads(Path(__file__).with_name("reference_cases.json").read_text())


class Punch(Asperity):
    """A flat punch, which has no slope to integrate: its contact is as wide as it is until it lets go (Kendall)."""

    def branches(self, control: str) -> list[Branch]:
        """Return the one branch, from where it lets go, at delta = -dl(width)."""
        return [Branch(self.width, None, self.state(self.width)[control])]

    def solve(self, branches: list[Branch], control: str, value: float) -> dict[str, Number]:
        """Return the state with ``control`` = ``value``."""
        k, given = 2 * self.effective_modulus * self.width, mp.mpf(value)
        delta, force = (given, k * given) if control == "indentation" else (given / k, given)
        return {"contact_radius": self.width, "indentation": delta, "force": force, "stiffness": k}


class Case(NamedTuple):
    """One asperity."""

    shape: str
    parameters: Parameters
    effective_modulus: float
    work: float
    width: float
    rise: float


def values(case: Case, control: str, pull_off: Number) -> list[tuple[float, bool]]:
    """Return the controls [m or N] of the rows of a case, and whether each row also states the energy."""
    stated = control == "indentation"
    if case.work > 0.0:
        exact = ((float(pull_off * (1 - mp.mpf(X))), X) for X in DISTANCES[control])
        return [(value, stated and X in ENERGY_DISTANCES) for value, X in exact]
    unit = case.rise if stated else case.effective_modulus * case.width * case.rise
    return [(float(f"{unit * 10.0**u:.6g}"), stated and u in ENERGY_DECADES) for u in DECADES[control]]


def table(case: Case) -> dict[str, Any]:
    """Return the entry of one case."""
    with mp.workdps(WORKING):
        entry = head(case.shape, case.parameters, modulus=case.effective_modulus, work=case.work)
        rows = asperity_rows(case, entry)
        return {**entry, "rows": rows}


def head(shape: str, parameters: Parameters, **numbers: float) -> dict[str, Any]:
    """Return what an entry begins with: the parameters, of a table also the slopes at its knots, and more numbers."""
    slopes = {"slopes": knot_slopes(parameters["r"], parameters["f"])} if shape == "tabulated" else {}
    return {"parameters": parameters, **slopes, **numbers}


def asperity_rows(case: Case, entry: dict[str, Any]) -> list[dict[str, Any]]:
    """Return the rows of a case; fills in the pull-off of ``entry``."""
    punch = case.shape == "flat_punch"
    profile = Profile([]) if punch else profile_of(case.shape, case.parameters)
    asperity = (Punch if punch else Asperity)(profile, case.effective_modulus, case.work, case.width)
    rows = []
    for control in DISTANCES:
        branches = asperity.branches(control)
        least = min(branches, key=lambda branch: branch.value)
        wanted = values(case, control, least.value)
        if case.work > 0.0:
            end = asperity.state(least.lo)
            del end["stiffness"]
            entry.setdefault("pull_off", {})["displacement" if control == "indentation" else "force"] = written(end)
            outer = branches[-1].value
            if outer > least.value:  # either side of the jump inwards
                wanted += [(float(outer * (1 + side)), False) for side in (-1e-3, 1e-3)]
        for value, energy in wanted:
            found = asperity.solve(branches, control, value) if value > least.value else None
            if found is None or (profile.end is not None and found["indentation"] > 3 * profile.end):
                continue
            a, delta = found["contact_radius"], found["indentation"]
            rows.append(row(control, value, found, asperity.energy(a, delta) if energy else None))
    return rows


def row(control: str, value: float, state: dict[str, Number], energy: Number | None) -> dict[str, Any]:
    """Return one line of a table."""
    line = {"control": control, "value": value, **written(state)}
    return line if energy is None else {**line, "energy": digits(energy, ENERGY_WRITTEN)}


def written(state: dict[str, Number], count: int = WRITTEN) -> dict[str, str]:
    """Return numbers written with so many digits."""
    return {name: digits(number, count) for name, number in state.items()}


def write(path: Path, shape: str, entries: list[dict[str, Any]]) -> None:
    """Write the JSON of one shape, a row a line."""
    blocks = []
    for entry in entries:
        begin = json.dumps({name: value for name, value in entry.items() if name != "rows"})[:-1]
        rows = ",\n".join(json.dumps(each) for each in entry["rows"])
        blocks.append(f'{begin}, "rows": [\n{rows}\n]}}')
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f'{{"shape": {json.dumps(shape)}, "cases": [\n' + ",\n".join(blocks) + "\n]}\n", encoding="utf-8")
    count = sum(len(entry["rows"]) for entry in entries)
    click.echo(f"{path}: {len(entries)} cases, {count} rows, {path.stat().st_size} bytes")


OUTPUT = click.option(
    "-o", "--output", type=click.Path(file_okay=False, path_type=Path), default=Path("tests/data"), show_default=True
)


@click.command(help=(__doc__ or "").split("\n")[0])
@OUTPUT
@click.option("--shape", "shapes", type=click.Choice(list(CASES)), multiple=True, help="Only these; default all.")
@click.option("--workers", type=click.IntRange(min=1), default=2, show_default=True, help="Processes.")
def main(output: Path, shapes: tuple[str, ...], workers: int) -> None:
    """Write one table a shape."""
    with multiprocessing.Pool(workers) as pool:
        pending = {
            shape: pool.map_async(table, [Case(shape, **case) for case in CASES[shape]], chunksize=1)
            for shape in dict.fromkeys(shapes or CASES)
        }
        for shape, result in pending.items():
            write(output / f"{shape}.json", shape, result.get())


if __name__ == "__main__":
    main()
