"""Make the tables of elastic-plastic asperities: by the springs, 30 right digits, and by LAMMPS where it is there.

    python data_gen/plastic_references.py -o tests/data

Rows of ``plastic_references.json`` are largest indentation, rise above it, force, contact radius and stored energy;
those of ``plastic_lammps.json`` grown radius, largest overlap, rise above it and force (``studies/versus_lammps.py``).
"""

import os
import sys
from dataclasses import asdict, replace
from itertools import cycle, product
from pathlib import Path
from typing import Any

import click
import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "pipelines"))
from oracles.multiprecision import digits, mp
from oracles.plastic import Contact
from references import OUTPUT, write, written
from studies.versus_lammps import CASES, COMMAND, compare, follow

RATIOS, DEPTHS = (10.0, 50.0, 300.0, 3e3, 1e5, 1e7), (1.01, 1.7, 10.0, 300.0, 1e4)
"""E*/Y, and largest indentation over that of first yield."""


def table(contact: Contact, d: float) -> dict[str, Any]:
    """Return the entry of a contact and its largest indentation [m]."""
    found, lost = {"onset": contact.onset, "start": contact.start}, mp.mpf(d)
    if d > contact.start:
        made, lost = contact.ends(d)
        found |= {"made": made, "ends": lost, "lost": contact.lost(d)}
    rises = [float(lost * mp.mpf(part)) for part in ("0", "0.4", "0.99")]
    rows = [[d, u, *(digits(number, 30) for number in contact.state(d, u))] for u in rises]
    return {**asdict(contact), **written(found, 30), "rows": rows}


def by_springs() -> list[dict[str, Any]]:
    """Return entries of all moduli and depths below the radius; the other parameters go round."""
    found, shapes = [], cycle(("sphere", "paraboloid", "paraboloid"))
    others = zip(shapes, cycle((1e-9, 1e-6, 2e-4, 1.0)), cycle((None, 0.3, 0.0, None, 0.5)),
                 cycle((0.0, 1e-4, 0.0, 0.03, 1.0, 10.0, 0.3)), strict=True)  # fmt: skip
    for (ratio, depth), (shape, radius, poisson, reach) in zip(product(RATIOS, DEPTHS), others, strict=False):
        contact = Contact(radius, 1e11, 1e11 / ratio, 0.0, shape, poisson)
        d = float(f"{float(depth * contact.onset):.6g}")
        if d < radius:
            springs, half, _ = contact.springs(mp.mpf(d))
            work = float((reach * half) ** 2 * contact.modulus / (2 * mp.pi * springs.widest))
            found.append(table(replace(contact, work=float(f"{work:.4g}")), d))
    return found


@click.command(help=(__doc__ or "").split("\n")[0])
@OUTPUT
def main(output: Path) -> None:
    """Write the tables."""
    write(output / "plastic_references.json", "elastic-plastic", by_springs())
    if command := os.environ.get(COMMAND):
        entries = []
        for case in CASES[1::3]:
            rows = follow(case, command)
            alike = np.isfinite(compare(case.body(), rows))
            entries.append({"body": case.body()._asdict(), "rows": rows[alike].tolist()})
        write(output / "plastic_lammps.json", "sphere", entries)


if __name__ == "__main__":
    main()
