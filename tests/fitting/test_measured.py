"""Measured curves: every spelling is read, every fault is told with its place."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from roughmdr.errors import StoreError
from roughmdr.fitting.measured import read_measured

ROWS = [(3.0, 0.1), (2.0, 0.5), (1.0, 2.0), (2.0, 0.4)]


@pytest.mark.parametrize(
    ("header", "separator", "scale"),
    [
        ("separation [um],force (mN)", ",", (1e-6, 1e-3)),
        ("Separation/µm;Force [ mN ]", ";", (1e-6, 1e-3)),
        ("separation [nm]\tforce/uN", "\t", (1e-9, 1e-6)),
        ("separation [um]  force [mN]", "  ", (1e-6, 1e-3)),
        ("separation force", " ", (1.0, 1.0)),
        ('"separation [um]","pressure (N/m^2)"', ",", (1e-6, 1.0)),
        ("remote/um, pressure / kPa", " , ", (1e-6, 1e3)),
        ("piezo [um]\tforce [nN]", "\t", (-1e-6, 1e-9)),
    ],
)
def test_any_spelling_is_read(tmp_path: Path, header: str, separator: str, scale: tuple[float, float]) -> None:
    path = tmp_path / "curve.csv"
    rows = [separator.join(map(str, row)) for row in ROWS]
    path.write_text("\ufeff# a comment\n\n" + "\n".join([header, *rows[:2], "# turn", *rows[2:]]) + "  # last\n")
    curve = read_measured(path, 1)
    np.testing.assert_allclose(curve.values, scale[0] * np.array(ROWS)[:, 0], rtol=1e-15)
    np.testing.assert_allclose(curve.load, scale[1] * np.array(ROWS)[:, 1], rtol=1e-15)
    assert (curve.control, curve.quantity) == (
        "separation" if "separation" in header.lower() else "remote",
        "pressure" if "pressure" in header else "force",
    )
    assert curve.error is None


@pytest.mark.parametrize(("separator", "end"), [(";", ""), ("\t", "\t"), (";", ";")])
def test_decimal_commas_and_delimiters_at_the_end(tmp_path: Path, separator: str, end: str) -> None:
    rows = [separator.join(("separation [um]", "force [mN]")) + end]
    rows += [separator.join(f"{number:.1f}".replace(".", ",") for number in row) + end for row in ROWS]
    path = tmp_path / "curve.csv"
    path.write_bytes(("\ufeff" + "\r\n".join(rows) + "\r\n").encode())
    curve = read_measured(path, 1)
    np.testing.assert_allclose(curve.values, 1e-6 * np.array(ROWS)[:, 0], rtol=1e-15)
    np.testing.assert_allclose(curve.load, 1e-3 * np.array(ROWS)[:, 1], rtol=1e-15)


def test_errors_weight_the_points() -> None:
    frame = pd.DataFrame(ROWS, columns=["separation", "force"]).assign(**{"force_error [mN]": 2})
    curve = read_measured(frame, 1)
    assert curve.error == pytest.approx(np.full(4, 2e-3))


def test_without_errors_the_largest_load_weighs_all_points_also_those_out_of_contact() -> None:
    frame = pd.DataFrame([(3.0, 0.0), (2.0, 0.0), (1.0, -5.0), (0.0, 2.0)], columns=["separation [um]", "force [nN]"])
    assert read_measured(frame, 1).weight == pytest.approx(np.full(4, 5e-9), rel=1e-12)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("separation,force\n1,2\n2,nan\n3,1\n4,1\n", r"line 3: force = 'nan': expected a number in N"),
        ("separation,force\n1,2\n2,inf\n3,1\n4,1\n", r"line 3: force = 'inf': expected a number in N"),
        ("separation,force\n# x\n1,2\n2,\n3,1\n4,1\n", r"line 4: force = '': expected a number in N"),
        ("separation,force\n1,2\n2\n3,1\n4,1\n", r"line 3: has 1 entries; the first line names 2 columns"),
        ("separation,force\n1,5,2,0\n", r"line 2: has 4 entries; the first line names 2 columns; write decimal points"),
        ("separation;force\n1.234,5;2\n", r"line 2: separation = '1.234,5': "),
        ("separation,force\n1,2\n2,1\n3,1\n", r"has 3 rows; at least 4 are needed"),
        ("separation,force,time\n1,2,3\n", r"column 'time': not known; it can be separation, force, force_error"),
        ("separation,force,force\n1,2,3\n", r"column 'force': is given twice"),
        ("separation,forse\n1,2\n", r"needs one column force or pressure; it has neither among separation, forse"),
        (
            "separation,remote,force\n1,2,3\n",
            r"needs one column separation, remote or piezo; it has separation and remote",
        ),
        ("separation [kg],force\n1,2\n", r"column 'separation': unknown unit 'kg'; expected a unit of m"),
        ("separation [N],force\n1,2\n", r"column 'separation': 'N' is a unit of N; expected a unit of m"),
        ("separation,force\n1,0\n2,0\n3,0\n4,0\n", r"force is 0 in every row"),
        ("separation,force,force_error\n1,1,0\n2,1,1\n3,1,1\n4,1,1\n", r"line 2: force_error = '0': must be above 0"),
        ("# nothing\n", "is empty"),
        ("", "is empty"),
        ("# columns: separation and force\nseparation,force\n1,2\n2,1\n3,1\n", r"has 3 rows; at least 4 are needed"),
        ("1,2\n2,3\n", r"needs one column separation, remote or piezo; it has neither among 1, 2"),
    ],
)
def test_a_fault_is_told_with_its_place(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "curve.csv"
    path.write_bytes(text.encode("latin-1"))
    with pytest.raises(StoreError, match=message) as raised:
        read_measured(path, 1)
    assert str(raised.value).startswith(str(path))


def test_files_that_are_none(tmp_path: Path) -> None:
    with pytest.raises(StoreError, match="no such file"):
        read_measured(tmp_path / "none.csv", 1)
    with pytest.raises(StoreError, match="is a folder"):
        read_measured(tmp_path, 1)
    (tmp_path / "binary.csv").write_bytes(b"\x89\xff\x00")
    with pytest.raises(StoreError, match="not a text file"):
        read_measured(tmp_path / "binary.csv", 1)
    with pytest.raises(StoreError, match="it must be the path of a CSV file, a DataFrame or a Dataset"):
        read_measured(3, 1)  # type: ignore[arg-type]
    frame = pd.DataFrame({"separation": [1.0, 2.0, 3.0, 4.0], "force": [1.0, np.nan, 1.0, 1.0]})
    with pytest.raises(StoreError, match="measured: row 1: force = nan: expected a number in N"):
        read_measured(frame, 1)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "cp1252"])
def test_text_is_read_as_spreadsheets_write_it(tmp_path: Path, encoding: str) -> None:
    (tmp_path / "curve.csv").write_bytes("separation [µm];force [nN]\n1;0\n0,5;1\n0;3\n-1;5\n".encode(encoding))
    curve = read_measured(tmp_path / "curve.csv", 1)
    assert curve.values == pytest.approx([1e-6, 5e-7, 0.0, -1e-6])
