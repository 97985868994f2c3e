"""Height maps in files: every format gives the same asperities, and invalid maps are refused."""

import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import xarray as xr

import roughmdr as rm

approx = partial(pytest.approx, abs=0.0)
SHARED = Path(__file__).parents[3] / "shared" / "surfaces"
NX, NY = 20, 30
SIZE = ["10 um", "30 um"]


def bumps() -> np.ndarray:
    return 1e-7 * np.random.default_rng(3).normal(size=(NX, NY))


def netcdf(path: Path, height: np.ndarray, units: str | None = None, power: float = 1.0, **attrs: object) -> None:
    x, y = ((np.arange(NX) + 0.5) * 0.5e-6) ** power, (np.arange(NY) + 0.5) * 1e-6
    own = {} if units is None else {"units": units}
    xr.Dataset({"height": (("x", "y"), height, own)}, coords={"x": x, "y": y}, attrs=attrs).to_netcdf(path)


def text(delimiter: str, encoding: str = "utf-8", header: str = "") -> Callable[[Path, np.ndarray], None]:
    def write(path: Path, height: np.ndarray) -> None:
        np.savetxt(path, height, fmt="%.17g", delimiter=delimiter, encoding=encoding, header=header)

    return write


def renamed(save: Callable[[Path, np.ndarray], None], suffix: str) -> Callable[[Path, np.ndarray], None]:
    """Write a file of one kind under the name of another."""

    def write(path: Path, height: np.ndarray) -> None:
        save(path.with_name(f"other{suffix}"), height)
        path.with_name(f"other{suffix}").rename(path)

    return write


def generate(path: Path, **keys: object) -> xr.Dataset:
    return rm.generate({"source": "surface", "file": str(path), **keys}, seed=0)


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("name", "write"),
    [
        ("map.npy", np.save),
        ("map", renamed(np.save, ".npy")),
        ("map.npy", lambda path, height: np.save(path, np.asfortranarray(height.astype(">f8")))),
        ("map.npz", lambda path, height: np.savez(path, anything=height)),
        ("map.npz", lambda path, height: np.savez_compressed(path, x=np.arange(4), height=height)),
        ("map.txt", text(" ")),
        ("map.txt", text(" ", header="measured on 3 May, 4, 5 um")),
        ("map.csv", text(",")),
        ("map.csv", text(", ", encoding="utf-8-sig")),
        ("map.CSV", text(";")),
        ("map.tsv", text("\t")),
        ("map.dat", text("   ")),
    ],
)
def test_every_format_gives_the_same_asperities(tmp_path: Path, name: str, write: Callable[..., None]) -> None:
    height = bumps()
    height[4, 5:8] = np.nan
    netcdf(tmp_path / "map.nc", height)
    expected = generate(tmp_path / "map.nc")
    write(tmp_path / name, height)
    found = generate(tmp_path / name, size=SIZE)
    xr.testing.assert_allclose(found, expected, rtol=1e-12)
    assert found.attrs.pop("warnings").replace(f"{name}:", "map.nc:") == expected.attrs.pop("warnings")
    rows_along = found.attrs.pop("rows_along")
    assert (found.attrs.pop("shape"), found.attrs.pop("detrend")) == ("paraboloid", "quadratic")
    assert found.attrs == approx({key: expected.attrs[key] for key in found.attrs}, rel=1e-12)
    assert found.attrs["undefined_share"] == 3 / 600
    assert rows_along == "y"


def test_heights_and_sides_in_any_unit(tmp_path: Path) -> None:
    np.save(tmp_path / "m.npy", bumps())
    np.save(tmp_path / "nm.npy", bumps() * 1e9)
    metres = generate(tmp_path / "m.npy", size=[1e-5, 3e-5])
    nano = generate(tmp_path / "nm.npy", size=("0.01 mm", "30 um"), unit="nm")
    xr.testing.assert_allclose(nano, metres, rtol=1e-12)
    assert (metres.x.max(), metres.y.max()) < (1e-5, 3e-5)
    assert metres.attrs["patch_y"] == approx(3e-5, rel=1e-12)
    np.save(tmp_path / "square.npy", bumps()[:, :NX])
    assert generate(tmp_path / "square.npy", size="1 um").attrs["nominal_area"] == approx(1e-12, rel=1e-12)


@pytest.mark.parametrize("size", [[1e-5, 3e-5], np.array([[1e-5, 3e-5]])])
@pytest.mark.parametrize("name", ["height", "z"])
def test_a_size_beside_the_heights_is_that_of_the_map(tmp_path: Path, size: object, name: str) -> None:
    np.savez(tmp_path / "with.npz", **{name: bumps()}, size=size)
    np.savez(tmp_path / "map.npz", **{name: bumps()})
    found = generate(tmp_path / "with.npz")
    xr.testing.assert_equal(found, generate(tmp_path / "map.npz", size=[1e-5, 3e-5]))
    np.savez(tmp_path / "square.npz", height=bumps()[:, :NX], size=1e-5)
    square = generate(tmp_path / "square.npz")
    assert square.attrs["patch_x"] == square.attrs["patch_y"] == approx(1e-5, rel=1e-12)
    assert generate(tmp_path / "with.npz", channel=name).identical(found)


def test_the_size_of_a_scene_may_be_a_list_of_numbers(tmp_path: Path) -> None:
    np.savez(tmp_path / "map.npz", height=bumps())
    (tmp_path / "s.toml").write_text(
        'title = "t"\nmaterial.effective_modulus = 1e9\n'
        'asperities = { source = "surface", file = "map.npz", size = [1e-5, 3e-5] }\n'
        "path.separation = [2e-7, 1e-7]\n"
    )
    section = rm.scene.read(tmp_path / "s.toml").asperities
    assert section.nominal_area == approx(3e-10, rel=1e-12)


def test_fill_values_are_undefined(tmp_path: Path) -> None:
    netcdf(tmp_path / "nan.nc", np.where(abs(bumps()) > 1.5e-7, np.nan, bumps()))
    netcdf(tmp_path / "inf.nc", np.where(abs(bumps()) > 1.5e-7, np.inf * bumps(), bumps()))
    with xr.open_dataset(tmp_path / "nan.nc") as data:
        data.to_netcdf(tmp_path / "fill.nc", encoding={"height": {"_FillValue": -9999.0}})
    for other in ("fill.nc", "inf.nc"):
        xr.testing.assert_equal(generate(tmp_path / other), generate(tmp_path / "nan.nc"))


def test_another_variable_and_its_unit(tmp_path: Path) -> None:
    netcdf(tmp_path / "map.nc", bumps())
    with xr.open_dataset(tmp_path / "map.nc") as data:
        (data.rename(height="z") * 1e6).assign(height=data.height + 1.0).to_netcdf(tmp_path / "two.nc")
    found = generate(tmp_path / "two.nc", channel="z", unit="um")
    xr.testing.assert_allclose(found, generate(tmp_path / "map.nc"), rtol=1e-12)


@pytest.mark.parametrize("periodic", [False, True])
def test_what_surface_topography_writes_as_netcdf(tmp_path: Path, *, periodic: bool) -> None:
    """Its heights, its attribute ``unit`` and its mark of a periodic map are understood."""
    topography = pytest.importorskip("SurfaceTopography").Topography
    topography(1e6 * bumps(), (10.0, 30.0), unit="um", periodic=periodic).to_netcdf(str(tmp_path / "theirs.nc"))
    netcdf(tmp_path / "ours.nc", bumps(), periodic=int(periodic))
    theirs, ours = (generate(tmp_path / name) for name in ("theirs.nc", "ours.nc"))
    assert theirs.sizes == ours.sizes
    for name in ("height", "radius", "x", "y"):
        np.testing.assert_allclose(theirs[name], ours[name], rtol=1e-9, atol=1e-18)
    assert theirs.attrs["patch_x"] == approx(1e-5, rel=1e-12)


def test_rounding_in_single_precision_is_not_roughness(tmp_path: Path) -> None:
    plane = np.add.outer(np.arange(60.0) / 7.0, np.arange(60.0) / 11.0) * 1e-6
    np.save(tmp_path / "single.npy", plane.astype(np.float32))
    with pytest.raises(rm.SceneError, match="has no summit"):
        generate(tmp_path / "single.npy", size="1 mm")


def saved(value: Any) -> Callable[[Path], None]:
    return lambda path: np.save(path, value, allow_pickle=True)


def written(content: str | bytes) -> Callable[[Path], None]:
    return lambda path: path.write_bytes(content if isinstance(content, bytes) else content.encode()) and None


def zipped(**arrays: Any) -> Callable[[Path], None]:
    return lambda path: np.savez(path, **arrays)


GOOD = saved(bumps())
REFUSED: list[tuple[str, Callable[[Path], object], dict[str, object], str]] = [
    ("a.npy", saved(np.full((9, 9), np.nan)), {"size": "9 um"}, "all its 81 heights are undefined"),
    ("a.npy", saved(np.full((9, 9), np.inf)), {"size": "9 um"}, "all its 81 heights are undefined"),
    ("a.npy", saved(np.zeros((1, 9))), {}, "1 x 9 points; it needs at least 3 x 3"),
    ("a.npy", saved(np.zeros((9, 9))), {"size": "9 um"}, "no summit: with detrend 'quadratic' it is flat"),
    (
        "a.npy",
        saved(np.full((9, 9), 0.1)),
        {"periodic": True, "size": "9 um"},
        "no summit: with detrend 'mean' it is flat",
    ),
    ("a.npy", saved(np.zeros((9, 9, 9))), {}, "9 x 9 x 9 points; it needs at least 3 x 3, over two dimensions"),
    ("a.npy", saved(np.float64(1.0)), {}, "no points"),
    ("a.npy", saved(np.eye(9) * 1j), {}, "type complex128; they must be real numbers"),
    ("a.npy", saved(np.eye(9) > 0), {}, "type bool; they must be real numbers"),
    ("a.npy", saved(np.full((9, 9), "a")), {}, "type <U1; they must be real numbers"),
    ("a.npy", saved(np.full((9, 9), None)), {}, "Object arrays cannot be loaded"),
    ("a.npz", zipped(height=np.full((9, 9), None)), {}, "Object arrays cannot be loaded"),
    ("a.npy", written(b"\x80\x04N."), {}, "cannot be read by NumPy"),
    ("a.npy", written(b"\x93NUMPY\x01\x00"), {}, "cannot be read by NumPy"),
    ("a.npy", written(b""), {}, "a.npy: is empty"),
    ("a.txt", written(b""), {}, "a.txt: is empty"),
    ("a.npz", zipped(a=np.eye(9), b=np.eye(9)), {}, r"no array 'height', but \['a', 'b'\]; name one as channel"),
    ("a.npz", zipped(a=np.eye(9), size=[1e-5, 1e-5]), {}, "the map is 10 um x 10 um, and size differs; leave it out"),
    ("a.npz", zipped(a=bumps(), size=1e-5), {"size": None}, "20 x 30 points, and one size is that of a square"),
    ("a.npz", zipped(a=np.eye(9), size=[1e-5, -1e-5]), {"size": None}, "'size', the size of the map: must be above 0"),
    ("a.npz", zipped(a=np.eye(9), size=[9.0, 9.0, 1.0]), {"size": None}, "the size of the map: must be one side"),
    ("a.npz", zipped(a=np.eye(9), c=np.eye(9), size=1e-5), {}, "no array 'height'"),
    ("a.npz", zipped(a=np.eye(9)), {"channel": "c"}, r"no array 'c', but \['a'\]"),
    ("a.npz", zipped(), {}, "no array 'height'"),
    ("a.npz", lambda path: renamed(np.save, ".npy")(path, np.eye(9)), {}, "not an .npz file"),
    ("a.npy", lambda path: renamed(np.savez, ".npz")(path, np.eye(9)), {}, "not an .npy file"),
    ("a.txt", written("1 2 3\n1 2\n1 2 3\n"), {}, "line 2 has 2 numbers, but line 1 has 3"),
    ("a.csv", written("1,2,3\n1,x,3\n1,2,3\n"), {}, "line 2, column 2: 'x' is no number"),
    ("a.csv", written("1,07,3,12\n1,25,3,50\n"), {}, "line 1, column 2: '07' follows a comma that may be a decimal"),
    ("a.txt", written("1.5;2;3\n1,5;2;3\n1.5,5;2;3\n"), {}, "line 3: has points and commas"),
    ("a.txt", written("1 2 3 4x\n1 2 3 4\n1 2 3 4\n1 2 3 4\n"), {}, "line 1, column 4: '4x' is no number"),
    ("a.txt", written("# only words\n\n"), {}, "holds no numbers"),
    ("a.txt", written(b"\x00\x01\xff"), {}, "in no format that SurfaceTopography can read"),
    ("a.txt", written("1 2 3\n1 2 3\n1 2 3\n"), {"channel": "z"}, "leave out channel = 'z'"),
    ("a.npy", GOOD, {"size": None}, "does not say how large the map is; give size"),
    ("a.npy", GOOD, {"size": "1 um"}, "20 x 30 points, and one size is that of a square"),
    ("a.npy", GOOD, {"size": 0.0}, "asperities.size = 0.0: must be above 0"),
    ("a.npy", GOOD, {"size": ["1 um", "-2 um"]}, "must be above 0"),
    ("a.npy", GOOD, {"size": ["1 um"]}, "must be one side"),
    ("a.npy", GOOD, {"size": "3 Pa"}, "'Pa' is a unit of Pa; expected a unit of m"),
    ("a.npy", GOOD, {"unit": "Pa"}, "asperities.unit = 'Pa': 'Pa' is a unit of Pa; expected a unit of m"),
    ("a.npy", GOOD, {"unit": "furlong"}, "unknown unit 'furlong'"),
    ("a.npy", GOOD, {"detrend": "cubic"}, "asperities.detrend = 'cubic': not available"),
    ("a.npy", GOOD, {"periodic": 1}, "asperities.periodic = 1"),
    ("a.npy", GOOD, {"periodic": True, "detrend": "plane"}, "a periodic map has no trend to remove"),
    ("a.npy", GOOD, {"cutoff": "1.9 um"}, "cutoff 1.9e-06 m must lie between two spacings, 2e-06 m"),
    (
        "a.npy",
        GOOD,
        {"cutoff": "10.1 um"},
        "must lie between two spacings, 2e-06 m, and the map's shorter side, 1e-05 m",
    ),
    (
        "a.nc",
        lambda path: netcdf(path, bumps()),
        {"size": ["30 um", "10 um"]},
        "says itself that the map is 10 um x 30 um",
    ),
    (
        "a.nc",
        lambda path: netcdf(path, bumps(), periodic="perhaps"),
        {"size": None},
        "periodic is 'perhaps'; it must be",
    ),
    ("a.nc", lambda path: netcdf(path, bumps()), {"size": None, "channel": "z"}, "must hold a variable z"),
    ("a.nc", lambda path: netcdf(path, bumps(), "Pa"), {"size": None}, "'Pa' is a unit of Pa"),
    ("a.nc", lambda path: netcdf(path, bumps(), power=2.0), {"size": None}, "coordinate x is not evenly spaced"),
    ("a.nc", written("not netCDF"), {"size": None}, "not a netCDF file"),
    ("a.npy", lambda path: path.mkdir(), {}, "is a folder; expected a file"),
    ("b.npy/../a.npy", GOOD, {}, "no such file"),
]


@pytest.mark.few(2)
@pytest.mark.parametrize(("name", "make", "keys", "says"), REFUSED)
def test_invalid_maps_are_refused(
    tmp_path: Path, name: str, make: Callable[[Path], object], keys: dict[str, object], says: str
) -> None:
    make(tmp_path / name.rpartition("/")[2])
    asked = {"size": SIZE, **keys}
    with pytest.raises(rm.SceneError, match=says):
        generate(tmp_path / name, **{key: value for key, value in asked.items() if value is not None})


def test_a_unit_and_a_size_are_not_contradicted(tmp_path: Path) -> None:
    netcdf(tmp_path / "b.nc", bumps(), "m")
    with pytest.raises(rm.SceneError, match="says itself that heights are in m; leave out unit = 'nm'"):
        generate(tmp_path / "b.nc", unit="nm")
    found = generate(tmp_path / "b.nc")
    assert generate(tmp_path / "b.nc", unit="m", size=SIZE).identical(found)
    netcdf(tmp_path / "nm.nc", 1e9 * bumps(), "nm")
    xr.testing.assert_allclose(generate(tmp_path / "nm.nc"), found, rtol=1e-12)


def test_a_missing_package_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "SurfaceTopography.IO", None)
    (tmp_path / "scan.spm").write_bytes(b"\\*File list\r\n")
    with pytest.raises(rm.SceneError, match=r"scan.spm: .spm is left to SurfaceTopography.*install -e '\.\[surface\]'"):
        generate(tmp_path / "scan.spm")


class Instrument(SimpleNamespace):
    """A file as SurfaceTopography reads it, with one channel."""

    def __init__(self, **changes: object) -> None:
        known = {"name": "Z", "dim": 2, "data_kind": SimpleNamespace(value="height"), "physical_sizes": (100.0, 300.0)}
        heights = np.ma.masked_greater(bumps() * 1e10, 1500.0)
        data = SimpleNamespace(unit="A", is_periodic=True, heights=lambda: heights)
        data.__dict__.update({key: value for key, value in changes.items() if key not in known})
        channel = SimpleNamespace(**{**known, **changes}, topography=lambda **_: data)
        super().__init__(channels=[channel], default_channel=channel)

    def __enter__(self) -> "Instrument":
        return self

    def __exit__(self, *_: object) -> None:
        pass


def opened(monkeypatch: pytest.MonkeyPatch, path: Path, instrument: Instrument) -> Path:
    path.write_text("of an instrument")
    module = SimpleNamespace(open_topography=lambda *_: instrument)
    monkeypatch.setitem(sys.modules, "SurfaceTopography", SimpleNamespace(IO=module))
    monkeypatch.setitem(sys.modules, "SurfaceTopography.IO", module)
    return path


def test_an_instrument_file_is_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """In angstroms, periodic, masked where undefined."""
    found = generate(opened(monkeypatch, tmp_path / "a.spm", Instrument()))
    np.save(tmp_path / "a.npy", np.where(bumps() > 1.5e-7, np.nan, bumps()))
    expected = generate(tmp_path / "a.npy", size=["10 nm", "30 nm"], periodic=True)
    xr.testing.assert_allclose(found, expected, rtol=1e-12)
    assert found.attrs["undefined_share"] == expected.attrs["undefined_share"] > 0.0


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"dim": 1}, "holds no map of heights, but channel 'Z' with a line"),
        ({"data_kind": SimpleNamespace(value="phase")}, "holds no map of heights, but channel 'Z' with phase"),
        ({"unit": None}, "does not say in which unit it is"),
        ({"unit": "mV"}, "unknown unit 'mV'"),
        ({"physical_sizes": None}, "give size"),
    ],
)
def test_an_incomplete_instrument_file_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, changes: dict[str, object], says: str
) -> None:
    with pytest.raises(rm.SceneError, match=f"a.spm: .*{says}"):
        generate(opened(monkeypatch, tmp_path / "a.spm", Instrument(**changes)))


def test_files_of_instruments_without_a_size(tmp_path: Path) -> None:
    pytest.importorskip("SurfaceTopography")
    text(" ")(tmp_path / "map.asc", bumps().T * 1e9)  # instruments write a line of the scan as a row
    np.save(tmp_path / "map.npy", bumps())
    found = generate(tmp_path / "map.asc", size=SIZE, unit="nm")
    xr.testing.assert_allclose(found, generate(tmp_path / "map.npy", size=SIZE), rtol=1e-9)
    with pytest.raises(rm.SceneError, match="give size"):
        generate(tmp_path / "map.asc")
    (tmp_path / "scan.spm").write_text("no such thing")
    with pytest.raises(rm.SceneError, match=r"scan.spm: in no format that SurfaceTopography can read"):
        generate(tmp_path / "scan.spm")


@pytest.mark.skipif(not (SHARED / "afm_film.di").exists(), reason="the measured surface is not here")
def test_an_atomic_force_scan() -> None:
    pytest.importorskip("SurfaceTopography")
    with pytest.warns(rm.errors.LimitWarning, match=r"^afm_film.di: radii uncertain by about 48 %: the map does not"):
        found = generate(SHARED / "afm_film.di")
    assert found.sizes["asperity"] == approx(13_260, rel=0.01)
    assert (found.attrs["patch_x"], found.attrs["patch_y"]) == approx((3e-7, 3e-7), rel=1e-9)
    assert found.attrs["rms_height"] == approx(8.86e-9, rel=0.01)
    assert found.attrs["rms_slope"] == approx(1.72, rel=0.01)
    assert found.attrs["misfit"] > 0.4
    assert generate(SHARED / "afm_film.di", channel="Height").identical(found)
    for keys, says in (
        ({"channel": "Width"}, r"no channel 'Width', but \['Height', 'Deflection'\]"),
        ({"size": "310 nm"}, "300 nm x 300 nm, and size differs; leave it out"),
        ({"unit": "um"}, "heights are in nm; leave out unit"),
    ):
        with pytest.raises(rm.SceneError, match=says):
            generate(SHARED / "afm_film.di", **keys)
