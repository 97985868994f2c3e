"""Paths that begin and end where no asperity touches, and stops at a contact fraction or a pressure."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w
import xarray as xr
from forms import large
from scenes import ASPERITIES, ensemble, scene

import roughmdr as rm
from roughmdr.batch.paths import clear_start
from roughmdr.errors import SceneError, TooMuchContact
from roughmdr.loading.first_reached import first_reached
from roughmdr.numerics.arguments import Floats
from roughmdr.scene import read
from roughmdr.schema.units import format_quantity

JKR = {"model": "jkr", "work": "50 mJ/m^2"}
DUGDALE = {"model": "dugdale", "work": "50 mJ/m^2", "strength": "0.5 MPa"}
VARIABLES = {"variables": ["force", "contact_count", "contact_fraction", "pressure"]}
NORMAL = {"distribution": "normal", "std": "1 um"}
SHAPES: dict[str, dict[str, Any]] = {
    "paraboloid": {"radius": {"distribution": "lognormal", "mean": "50 um", "std": "25 um"}},
    "cone": {"slope": {"distribution": "uniform", "loc": 0.05, "scale": 0.25}},
    "power_law": {
        "exponent": {"distribution": "uniform", "loc": 1.2, "scale": 5},
        "width": "20 um",
        "rise": {"distribution": "lognormal", "mean": "2 um", "std": "0.5 um"},
    },
    "sphere": {"radius": {"distribution": "normal", "mean": "50 um", "std": "5 um", "min": "20 um"}},
    "flat_punch": {"radius": {"distribution": "lognormal", "mean": "2 um", "std": "1 um"}},
    "truncated_cone": {"slope": 0.1, "flat_radius": {"distribution": "lognormal", "mean": "2 um", "std": "1 um"}},
    "truncated_paraboloid": {"radius": "50 um", "flat_radius": {"distribution": "uniform", "loc": 1e-6, "scale": 3e-6}},
    "rounded_cone": {"slope": 0.1, "blend_radius": {"distribution": "lognormal", "mean": "2 um", "std": "1 um"}},
    "capped_paraboloid": {"radius": "50 um", "cap_radius": "90 um", "blend_radius": "3 um"},
    "rounded_punch": {"flat_radius": "2 um", "edge_radius": {"distribution": "lognormal", "mean": 2e-5, "std": 1e-5}},
    "power_series": {"terms": {"2": 1e4, "4": 1e14}},
    "tabulated": {"r": [0.0, 5e-6, 1e-5, 2e-5], "f": [0.0, 2e-7, 1e-6, 5e-6]},
}


def clear(stop: Any = "0 sigma", steps: int = 30, **changes: Any) -> dict[str, Any]:
    """A scene that loads from where it is clear to ``stop``, and unloads."""
    path = {"separation": {"stop": stop, "steps": steps}, "unload": True}
    return scene(**{"path": path, "output": VARIABLES, **changes})


def ends(result: xr.Dataset) -> xr.Dataset:
    return result.isel(step=[0, -1])


@pytest.mark.few(1)
@pytest.mark.parametrize("adhesion", [None, JKR, pytest.param(DUGDALE, marks=pytest.mark.large)], ids=str)
@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.filterwarnings("ignore")
def test_nothing_touches_or_attracts_at_both_ends(shape: str, adhesion: Any) -> None:
    asperities = {"source": "random", "shape": shape, "count": 200, "patch": "1 mm", "height": NORMAL, **SHAPES[shape]}
    result = rm.run(clear(adhesion=adhesion, asperities=asperities))
    assert (ends(result).contact_count == 0.0).all()
    assert (ends(result).force == 0.0).all()
    assert (result.contact_count.max("step") > 0.0).all()


@pytest.mark.few(1)
@pytest.mark.parametrize("adhesion", [None, JKR, large(DUGDALE), large({**DUGDALE, "model": "auto"})], ids=str)
@pytest.mark.parametrize(
    "height",
    [
        "1 um",
        {"distribution": "uniform", "loc": "-1 um", "scale": "2 um"},
        {"distribution": "normal", "std": "1 um", "max": "2 um"},
        {"distribution": "exponential", "std": "1 um", "mean": 0},
        {"distribution": "gumbel_r", "std": "0.1 um", "mean": "0.5 um"},
    ],
    ids=str,
)
def test_heights_of_any_distribution(height: Any, adhesion: Any) -> None:
    second = {"share": 0.2, "height": {"distribution": "normal", "mean": "1 um", "std": "0.3 um"}, "radius": "200 um"}
    for more in (
        {},
        {"second": second},
        {"count": None, "density": "1000 /mm^2", "placement": "hexagonal", "vacancies": True},
    ):
        asperities = {
            key: value for key, value in {**ASPERITIES, "height": height, **more}.items() if value is not None
        }
        result = rm.run(clear("0 um", adhesion=adhesion, asperities=asperities, batch={"realizations": 8}))
        assert (ends(result).contact_count == 0.0).all()
        assert (ends(result).force == 0.0).all()


def test_the_clear_start_is_the_quantile_of_all_realisations() -> None:
    from scipy.stats import norm

    start = clear_start(read(clear(adhesion=None)))
    chance = 1.0 - norm.cdf(start / 1e-6) ** (1000 * 100)  # all that a float can tell; 1e-3 of 1e7 asperities
    assert 10_000 * 1000 * norm.sf(start / 1e-6) == pytest.approx(-math.log1p(-1e-3), rel=1e-9)
    assert chance < 1e-3


@pytest.mark.large
@pytest.mark.parametrize("alpha", [1.6, 5.0, 1e3])
def test_the_clear_start_of_a_gaussian_surface_is_exceeded_by_its_chance(alpha: float) -> None:
    from scipy.integrate import quad

    moments = {"m0": 1e-12, "m2": 1e-3, "m4": alpha * 1e-6 / 1e-12}
    table = {"source": "nayak", "patch": "0.2 mm", **moments}
    source = read(clear(adhesion=None, asperities=table)).asperities
    for chance in (1e-12, 1e-3, 0.5):
        top = float(source.extremes(chance).height.max())

        def density(z: float) -> float:
            """The density of all summit heights, from that of Nayak's joint density over the products of curvatures."""
            from roughmdr.ensemble.gaussian.summit_distribution import product_density

            heights = source.summits.height_density
            inner = quad(lambda y: 2 * y * product_density(y * y) * heights(z, y * y), 0.0, 9.0, epsrel=1e-9, limit=200)
            return float(inner[0])

        above = quad(density, top, top + 3e-6, epsrel=1e-7)[0] + quad(density, top + 3e-6, 14e-6, epsabs=0.0)[0]
        assert above == pytest.approx(chance, rel=1e-5)


@pytest.mark.few(1)
@pytest.mark.parametrize("adhesion", [JKR, DUGDALE], ids=str)
def test_of_asperities_that_are_not_drawn_the_start_is_exact(tmp_path: Path, adhesion: Any) -> None:
    rng = np.random.default_rng(3)
    z, radius = rng.normal(0.0, 1e-6, 50), rng.uniform(1e-5, 1e-3, 50)
    ensemble(z, radius=radius).to_netcdf(tmp_path / "e.nc")
    table = clear(adhesion=adhesion, asperities={"source": "file", "file": str(tmp_path / "e.nc")}, batch=None)
    start = clear_start(read(table))
    arguments = {"work": 0.05, "modulus": 3e6, "poisson": 0.49}
    if adhesion is DUGDALE:
        arguments |= {"adhesion": "dugdale", "strength": 0.5e6}
    depths = [
        -float(rm.pull_off(rm.Paraboloid(radius=one), control="displacement", **arguments).indentation)
        for one in radius.tolist()
    ]
    last = float(np.max(z + depths))
    assert last < start < last + 1e-8 * max(depths)
    result = rm.run(table)
    assert (ends(result).force == 0.0).all()
    barely = rm.run({**table, "path": {"separation": [start, "0 sigma", last - 1e-6 * max(depths)]}})
    assert barely.contact_count.to_numpy()[0].tolist()[::2] == [0.0, 1.0]


@pytest.mark.large
@pytest.mark.parametrize("adhesion", [None, JKR, large(DUGDALE)], ids=str)
@pytest.mark.parametrize(
    "target", [{"contact_fraction": 0.02}, large({"contact_fraction": 1e-4}), {"pressure": "2 kPa"}]
)
def test_the_stop_is_where_the_expected_law_has_the_target(adhesion: Any, target: dict[str, Any]) -> None:
    from roughmdr.schema.units import quantity

    table = clear(target, adhesion=adhesion)
    result = rm.run({**table, "batch": {"estimator": "expected"}})
    ((name, asked),) = target.items()
    wanted = quantity(asked, "Pa" if name == "pressure" else "1")
    law = result[name].squeeze().to_numpy()
    assert law[29] == pytest.approx(wanted, rel=1e-9)
    assert (law[:29] < wanted).all()
    drawn = rm.run(table)
    np.testing.assert_array_equal(drawn.separation, result.separation)
    assert "stop" in drawn.attrs["path"]
    assert format_quantity(float(drawn.separation[29]), "m") in drawn.attrs["path"]


@pytest.mark.parametrize("share", [0.03, 0.3, 0.55, 0.7])
def test_a_target_is_not_looked_for_far_beyond_it(share: float) -> None:
    """Far beyond most asperities are in contact, which takes long where they feel each other."""
    asked: list[float] = []

    def law(positions: Floats) -> Floats:
        asked.extend(positions.tolist())
        return (1.0 - positions) ** 3

    assert first_reached(law, share**3, 1.0, 1.0, 1e-12, "force") == pytest.approx(1.0 - share, abs=1e-11)
    assert 1.0 - min(asked) <= max(0.5, share + 0.25)


def test_a_target_is_found_beyond_steps_without_a_value() -> None:
    """Too much contact further down leaves them apart from those that have none yet."""

    def law(positions: Floats) -> Floats:
        if (positions < 0.27).any():
            raise TooMuchContact("more contact than patch")
        return np.where(abs(positions - 0.375) < 0.02, math.nan, 1.0 - positions)

    assert first_reached(law, 0.7, 1.0, 1.0, 1e-12, "force") == pytest.approx(0.3, abs=1e-11)


def test_in_other_units_the_path_scales() -> None:
    small = rm.run(clear({"contact_fraction": 0.02}, batch=None))
    height, radius = {"distribution": "normal", "std": "1 mm"}, {**ASPERITIES["radius"], "mean": 0.05, "std": 0.005}
    large = {**ASPERITIES, "patch": "1 m", "height": height, "radius": radius}
    adhesion = {"model": "jkr", "work": "50 J/m^2"}
    scaled = rm.run(clear({"contact_fraction": 0.02}, batch=None, asperities=large, adhesion=adhesion))
    np.testing.assert_allclose(scaled.separation, 1e3 * small.separation, rtol=1e-9)


def test_without_an_expected_law_the_stop_is_that_of_a_stratified_realisation() -> None:
    asperities = {**ASPERITIES, "correlation": {"radius": 1.0}}
    result = rm.run(clear({"contact_fraction": 0.02}, asperities=asperities, adhesion=None))
    drawn = result.contact_fraction[:, 29].to_numpy()
    assert abs(drawn.mean() - 0.02) < 4.0 * drawn.std(ddof=1) / np.sqrt(drawn.size)
    stratified = rm.run(
        clear({"contact_fraction": 0.02}, asperities=asperities, adhesion=None, batch={"estimator": "stratified"})
    )
    assert float(stratified.contact_fraction[0, 29]) == pytest.approx(0.02, rel=1e-9)


def test_of_a_file_loading_jumps_over_the_target(tmp_path: Path) -> None:
    ensemble([0.0, -1e-6, -2e-6], area=1e-8, radius=5e-5).to_netcdf(tmp_path / "e.nc")
    table = clear({"contact_fraction": 1e-2}, asperities={"source": "file", "file": str(tmp_path / "e.nc")}, batch=None)
    result = rm.run(table).isel(realization=0)
    stop = float(result.separation[29])
    assert float(result.contact_fraction[29]) >= 1e-2
    above = rm.run({**table, "path": {"separation": [stop + 1e-15]}})
    assert float(above.contact_fraction[0, 0]) < 1e-2
    (bare := xr.load_dataset(tmp_path / "e.nc")).attrs.pop("nominal_area")
    bare.to_netcdf(tmp_path / "bare.nc")
    with pytest.raises(SceneError, match=r"path\.separation\.stop\.contact_fraction = 0\.01: needs a nominal area"):
        rm.run({**table, "asperities": {"source": "file", "file": str(tmp_path / "bare.nc")}})


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"stop": {}}, "path.separation.stop: takes either contact_fraction or pressure"),
        ({"stop": {"contact_fraction": 0.1, "pressure": 1}}, "stop: takes either contact_fraction or pressure"),
        ({"stop": {"contact_fraction": 0}}, "path.separation.stop.contact_fraction = 0: must be above 0"),
        ({"stop": {"contact_fraction": 1.5}}, "stop.contact_fraction = 1.5: must be at most 1"),
        ({"stop": {"pressure": "-1 MPa"}}, "stop.pressure = '-1 MPa': must be above 0"),
        ({"stop": {"presure": "1 MPa"}}, "stop.presure: unknown key; did you mean 'pressure'?"),
        ({"stop": "clear"}, "path.separation.stop = 'clear': "),
        ({"start": "claer"}, "path.separation.start = 'claer': "),
        ({"stop": "50 sigma"}, "path.separation.stop = 50 um: must be below 6.7"),
        ({"start": "1 sigma", "stop": {"contact_fraction": 0.001}}, "is reached above the start, 1e-06 m"),
    ],
    ids=str,
)
def test_wrong_ends_are_refused_with_their_line(tmp_path: Path, changes: dict[str, Any], says: str) -> None:
    table = clear()
    table["path"]["separation"] |= changes
    (tmp_path / "s.toml").write_text(tomli_w.dumps(table))
    with pytest.raises(SceneError) as caught:
        rm.run(tmp_path / "s.toml")
    assert says in str(caught.value)
    assert str(caught.value).startswith(f"{tmp_path / 's.toml'}:")


@pytest.mark.large
def test_what_cannot_be_is_refused() -> None:
    with pytest.raises(SceneError, match=r"sweep\.path\.separation\.start\[0\] = 'clear': is no number to be swept"):
        rm.run(clear(sweep={"path.separation.start": ["clear", "4 sigma"]}))
    wide = {**ASPERITIES, "height": {"distribution": "cauchy", "scale": "1 um", "loc": 0}}
    with pytest.raises(SceneError, match=r'path\.separation\.start = "clear": .* give it as a separation'):
        rm.run(clear("0 um", asperities=wide))
    punches = {"source": "random", "shape": "flat_punch", "count": 100, "patch": "1 mm", "height": NORMAL}
    with pytest.raises(SceneError, match=r"contact_fraction = 0\.5: is out of reach: the largest contact_fraction"):
        rm.run(clear({"contact_fraction": 0.5}, asperities={**punches, "radius": "5 um"}, adhesion=None))
    with pytest.raises(SceneError, match=r"where adhesion\.work = 0\.05"):
        rm.run(clear("6.8 um", sweep={"adhesion.work": [0.05, 0.2]}))
