"""Maps as text: headers, columns of coordinates, sides by name, decimal commas, words, encodings, instruments' .dat."""

import struct
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import roughmdr as rm
from roughmdr.ensemble.maps.height_map import HeightMap, map_statistics
from roughmdr.ensemble.maps.read_map import read_map

SHARED = Path(__file__).parents[3] / "shared" / "cases"
NX, NY, STEP = 24, 10, 0.5
HEIGHT = np.round(30.0 * np.random.default_rng(5).normal(size=(NX, NY)), 3)  # [nm] over x and y
GWYDDION = "# Channel: Height\n# Width: 12.00 µm\n# Height: 5.00 µm\n# Value units: {unit}\n"
FORMATS = (".txt", ".asc", ".csv", ".dat")


def rows(height: np.ndarray, delimiter: str = "\t", end: str = "\n") -> str:
    """Return lines along x, as instruments write them."""
    return end.join(delimiter.join(f"{value:.6g}" for value in line) for line in height.T) + end


def check(surface: HeightMap, rows_along: str = "x") -> None:
    height = surface.height if rows_along == "x" else surface.height.T
    np.testing.assert_allclose(height, 1e-9 * HEIGHT, rtol=1e-5)
    assert (surface.dx, surface.dy) == pytest.approx((0.5e-6, 0.5e-6), rel=1e-6)


@pytest.mark.parametrize("suffix", FORMATS)
@pytest.mark.parametrize(("unit", "factor"), [("nm", 1.0), ("m", 1e-9), ("µm", 1e-3)])
@pytest.mark.parametrize("encoding", ["utf-8", "latin-1", "utf-16"])
def test_a_header_is_read_in_any_text_file(
    tmp_path: Path, suffix: str, unit: str, factor: float, encoding: str
) -> None:
    path = tmp_path / f"map{suffix}"
    path.write_text(GWYDDION.format(unit=unit) + rows(factor * HEIGHT), encoding=encoding)
    check(read_map(path))
    check(read_map(path, size=(12e-6, 5e-6), unit=unit, channel="Height"))
    path.write_text(GWYDDION.format(unit=unit) + rows(factor * HEIGHT).replace(".", ","), encoding=encoding)
    check(read_map(path))


HEADERS = {
    "German Gwyddion": ("# Kanal: Höhe\n# Breite: 12,00 µm\n# Höhe: 5,00 µm\n# Werteinheiten: nm\n", 1.0),
    "older German Gwyddion": ("# Kanal: Höhe\n# Breite: 12,00 µm\n# Höhe: 5,00 µm\n# Einheiten: nm\n", 1.0),
    "Japanese Gwyddion": ("# チャネル： 高さ\n# 幅： 12.00 µm\n# 高さ： 5.00 µm\n# 値の単位： nm\n", 1.0),
    "SPIP": (
        "# File Format = ASCII\n# x-pixels = 24\n# y-pixels = 10\n# x-length = 12000\n# y-length = 5000\n"
        "# z-unit = nm\n",
        1.0,
    ),
    "SPIP in bits": ("# x-pixels = 24\n# y-pixels = 10\n# x-length = 12000\n# y-length = 5000\n# Bit2nm = 0.5\n", 2.0),
    "Nova": ("NX = 24\nNY = 10\nScale X = 0.5\nScale Y = 0.5\nUnit X = um\nUnit Data = nm\n", 1.0),
    "pixels": ("# pixel size = 0.5 um\n# height conversion factor (-> m) = 1e-9\n", 1.0),
    "plain": ("Width: 12 um\nHeight: 5 um\nValue units: um\n", 1e-3),
    "numbers of points": ("Width: 24\nHeight: 10\ncellsize 0.5 um\nUnit: nm\n", 1.0),
    "Keyence": (
        '"Measured date and time","3/2/2024 10:11:12"\n"Model","VK-X200 Series"\n"Data type","ImageDataCsv"\n"",""\n'
        '"Output image data","Height"\n"XY calibration","500","nm/pixel"\n"Horizontal","24"\n"Vertical","10"\n'
        '"Minimum value","1"\n"Unit","µm"\n"Reference data name",""\n""\n"Height"\n',
        1e-3,
    ),
}


@pytest.mark.parametrize("name", HEADERS)
@pytest.mark.parametrize("encoding", ["utf-8", "latin-1"])
def test_headers_of_others_are_read(tmp_path: Path, name: str, encoding: str) -> None:
    header, factor = HEADERS[name]
    delimiter = '","' if name == "Keyence" else "\t"
    lines = rows(factor * HEIGHT, delimiter)
    if name == "Keyence":
        lines = "".join(f'"{line}"\n' for line in lines.splitlines())
    (tmp_path / "map.csv").write_text(header + lines, encoding="utf-8" if "Japanese" in name else encoding)
    check(read_map(tmp_path / "map.csv"))


ESRI = "ncols 24\nnrows 10\nxllcorner 3.5\nyllcorner 7\ncellsize 0.5\nNODATA_value -9999\n"


@pytest.mark.parametrize("broken", [0, 7, 12])
def test_a_grid_may_leave_points_out_and_break_its_rows(tmp_path: Path, broken: int) -> None:
    """The header says how long a row is; numbers after each other, some to a line, are the same map."""
    path, heights = tmp_path / "map.asc", HEIGHT.copy()
    heights[3, 4] = -9999.0
    words = rows(1e-3 * np.where(heights == -9999.0, -9999e3, heights), " ").split()
    width = broken or NX
    path.write_text(ESRI + "\n".join(" ".join(words[k : k + width]) for k in range(0, len(words), width)) + "\n")
    for keys in ({"unit": "um"}, {"unit": "um", "size": (12e-6, 5e-6)}):
        surface = read_map(path, **keys)
        assert np.argwhere(np.isnan(surface.height)).tolist() == [[3, 4]]
        check(surface._replace(height=np.where(np.isnan(surface.height), 1e-9 * HEIGHT, surface.height)))
    with pytest.raises(
        rm.RoughmdrError, match=r"24 along x and 10 along y, 0.5 and 0.5 apart, have no unit; give unit"
    ):
        read_map(path)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (lambda lines: [*lines[:8], lines[8].rpartition(" ")[0], *lines[9:]],
         "line 9 has 23 numbers, but line 1 says 24 a row; all 10 lines have 239"),
        (lambda lines: [lines[0], *lines[2:6], *[line.rpartition(" ")[0] for line in (3 * lines[6:])[:24]]],
         "line 6 has 23 numbers, but line 1 says 24 a row; all 24 lines have 552"),
        (lambda lines: lines[:-1], "has 9 rows, but line 2 says 10"),
        (lambda lines: ["ncols 10", "nrows 24", *lines[2:]], "line 7 has 24 numbers, but line 1 says 10 a row"),
        (lambda lines: ["ncols 10.5", *lines[1:]], "line 1: '10.5' is no number of points"),
        (lambda lines: [*lines[:8], lines[8] + "x", *lines[9:]], "line 9, column 24: '.*x' is no number"),
    ],
)  # fmt: skip
def test_a_header_that_does_not_fit_its_rows_is_named(
    tmp_path: Path, change: Callable[[list[str]], list[str]], says: str
) -> None:
    (tmp_path / "map.txt").write_text("\n".join(change((ESRI + rows(HEIGHT, " ")).splitlines())))
    with pytest.raises(rm.RoughmdrError, match=says):
        read_map(tmp_path / "map.txt", unit="nm")


def test_channels_of_one_file_are_told_apart(tmp_path: Path) -> None:
    """Each has a header of its own; the first of heights is read unless another is named."""
    phase = GWYDDION.format(unit="deg").replace("Channel: Height", "Channel: Phase") + rows(HEIGHT[:, ::-1])
    second = GWYDDION.format(unit="um").replace("Channel: Height", "Channel: Back") + rows(2e-3 * HEIGHT)
    path = tmp_path / "map.txt"
    path.write_text(phase + GWYDDION.format(unit="nm") + rows(HEIGHT) + second)
    check(read_map(path))
    back = read_map(path, channel="Back")
    check(back._replace(height=0.5 * back.height))
    with pytest.raises(rm.RoughmdrError, match="unknown unit 'deg'"):
        read_map(path, channel="Phase")
    with pytest.raises(rm.RoughmdrError, match=r"no channel 'Top', but \['Phase', 'Height', 'Back'\]"):
        read_map(path, channel="Top")


@pytest.mark.parametrize(
    ("keys", "says"),
    [
        ({"size": (5e-6, 12e-6)}, "the file says itself that the map is 12 um x 5 um, and size differs"),
        ({"size": 12e-6}, "12 um x 5 um, and size differs"),
        ({"unit": "um"}, "heights are in nm; leave out unit = 'um'"),
        ({"channel": "Phase"}, r"has no channel 'Phase', but \['Height'\]"),
    ],
)
def test_a_header_is_not_contradicted(tmp_path: Path, keys: dict[str, object], says: str) -> None:
    (tmp_path / "map.txt").write_text(GWYDDION.format(unit="nm") + rows(HEIGHT))
    with pytest.raises(rm.errors.RoughmdrError, match=says):
        read_map(tmp_path / "map.txt", **keys)
    (tmp_path / "map.txt").write_text(GWYDDION.format(unit="deg") + rows(HEIGHT))
    with pytest.raises(rm.errors.RoughmdrError, match="units of the heights: unknown unit 'deg'"):
        read_map(tmp_path / "map.txt")


def test_sides_are_not_swapped_without_a_word(tmp_path: Path) -> None:
    """Rows of plain numbers are along y: ten of them are 5 um along x, or else the points are no squares."""
    path = tmp_path / "map.txt"
    path.write_text(rows(HEIGHT))

    def found(size: object) -> xr.Dataset:
        return rm.generate({"source": "surface", "file": str(path), "size": size, "unit": "nm"}, seed=0)

    right = found(["5 um", "12 um"])
    assert right.attrs["rows_along"] == "y"
    assert right.attrs["rms_slope"] == pytest.approx(
        map_statistics(HeightMap(1e-9 * HEIGHT, 5e-7, 5e-7))["rms_slope"], rel=1e-2
    )
    xr.testing.assert_identical(found({"across": "12 um", "down": "5 um"}), right)
    with pytest.raises(rm.SceneError, match=r'500 nm x 500 nm.*size = { across = "12 um", down = "5 um" }'):
        found(["12 um", "5 um"])
    assert found({"across": "5 um", "down": "12 um"}).attrs["rms_slope"] != pytest.approx(right.attrs["rms_slope"])
    for size in ({"across": "5 um"}, {"x": "5 um", "y": "5 um"}):
        with pytest.raises(rm.SceneError, match="must name both sides"):
            found(size)
    np.savetxt(path, HEIGHT[:10])  # as many points along both: only their names tell
    with pytest.raises(rm.SceneError, match="as near to a square grid or nearer; say which is which"):
        found(["12 um", "5 um"])


@pytest.mark.parametrize("suffix", [".xyz", ".txt", ".csv", ".dat"])
@pytest.mark.parametrize("delimiter", [" ", ";", ",", "\t"])
def test_columns_are_read_in_any_order(tmp_path: Path, suffix: str, delimiter: str) -> None:
    path, rng = tmp_path / f"map{suffix}", np.random.default_rng(1)
    i, j = (each.ravel() for each in np.indices((NX, NY)))
    columns = np.stack([STEP * i - 3.0, 7.0 + STEP * j, HEIGHT.ravel()], axis=1)[rng.permutation(NX * NY)]
    np.savetxt(path, columns * [1.0, 1.0, 1e-3], fmt="%.8g", delimiter=delimiter)
    check(read_map(path, unit="um"))
    np.savetxt(path, columns, fmt="%.8g", delimiter=delimiter)
    for size in ((12e-6, 5e-6), (11.5e-6, 4.5e-6)):  # from the first point to the last
        check(read_map(path, unit="nm", size=size))
    for keys, says in (
        ({}, "24 along x and 10 along y, 0.5 and 0.5 apart, have no unit; give unit"),
        ({"unit": "nm", "size": (5e-6, 12e-6)}, "12 along x and 5 along y, and size is 5 um x 12 um: no unit makes"),
        ({"unit": "nm", "channel": "z"}, "holds one map only"),
    ):
        with pytest.raises(rm.errors.RoughmdrError, match=says):
            read_map(path, **keys)
    if delimiter == " ":
        return
    titles = delimiter.join(["z [nm]", "x [µm]", "y [µm]"])
    text = "\n".join(delimiter.join(f"{value:.8g}" for value in row) for row in columns[:, [2, 0, 1]])
    path.write_text(f"{titles}\n{text}\n", encoding="latin-1")
    check(read_map(path))


@pytest.mark.parametrize("titles", ["x/um;y/um;z/nm", "X_um;Y_um;Height_nm", "X (µm);Y (µm);Height (nm)"])
def test_units_in_titles_are_read_however_they_are_spelled(tmp_path: Path, titles: str) -> None:
    x, y = np.meshgrid(STEP * np.arange(NX), STEP * np.arange(NY), indexing="ij")
    points = np.column_stack([x.ravel(), y.ravel(), HEIGHT.ravel()])
    path = tmp_path / "map.csv"
    path.write_text(f"{titles}\n" + "\n".join(";".join(map(str, point)) for point in points))
    check(read_map(path))
    with pytest.raises(rm.RoughmdrError, match="the file says itself that heights are in nm"):
        read_map(path, unit="um")


def test_points_that_are_not_there_are_undefined_and_scattered_ones_refused(tmp_path: Path) -> None:
    path = tmp_path / "map.xyz"
    i, j = (each.ravel() for each in np.indices((NX, NY)))
    columns = np.stack([STEP * i, STEP * j, HEIGHT.ravel()], axis=1)
    np.savetxt(path, np.delete(columns, [30, 31], axis=0), fmt="%.6g")
    holes = read_map(path, unit="um").height
    assert holes.shape == HEIGHT.shape
    assert np.isnan(holes).ravel().nonzero()[0].tolist() == [30, 31]
    kept = np.random.default_rng(2).permutation(NX * NY)
    np.savetxt(path, columns[np.sort(kept[:144])], fmt="%.6g")
    assert np.isnan(read_map(path, unit="um").height).sum() == 96
    np.savetxt(path, columns[kept[:100]], fmt="%.6g")
    with pytest.raises(rm.errors.RoughmdrError, match="do not lie on an evenly spaced grid"):
        read_map(path, unit="um")
    np.savetxt(path, columns * [2.0 / 3.0, 2.0 / 3.0, 1.0], fmt="%.1f")  # 0, 0.3, 0.7, 1, ...
    assert read_map(path, unit="um").height.shape == (NX, NY)
    np.savetxt(path, [*columns, columns[7]], fmt="%.6g")
    with pytest.raises(rm.errors.RoughmdrError, match="lines 8 and 241 give a height to one point"):
        read_map(path, unit="um")
    np.savetxt(path, np.insert(columns, 3, 1.0, axis=1), fmt="%.6g")
    with pytest.raises(rm.errors.RoughmdrError, match="begin with x and y on a grid, and have 2 numbers more; keep z"):
        read_map(path, unit="um")
    np.savetxt(path, np.random.default_rng(0).normal(size=(200, 3)))
    with pytest.raises(rm.errors.RoughmdrError, match=r"200 different x and 200 different y, .* interpolate scattered"):
        read_map(path, unit="um")


@pytest.mark.parametrize("ending", ["", "{}"])
@pytest.mark.parametrize(("delimiter", "comma"), [(";", True), ("\t", True), ("; ", True), (" ", True), (",", False)])
def test_decimal_commas_and_delimiters_at_the_end(tmp_path: Path, delimiter: str, comma: bool, ending: str) -> None:
    text = rows(HEIGHT, delimiter, ending.format(delimiter) + "\n")
    (tmp_path / "map.txt").write_text(text.replace(".", ",") if comma else text)
    check(read_map(tmp_path / "map.txt", size=(5e-6, 12e-6), unit="nm"), "y")


@pytest.mark.parametrize("word", ["nan", "NaN", "BAD", "---", "n/a", "inf"])
def test_words_for_undefined_points(tmp_path: Path, word: str) -> None:
    lines = rows(HEIGHT, ";").splitlines()
    first = lines[2].split(";")
    lines[2] = ";".join([word, "" if word == "BAD" else word, *first[2:]])
    (tmp_path / "map.csv").write_text("Höhe in nm\n" + "\n".join(lines), encoding="latin-1")
    found = read_map(tmp_path / "map.csv", size=(5e-6, 12e-6), unit="nm").height.T
    expected = 1e-9 * HEIGHT
    expected[:2, 2] = np.nan
    np.testing.assert_allclose(found, expected, rtol=1e-5)


def metropro(path: Path, phase: np.ndarray, intensity: int = 0) -> None:
    """Write heights as an interferometer does: 834 bytes of header, intensities, and phases line by line."""
    header = bytearray(834)
    header[:4] = b"\x88\x1b\x03\x6f"
    struct.pack_into(">HI", header, 4, 1, 834)
    struct.pack_into(">HHHhI", header, 52, intensity, intensity, min(intensity, 1), 0, 2 * intensity**2)
    struct.pack_into(">HHI", header, 68, phase.shape[1], phase.shape[0], 4 * phase.size)
    struct.pack_into(">ffffff", header, 164, 0.5, 6.328e-7, 0.0, 1.0, 1.0, 0.5e-6)
    struct.pack_into(">h", header, 218, 1)
    path.write_bytes(bytes(header) + bytes(2 * intensity**2) + phase.astype(">i4").tobytes())


@pytest.mark.few(1)
@pytest.mark.parametrize("suffix", [".dat", ".txt", ".csv", ".xyz", ".asc", ".any"])
def test_files_of_instruments_are_known_by_their_content(tmp_path: Path, suffix: str) -> None:
    pytest.importorskip("SurfaceTopography")
    path, phase = tmp_path / f"map{suffix}", np.rint(1e3 * HEIGHT.T).astype(int)
    metropro(path, phase)
    found = read_map(path)
    np.testing.assert_allclose(found.height.T, phase * 0.5 * 6.328e-7 / 32768, rtol=1e-6)
    assert (found.dx, found.dy) == pytest.approx((0.5e-6, 0.5e-6), rel=1e-6)
    metropro(path, phase[:0, :0], intensity=20)
    with pytest.raises(rm.errors.RoughmdrError, match="holds no map of heights, but channel 'Default' with no points"):
        read_map(path)


@pytest.mark.skipif(not SHARED.exists(), reason="the cases are not here")
@pytest.mark.parametrize("name", ["text_header/gwy_m.txt", "text_header/gwy_nm.txt", "xyz_columns/xyz.txt"])
def test_other_files_of_one_map_hold_it(name: str) -> None:
    found, true = read_map(SHARED / name, unit="um" if "xyz" in name else None), read_map(SHARED / "true_map.nc")
    np.testing.assert_allclose(found.height, true.height, atol=1e-12)
    assert (found.dx, found.dy) == pytest.approx((true.dx, true.dy), rel=1e-4)
