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
from oracles.jkr import ENERGY_WRITTEN, WRITTEN, Asperity
from oracles.multiprecision import Number, digits, mp
from oracles.profiles import Parameters, knot_slopes, profile_of

WORKING = 100
"""Digits carried. Next to a corner fold a - b may be 1e-32 of b, so far more than the 40 that are written."""
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


class Case(NamedTuple):
    """One asperity."""

    shape: str
    parameters: Parameters
    effective_modulus: float
    work: float
    width: float
    rise: float

    @property
    def slopes(self) -> list[float] | None:
        """The slopes at the knots of a table."""
        return knot_slopes(self.parameters["r"], self.parameters["f"]) if self.shape == "tabulated" else None


def values(case: Case, control: str, pull_off: Number) -> list[tuple[float, bool]]:
    """Return the controls [m or N] of the rows of a case, and whether each row also states the energy."""
    if case.work > 0.0:
        distances = DISTANCES[control]
        exact = [(float(pull_off * (1 - mp.mpf(X))), X in ENERGY_DISTANCES) for X in distances]
        return [(value, energy and control == "indentation") for value, energy in exact]
    unit = case.rise if control == "indentation" else case.effective_modulus * case.width * case.rise
    return [
        (float(f"{unit * 10.0**u:.6g}"), u in ENERGY_DECADES and control == "indentation") for u in DECADES[control]
    ]


def table(case: Case) -> dict[str, Any]:
    """Return the entry of one case."""
    with mp.workdps(WORKING):
        entry: dict[str, Any] = {"parameters": case.parameters}
        if case.slopes is not None:
            entry["slopes"] = case.slopes
        entry |= {"modulus": case.effective_modulus, "work": case.work}
        rows = punch_rows(case, entry) if case.shape == "flat_punch" else asperity_rows(case, entry)
        return {**entry, "rows": rows}


def punch_rows(case: Case, entry: dict[str, Any]) -> list[dict[str, Any]]:
    """A flat punch has no slope to integrate: a = b, and Kendall's pull-off at delta = -dl(b)."""
    b, effective_modulus, work = mp.mpf(case.parameters["radius"]), mp.mpf(case.effective_modulus), mp.mpf(case.work)
    k = 2 * effective_modulus * b
    lost = -mp.sqrt(2 * mp.pi * b * work / effective_modulus)
    end = {"contact_radius": b, "indentation": lost, "force": k * lost}
    if work > 0:
        written = {name: digits(number, WRITTEN) for name, number in end.items()}
        entry["pull_off"] = {"displacement": written, "force": written}
    rows = []
    for control in DISTANCES:
        for value, energy in values(case, control, end[control]):
            delta = mp.mpf(value) if control == "indentation" else mp.mpf(value) / k
            force = mp.mpf(value) if control == "force" else k * delta
            state = {"contact_radius": b, "indentation": delta, "force": force, "stiffness": k}
            rows.append(
                row(control, value, state, effective_modulus * b * delta**2 - mp.pi * work * b**2 if energy else None)
            )
    return rows


def asperity_rows(case: Case, entry: dict[str, Any]) -> list[dict[str, Any]]:
    """Return the rows of every other shape; fills in the pull-off of ``entry``."""
    asperity = Asperity(
        profile_of(case.shape, case.parameters, case.slopes), case.effective_modulus, case.work, case.width
    )
    rows = []
    for control in DISTANCES:
        branches = asperity.branches(control)
        least = min(branches, key=lambda branch: branch.value)
        wanted = values(case, control, least.value)
        if case.work > 0.0:
            state = asperity.state(least.lo)
            end = {name: digits(state[name], WRITTEN) for name in ("contact_radius", "indentation", "force")}
            entry.setdefault("pull_off", {})["displacement" if control == "indentation" else "force"] = end
            outer = branches[-1].value
            if outer > least.value:  # either side of the jump inwards
                wanted += [(float(outer * (1 + side)), False) for side in (-1e-3, 1e-3)]
        for value, energy in wanted:
            found = asperity.solve(branches, control, value) if value > least.value else None
            if found is None or (asperity.profile.end is not None and found["indentation"] > 3 * asperity.profile.end):
                continue
            work_done = None
            if energy:
                work_done = asperity.energy(found["contact_radius"], found["indentation"])
            rows.append(row(control, value, found, work_done))
    return rows


def row(control: str, value: float, state: dict[str, Number], energy: Number | None) -> dict[str, Any]:
    """Return one line of a table."""
    line: dict[str, Any] = {"control": control, "value": value}
    line |= {name: digits(number, WRITTEN) for name, number in state.items()}
    return line if energy is None else {**line, "energy": digits(energy, ENERGY_WRITTEN)}


def text(shape: str, entries: list[dict[str, Any]]) -> str:
    """Return the JSON of one shape, a row a line."""
    blocks = []
    for entry in entries:
        head = json.dumps({name: value for name, value in entry.items() if name != "rows"})[:-1]
        rows = ",\n".join(json.dumps(each) for each in entry["rows"])
        blocks.append(f'{head}, "rows": [\n{rows}\n]}}')
    return f'{{"shape": {json.dumps(shape)}, "cases": [\n' + ",\n".join(blocks) + "\n]}\n"


@click.command(help=(__doc__ or "").split("\n")[0])
@click.option(
    "-o", "--output", type=click.Path(file_okay=False, path_type=Path), default=Path("tests/data"), show_default=True
)
@click.option("--shape", "shapes", type=click.Choice(list(CASES)), multiple=True, help="Only these; default all.")
@click.option("--workers", type=click.IntRange(min=1), default=2, show_default=True, help="Processes.")
def main(output: Path, shapes: tuple[str, ...], workers: int) -> None:
    """Write one table a shape."""
    output.mkdir(parents=True, exist_ok=True)
    with multiprocessing.Pool(workers) as pool:
        pending = {
            shape: pool.map_async(table, [Case(shape, **case) for case in CASES[shape]], chunksize=1)
            for shape in dict.fromkeys(shapes or CASES)
        }
        for shape, result in pending.items():
            entries = result.get()
            path = output / f"{shape}.json"
            path.write_text(text(shape, entries), encoding="utf-8")
            rows = sum(len(entry["rows"]) for entry in entries)
            click.echo(f"{path}: {len(entries)} cases, {rows} rows, {path.stat().st_size} bytes")


if __name__ == "__main__":
    main()
