"""Exports of AFM programs: each layout is read as the same curve, whatever its signs, units, order and pauses."""

import json
import tomllib
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
from tips import MODULUS, OFFSET, Floats, Tip, hertz

import roughmdr as rm
from roughmdr.errors import StoreError
from roughmdr.fitting.measured import MeasuredCurve, read_measured

STIFFNESS, SENSITIVITY = 0.04, 5e-8  # N/m and m/V
DOWN = np.linspace(2e-6, -1e-6, 40)  # position of the tip
APPROACH, RETRACT = hertz(1e3, 1e-5, 0.0, -DOWN), 1.1 * hertz(1e3, 1e-5, 0.0, -DOWN[::-1])
TIP, FORCE = np.concatenate([DOWN, DOWN[::-1]]), np.concatenate([APPROACH, RETRACT])
BASE = TIP - FORCE / STIFFNESS


def jpk(path: Path, tip: bool = True, unit: str = "N", **header: object) -> Path:
    """Write what JPK Data Processing 6 exports, with a pause between the segments and one after them."""
    per_unit = {"N": 1.0, "m": STIFFNESS, "V": STIFFNESS * SENSITIVITY}[unit]
    header = {"springConstant": STIFFNESS, "sensitivity": SENSITIVITY} | header
    lines = ["# TEXT EXPORT", "# data-description.instrument: JPK00911", "# index: -1"]
    pause = np.full(3, 1e-7), np.full(3, 1e-9), np.full(3, 1e-7)
    segments = [("extend", slice(0, 40)), ("pause", None), ("retract", slice(40, 80)), ("pause", None)]
    for number, (name, part) in enumerate(segments):
        columns = [*(["verticalTipPosition"] if tip else []), "vDeflection", "strainGaugeHeight", "height", "time"]
        lines += [
            "# index: -1",
            "#",
            f"# segmentIndex: {number}",
            f"# segment: {name}",
            f"# columns: {' '.join(columns)}",
        ]
        lines += ['# fancyNames: "Vertical Tip Position" "Vertical Deflection" "Height (measured)" "Height" "Time"']
        lines += [f"# {key}: {value}" for key, value in header.items() if value is not None]
        lines += [f"# units: {'m ' if tip else ''}{unit} m m s", "#"]
        at, load, base = pause if part is None else (TIP[part], FORCE[part] / per_unit, BASE[part])
        for i, row in enumerate(zip(at, load, base, base + 3e-6, strict=True)):
            lines.append(" ".join(f"{each:.12g}" for each in (*row[1 - tip :], i)))
        lines.append("")
    path.write_text("\n".join(lines))
    return path


def nanoscope(path: Path, load: str = "pN", header: bool = False, reverse: bool = False) -> Path:
    """Write what NanoScope Analysis exports: the ramp grows towards the surface, the retract is four rows shorter."""
    lines = ['"\\*Force file list"', f'"\\Spring Constant: {STIFFNESS}"', '"\\@Sens. DeflSens: V 50 nm/V"'] * header
    lines += ['"\\*Force file list end"'] * header
    names = ["Calc_Ramp_Ex_nm", "Calc_Ramp_Rt_nm", f"Defl_{load}_Ex", f"Defl_{load}_Rt", "Defl_Lsb_Ex", "Defl_Lsb_Rt"]
    lines.append("\t".join(names) + "\t")
    size = {"pN": 1e-12, "nm": 1e-9 * STIFFNESS, "V": SENSITIVITY * STIFFNESS}[load]
    ramp, deflection = 1e9 * (BASE[0] - BASE), FORCE / size
    order = slice(None, None, -1) if reverse else slice(None)
    retract, lifted = ramp[40:76][order], deflection[40:76][order]
    for i in range(40):
        first, second = (f"{ramp[i]:.9e}", f"{deflection[i]:.9e}"), ("", "")
        if i < 36:
            second = f"{retract[i]:.9e}", f"{lifted[i]:.9e}"
        lines.append("\t".join([first[0], second[0], first[1], second[1], "7", "8" * bool(second[0])]) + "\t")
    path.write_text("\r\n".join(lines) + "\r\n")
    return path


def table(path: Path, tip: bool = True) -> Path:
    """Write what afmformats exports: the first row stands behind the names."""
    about = {"imaging mode": "force-distance", "spring constant": STIFFNESS, "sensitivity": SENSITIVITY}
    lines = [
        "# afmformats 0.13.3",
        "#",
        "# BEGIN METADATA",
        *(f"# {each}" for each in json.dumps(about, indent=2).split("\n")),
    ]
    lines += ["# END METADATA", "#"]
    names = ["force", "height (measured)", "segment", "time", *(["tip position"] if tip else [])]
    rows = [
        "\t".join([f"{load:.12g}", f"{base:.12g}", str(i >= 40), str(i), *([f"{at:.12g}"] if tip else [])])
        for i, (load, base, at) in enumerate(zip(FORCE, BASE, TIP, strict=True))
    ]
    path.write_text("\n".join([*lines, "# " + "\t".join(names) + rows[0], *rows[1:]]) + "\n")
    return path


def check(curve: MeasuredCurve, control: str, steps: Floats, force: Floats, rtol: float = 1e-9) -> None:
    assert (curve.control, curve.quantity) == (control, "force")
    np.testing.assert_allclose(curve.values - curve.values[-1], steps - steps[-1], rtol=rtol, atol=rtol * 1e-6)
    np.testing.assert_allclose(curve.load, force, rtol=rtol, atol=rtol * 1e-8)


@pytest.mark.parametrize(("write", "rows"), [(jpk, slice(0, 80)), (table, slice(1, 80))], ids=["jpk", "table"])
def test_the_position_of_the_tip_is_the_separation(tmp_path: Path, write: Callable[..., Path], rows: slice) -> None:
    """Found by the content of the file: its name says nothing."""
    curve = read_measured(write(tmp_path / "curve"), 1)
    check(curve, "separation", TIP[rows], FORCE[rows])
    np.testing.assert_allclose(curve.values, TIP[rows], rtol=1e-9)
    assert curve.stiffness == STIFFNESS
    assert "separation from " in curve.about
    assert "spring constant 40 mN/m" in curve.about


@pytest.mark.parametrize("unit", ["N", "m", "V"])
def test_the_height_of_jpk_is_the_far_end_of_the_spring(tmp_path: Path, unit: str) -> None:
    curve = read_measured(jpk(tmp_path / "curve.txt", tip=False, unit=unit), 1)
    check(curve, "remote", BASE, FORCE)
    assert "remote from strainGaugeHeight, force from vDeflection" in curve.about


@pytest.mark.parametrize("load", ["pN", "nm", "V"])
def test_the_ramp_of_nanoscope_brings_the_tip_nearer(tmp_path: Path, load: str) -> None:
    curve = read_measured(nanoscope(tmp_path / "curve.spm.txt", load, header=True), 1)
    kept = slice(0, 76)
    check(curve, "remote", BASE[kept], FORCE[kept], rtol=1e-8)
    assert curve.stiffness == STIFFNESS


def test_a_retract_that_is_stored_from_its_end_is_turned(tmp_path: Path) -> None:
    plain, turned = (read_measured(nanoscope(tmp_path / f"{each}.txt", reverse=each), 1) for each in (False, True))
    np.testing.assert_array_equal(plain.values, turned.values)
    np.testing.assert_array_equal(plain.load, turned.load)
    assert plain.stiffness is None


def test_a_table_without_the_tip_has_the_height(tmp_path: Path) -> None:
    check(read_measured(table(tmp_path / "curve.tab", tip=False), 1), "remote", BASE[1:], FORCE[1:])


def test_what_cannot_be_used_is_told(tmp_path: Path) -> None:
    def refused(path: Path) -> str:
        with pytest.raises(StoreError) as raised:
            read_measured(path, 1)
        text = str(raised.value)
        assert text.startswith(f"{path}: ")
        return text.removeprefix(f"{path}: ")

    path = tmp_path / "curve.txt"
    assert refused(nanoscope(path, "V")) == (
        "text export of NanoScope Analysis: has Defl in V alone, and no spring constant: export the force"
    )
    assert refused(jpk(path, unit="V", sensitivity=None)) == (
        "text export of JPK: has vDeflection in V alone, and no sensitivity of the detector: export the force"
    )
    assert refused(jpk(path, unit="m", springConstant=None)).endswith(
        "in m alone, and no spring constant: export the force"
    )
    assert refused(jpk(path, springConstant="none")).startswith("text export of JPK: cannot be read: could not convert")
    text = jpk(path).read_text()
    path.write_text(text.replace("vDeflection", "hDeflection"))
    assert "text export of JPK: has no channel vDeflection with a unit; it has verticalTipPosition [m]" in refused(path)
    path.write_text(text.replace("segment: extend", "segment: pause").replace("segment: retract", "segment: pause"))
    assert refused(path) == "text export of JPK: holds no approach and no retract"
    lines = text.splitlines()
    lines[20] = "1e-6 nought 2 3 4"
    path.write_text("\n".join(lines))
    assert refused(path) == "line 21: '1e-6 nought 2 3 4': expected numbers for verticalTipPosition vDeflection " + (
        "strainGaugeHeight height time"
    )
    lines[20] = "1e-6 nan 2 3 4"
    path.write_text("\n".join(lines))
    assert refused(path).startswith("line 21: force = nan: expected a number in N")
    path.write_text(text + text.replace("# index: -1", "# index: 2"))
    assert refused(path).endswith("holds several force curves; a fit takes one")


def test_files_of_instruments_are_left_to_afmformats(tmp_path: Path) -> None:
    pytest.importorskip("afmformats")
    from afmformats import load_data
    from afmformats.mod_force_distance import AFMForceDistance

    data = {"force": FORCE, "height (measured)": BASE, "segment": np.arange(80) // 40}
    about = {"path": tmp_path, "enum": 0, "imaging mode": "force-distance", "spring constant": STIFFNESS}
    made = AFMForceDistance(data, about)
    path = tmp_path / "curve.h5"
    made.export_data(path, metadata=True, fmt="hdf5")
    assert len(load_data(path)) == 1
    curve = read_measured(path, 1)
    check(curve, "remote", BASE, FORCE)
    assert (curve.stiffness, curve.origin) == (STIFFNESS, str(path))
    (tmp_path / "other.bin").write_bytes(b"PK\0\0")
    with pytest.raises(StoreError, match="not a text file, and in no format that afmformats reads: "):
        read_measured(tmp_path / "other.bin", 1)


@pytest.mark.skipif(find_spec("afmformats") is not None, reason="the extra is there")
def test_the_extra_is_named_where_it_is_missing(tmp_path: Path) -> None:
    (tmp_path / "curve.jpk-force").write_bytes(b"PK\0\0")
    with pytest.raises(StoreError, match=r"afmformats, which is not installed: pip install -e '.\[afm\]'"):
        read_measured(tmp_path / "curve.jpk-force", 1)


@pytest.mark.parametrize(
    ("write", "options"),
    [(jpk, {}), (jpk, {"tip": False}), (nanoscope, {"header": True}), (table, {"tip": False})],
    ids=["jpk, tip", "jpk, height", "nanoscope", "table"],
)
def test_all_are_fitted_alike(tmp_path: Path, write: Callable[..., Path], options: dict[str, bool]) -> None:
    """The spring constant of the file is that of the machine, unless the scene has its own."""
    tip, path = Tip("hertz", 1e-6, 750.0), write(tmp_path / "curve", **options)
    fit = rm.fit(path, tip.scene(), [MODULUS, OFFSET], set={MODULUS: 1e3})
    assert float(fit.material_modulus) == pytest.approx(1.05 * 750.0, rel=0.01)  # the retract is stiffer by a tenth
    assert fit.attrs["measured"].startswith(f"{path}: t")
    assert fit.attrs["measured"] in rm.info(fit)
    if "remote" in fit.coords:
        assert tomllib.loads(fit.attrs["scene"])["path"]["machine_stiffness"] == STIFFNESS
        own = rm.fit(path, tip.scene(path={"machine_stiffness": 1.0}), [MODULUS, OFFSET], set={MODULUS: 1e3})
        assert tomllib.loads(own.attrs["scene"])["path"]["machine_stiffness"] == 1.0
        again = rm.fit(fit.isel(point=slice(2, None)), tip.scene(), [MODULUS, OFFSET], set={MODULUS: 1e3})
        assert tomllib.loads(again.attrs["scene"])["path"]["machine_stiffness"] == STIFFNESS
        assert float(own.material_modulus) < 0.9 * float(fit.material_modulus)
