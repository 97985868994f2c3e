"""A map in the reports: told by run, its own theory curves, and the table of cutoffs."""

import re
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner, Result
from forms import large
from scenes import scene

import roughmdr as rm
from roughmdr.aggregate.load_separation import load_separation
from roughmdr.batch.plan import make_plan
from roughmdr.cli import main
from roughmdr.ensemble.maps.height_map import HeightMap, MapWaves
from roughmdr.pictures.overlay import overlay_theory
from roughmdr.report.cutoffs import pressure_at
from roughmdr.scene import read
from roughmdr.spectrum import SelfAffine

SHARED = Path(__file__).parents[3] / "shared" / "surfaces"
SPACING, POINTS = 1e-6, 512
WAVES = SelfAffine.of(hurst=0.8, long_wave=128e-6, short_wave=12e-6, rms_height=1e-6)


def gaussian(seed: int = 1) -> np.ndarray:
    """A periodic map whose waves have exactly the amplitudes of the spectrum, and random phases."""
    along = 2.0 * np.pi * np.fft.fftfreq(POINTS, SPACING)
    q = np.hypot(along[:, None], along[None, :])
    amplitude = np.sqrt(WAVES(q)) * 2.0 * np.pi / (POINTS * SPACING) * POINTS**2
    white = np.fft.fft2(np.random.default_rng(seed).normal(size=(POINTS, POINTS)))
    return np.asarray(np.fft.ifft2(amplitude * white / np.abs(white)).real)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    at = (np.arange(POINTS) + 0.5) * SPACING
    data = xr.Dataset({"height": (("x", "y"), gaussian())}, coords={"x": at, "y": at}, attrs={"periodic": 1})
    data.to_netcdf("map.nc")
    return tmp_path


def of_map(**changes: object) -> dict[str, object]:
    changes = {"asperities": {"source": "surface", "file": "map.nc"}, "batch": None, "adhesion": None} | changes
    path = {"separation": {"start": "5 um", "stop": "2 um", "steps": 12}}
    output = {"variables": ["force", "contact_area", "contact_fraction", "pressure"]}
    return scene(**{"path": path, "output": output, **changes})


def command(*arguments: str) -> Result:
    return CliRunner().invoke(main, arguments, catch_exceptions=False)


def saved(table: dict[str, object]) -> str:
    import tomli_w

    Path("s.toml").write_text(tomli_w.dumps(table))
    return "s.toml"


@pytest.mark.large
def test_every_command_tells_of_the_map(folder: Path) -> None:
    done = command("run", saved(of_map()), "-o", "out.nc")
    judged = "radii right to about 2 %: the map resolves its summits"
    said = [line[13:] for line in done.stdout.splitlines() if line.startswith("map ")]
    assert said == ["512 um x 512 um, 0.00% undefined; periodic, detrended: mean"]
    for arguments in (["info", "out.nc"], ["plan", "s.toml"], ["generate", "s.toml", "-o", "e.nc"]):
        assert judged in command(*arguments).stdout
    assert judged in done.stdout
    assert judged in xr.open_dataset("out.nc").attrs["map"]
    swept = rm.run(of_map(sweep={"asperities.cutoff": ["20 um", "40 um"]}))
    assert swept.attrs["map"].count("(in 1 of 2 cells)") > 4
    assert "map" not in rm.run(scene()).attrs


def test_moments_and_spectrum_of_a_map_are_those_that_it_was_made_from(folder: Path) -> None:
    height = gaussian()
    for periodic in (True, False):
        found = MapWaves.of(HeightMap(height.copy(), SPACING, SPACING, periodic), None)
        rtol = 0.1 if periodic else 0.15  # differences over 12 spacings a wave, and a tapered part of a surface
        np.testing.assert_allclose(found.moments, WAVES.moments, rtol=rtol)
        assert found.spectrum is not None
        assert found.spectrum.rms_slope == pytest.approx(WAVES.rms_slope, rel=0.002 if periodic else 0.1)
        assert found.mean == pytest.approx(0.0, abs=1e-15)
        pressures = np.array([1e-4, 1e-3, 1e-2]) * 1e9
        gaps, right = (
            rm.theory.persson_separation(pressure=pressures, spectrum=spectrum, effective_modulus=1e9)
            for spectrum in (found.spectrum, WAVES)
        )
        np.testing.assert_allclose(gaps, right, rtol=0.05 if periodic else 0.2)
    height[3, 5] = np.nan
    assert MapWaves.of(HeightMap(height, SPACING, SPACING), None).spectrum is None


def test_moments_of_a_map_are_the_same_in_blocks_and_of_an_isotropic_surface(monkeypatch: pytest.MonkeyPatch) -> None:
    from roughmdr.ensemble.maps import height_map

    for periodic in (True, False):
        rough = HeightMap(np.random.default_rng(1).normal(size=(40, 30)), 0.5, 0.7, periodic)
        whole = MapWaves.of(rough, None).moments
        assert whole.alpha > 1.5
        with monkeypatch.context() as patched:
            patched.setattr(height_map, "BLOCK_SIZE", 70)
            np.testing.assert_allclose(MapWaves.of(rough, None).moments, whole, rtol=1e-12)


@pytest.mark.large
def test_theories_of_a_map_are_those_of_its_moments(folder: Path) -> None:
    plan = make_plan(read(of_map()))
    found = overlay_theory(plan, ["pressure", "contact_fraction"])
    lines = {(line.label, line.variable): line.values for line in found.lines}
    cell = plan.cells[0]
    waves, modulus, h = cell.scene.asperities.waves, cell.scene.effective_modulus, cell.path.separation
    bush = rm.theory.bush_gibson_thomas(separation=h, effective_modulus=modulus, **waves.moments._asdict())
    np.testing.assert_allclose(lines["bush_gibson_thomas", "pressure"], bush, rtol=1e-9)
    persson = lines["persson_separation", "pressure"]
    gaps = rm.theory.persson_separation(pressure=persson, spectrum=waves.spectrum, effective_modulus=modulus)
    np.testing.assert_allclose(gaps, h, rtol=1e-9)
    # McCool's summits: equal ones in place of those of Bush, Gibson and Thomas, alike up to some tens of per cent.
    assert np.all(np.abs(lines["greenwood_williamson", "pressure"] / bush - 1.0) < 0.3)
    assert {line.label for line in found.lines} >= {"greenwood_elliptic", "persson_contact_fraction"}
    for name in ("bush_gibson_thomas", "greenwood_williamson"):
        (remark,) = (text for text in found.remarks if name in text.partition(":")[0].split(", "))
        assert f"m0 = {waves.moments.m0:.3g} m2" in remark
        assert "m4, and so radii and number of summits, is that of its shortest waves, 2 um" in remark


@pytest.mark.large
def test_theories_and_the_summits_of_a_gaussian_map_agree(folder: Path) -> None:
    """The force on the summits of one map, near that of the law of all maps with its moments."""
    result = rm.run(of_map(path={"separation": ["2 um", "1.5 um"]}))
    plan = make_plan(read(of_map(path={"separation": ["2 um", "1.5 um"]})))
    lines = {line.label: line.values for line in overlay_theory(plan, ["pressure"]).lines}
    np.testing.assert_allclose(lines["greenwood_elliptic"], result.pressure.values.ravel(), rtol=0.3)


def test_a_map_with_gaps_has_moments_and_no_spectrum(folder: Path) -> None:
    height = gaussian()
    height[5:9, 7] = np.nan
    np.savez("gaps.npz", height=height, size=POINTS * SPACING)
    plan = make_plan(read(of_map(asperities={"source": "surface", "file": "gaps.npz", "detrend": "none"})))
    found = overlay_theory(plan, ["pressure"])
    assert "persson_separation: not drawn: the map has undefined points, and so no spectrum" in found.remarks
    assert "bush_gibson_thomas" in {line.label for line in found.lines}


@pytest.mark.large
@pytest.mark.parametrize("adhesion", [None, large({"model": "jkr", "work": 1e-3})])
def test_the_table_of_cutoffs(folder: Path, adhesion: dict[str, object] | None) -> None:
    table = of_map(adhesion=adhesion)
    done = command("generate", saved(table), "--cutoffs", "20 um,0.04 mm")
    assert done.exit_code == 0
    head, _, *rows = (line.split("  ") for line in done.stdout.splitlines()[:5])
    assert [next(filter(None, map(str.strip, row))) for row in (head, *rows)] == ["cutoff", "none", "20 um", "40 um"]
    section = read(table).asperities
    law = load_separation(
        rm.generate({**table["asperities"], "cutoff": "20 um"}, seed=0),
        separation=np.linspace(6e-6, -1e-6, 30_001),
        effective_modulus=read(table).effective_modulus,
        work=0.0 if adhesion is None else 1e-3,
        variables=["contact_fraction", "pressure"],
    )
    for fraction in (0.01, 0.02, 0.05):
        cut = type(section).model_validate({**table["asperities"], "file": str(section.file), "cutoff": 20e-6})
        found = pressure_at(read(table), cut.asperities, fraction)
        beyond = int(np.argmax(law.contact_fraction.values > fraction))
        assert found == pytest.approx(float(law.pressure[beyond]), rel=2e-3)


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("table", "cutoffs", "says"),
    [
        (scene(), "1 um", "--cutoffs: is for source 'surface'; asperities.source is 'random'"),
        (of_map(), "1 um", "cutoff 1e-06 m must lie between two spacings"),
        (of_map(), "1 Pa", "'Pa' is a unit of Pa"),
        (of_map(), "-1 um", "-1e-06 m must be above 0"),
        (of_map(), "", "--cutoffs ''"),
    ],
)
def test_cutoffs_that_are_refused(folder: Path, table: dict[str, object], cutoffs: str, says: str) -> None:
    done = command("generate", saved(table), f"--cutoffs={cutoffs}")
    assert done.exit_code == 2
    assert says in done.output
    assert done.exception is None or isinstance(done.exception, SystemExit)


@pytest.mark.large
def test_without_cutoffs_an_output_is_needed_and_with_them_it_may_be_given(folder: Path) -> None:
    done = command("generate", saved(of_map()))
    assert done.exit_code == 2
    assert "Missing option '-o' / '--output'" in done.output
    assert command("generate", "s.toml", "-o", "e.nc", "--cutoffs", "20 um").exit_code == 0
    assert Path("e.nc").exists()


@pytest.mark.large
@pytest.mark.skipif(not SHARED.exists(), reason="the measured surfaces are not here")
@pytest.mark.parametrize(("name", "cutoff"), [("optical.nc", "1.5 um"), ("afm_film.di", "2 nm")])
def test_the_measured_surfaces(tmp_path: Path, name: str, cutoff: str, monkeypatch: pytest.MonkeyPatch) -> None:
    if name.endswith(".di"):
        pytest.importorskip("SurfaceTopography")
    monkeypatch.chdir(tmp_path)
    path = {"separation": {"start": "4 sigma", "stop": "2 sigma", "steps": 5}}
    table = of_map(asperities={"source": "surface", "file": str(SHARED / name)}, path=path)
    assert "radii uncertain by" in command("run", saved(table), "-o", "out.nc").stdout
    assert "greenwood_elliptic: drawn; moments" in command("plot", "out.nc", "-o", "a.png", "--with-theory").stdout
    rows = command("generate", "s.toml", "--cutoffs", cutoff).stdout.splitlines()[2:4]
    uncut, cut = ([float(text) for text in re.findall(r"([\d.]+) [kM]Pa", row)] for row in rows)
    assert len(uncut) == 3
    assert all(lower < pressure for lower, pressure in zip(cut, uncut, strict=True))
