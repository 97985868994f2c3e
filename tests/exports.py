"""Plain readers of exported files, for the tests."""

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def of_abaqus(path: Path) -> tuple[str, Floats, Floats]:
    """The keyword line, the second column and the first of an option of Abaqus or CalculiX."""
    lines = [line for line in path.read_text("ascii").splitlines() if not line.startswith("**")]
    table = np.array([[float(part) for part in line.split(",")] for line in lines[1:]])
    assert all(len(part.strip()) <= 20 for line in lines[1:] for part in line.split(","))
    return lines[0], table[:, 1], table[:, 0]


def of_moose(path: Path) -> tuple[str, Floats, Floats]:
    """The type of the function, x and y."""
    text = re.sub(r"^#.*\n", "", path.read_text("ascii"), flags=re.MULTILINE)
    entries = dict(re.findall(r"(\w+) = ('[^']*'|\S+)", text))
    x, y = (np.array(entries[name].strip("'").split(), dtype=float) for name in "xy")
    return entries["type"], x, y


def of_ansys(path: Path) -> tuple[str, Floats, Floats]:
    """The primary variable, index values and values of a table."""
    name, size, primary = re.search(r"^\*DIM,(\w+),TABLE,(\d+),1,1,(\w+)$", path.read_text(), re.MULTILINE).groups()
    table = np.full((int(size), 2), np.nan)
    for row, column, value in re.findall(rf"^\*SET,{name}\((\d+),(\d)\),(\S+)$", path.read_text(), re.MULTILINE):
        table[int(row) - 1, int(column)] = float(value)
    return primary, table[:, 0], table[:, 1]


def of_lammps(path: Path) -> Floats:
    """Distances, energies and forces of the only section of a table for ``pair_style table``."""
    lines = path.read_text("ascii").splitlines()
    assert lines[0].startswith("#")
    keyword, size, blank, *rows = (line for line in lines[lines.index("") + 1 :])
    assert (keyword, blank) == ("ROUGH_FORCE", "")
    number, *table = np.array([row.split() for row in rows], dtype=float).T
    assert size == f"N {number.size}"
    np.testing.assert_array_equal(number, np.arange(number.size) + 1)
    assert (np.diff(table[0]) > 0.0).all()
    return np.array(table)


def of_csv(path: Path) -> pd.DataFrame:
    return pd.read_csv(path, comment="#")


def of_json(path: Path) -> dict[str, Any]:
    return json.loads(path.read_text("utf-8"))


def header_of(path: Path) -> str:
    """All comments as one text."""
    lines = [line.lstrip("*#! ") for line in path.read_text().splitlines() if line[:2] in ("**", "# ", "! ")]
    return " ".join(lines)
