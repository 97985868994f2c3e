"""Forces of particles over their distance: what LAMMPS reads is the law, with its energy, loss and detachment."""

import os
import re
import shlex
import subprocess
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from exports import Floats, header_of, of_csv, of_lammps
from scenes import scene
from scipy.integrate import quad

import roughmdr as rm

ERROR = 1e-2
APART = 10e-6  # distance of the centres at zero separation [m]
COMMAND = os.environ.get("ROUGHMDR_LAMMPS", "")
"""Runs LAMMPS, where it is there."""
WIDE = {"separation": {"start": "6 sigma", "stop": "-0.5 sigma", "steps": 180}, "unload": True}


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("particles") / "jkr.nc"
    rm.run(scene(path=WIDE, batch={"estimator": "expected"}), out)
    return out


def exported(file: Path, name: str, **options: Any) -> Path:
    asked = {"to": "lammps", "quantity": "force", "error": ERROR} | options
    rm.export(file, file.parent / name, **asked | ({"distance": APART} if asked["to"] == "lammps" else {}) | options)
    return file.parent / name


def curve(file: Path, branch: str) -> tuple[Floats, Floats]:
    with xr.open_dataset(file) as data:
        there = data.isel(step=np.flatnonzero(data.branch == branch), realization=0)
        return there.separation.to_numpy(), there.force.to_numpy()


def as_lammps(at: Floats, r: Floats, force: Floats) -> Floats:
    """The force between points: F/r is linear in r^2, and beyond the last point there is none."""
    return np.asarray(at * np.interp(at**2, r**2, force / r, right=0.0))


@pytest.mark.few(1)
@pytest.mark.parametrize("branch", ["loading", "unloading"])
def test_what_lammps_reads_is_the_law_at_the_steps_and_between(file: Path, branch: str) -> None:
    r, _, force = of_lammps(exported(file, f"{branch}.table", branch=branch))
    assert np.ptp(np.diff(r**2)) < 1e-9 * np.diff(r**2)[0]
    coarse = curve(file, "loading")[0]
    fine = np.sort(np.concatenate([coarse, 0.5 * (coarse[1:] + coarse[:-1])]))[::-1]
    path = {"separation": fine.tolist(), "unload": True}
    rm.run(scene(path=path, batch={"estimator": "expected"}), file.parent / "fine.nc", resume=False)
    separation, law = curve(file.parent / "fine.nc", branch)
    allowed = ERROR * np.maximum(np.abs(law), 0.1 * np.abs(law).max())
    inside = APART + separation > r[0] * (1.0 + 1e-12)
    assert inside.sum() >= law.size - 1
    assert (np.abs(as_lammps(APART + separation, r, force) - law) <= allowed)[inside].all()


@pytest.mark.parametrize("branch", ["loading", "unloading"])
def test_the_energy_is_the_integral_of_the_force_that_is_read(file: Path, branch: str) -> None:
    r, energy, force = of_lammps(exported(file, "energy.table", branch=branch))
    for first in (0, r.size // 3, r.size - 5):
        parts = (quad(lambda at: float(as_lammps(at, r, force)), *ends, epsabs=0.0)[0] for ends in _cells(r[first:]))
        assert energy[first] == pytest.approx(sum(parts), rel=1e-11, abs=1e-14 * np.abs(energy).max())
    assert energy[-1] == 0.0


def _cells(r: Floats) -> Iterator[tuple[float, float]]:
    return zip(r[:-1].tolist(), r[1:].tolist(), strict=True)


def test_a_table_in_csv_has_the_same_law_over_the_overclosure(file: Path) -> None:
    table = of_csv(exported(file, "law.csv", to="csv", branch="unloading"))
    assert list(table)[:5] == ["overclosure [m]", "force [N]", "energy [N m]", "separation [m]", "standard_error [N]"]
    assert list(table)[5:] == [f"tangent_stiffness{end} [N/m]" for end in ("", "_error", "_standard_error")]
    x, force, energy, separation = table.to_numpy().T[:4]
    np.testing.assert_array_equal(separation, -x)
    work = [np.trapezoid(force[: end + 1], x[: end + 1]) for end in range(x.size)]
    np.testing.assert_allclose(energy, work, rtol=1e-12, atol=1e-14 * np.abs(energy).max())
    h, law = curve(file, "unloading")
    off = np.abs(np.interp(-h, x, force, left=0.0) - law)
    assert (off <= ERROR * np.maximum(np.abs(law), 0.1 * np.abs(law).max())).all()
    assert "static inline double ROUGH_FORCE(" in exported(file, "law.h", to="c", branch="unloading").read_text()
    r, from_near, _ = of_lammps(exported(file, "same.table", branch="unloading"))
    assert np.interp(APART, r, from_near) == pytest.approx(np.interp(0.0, x, energy), abs=ERROR * np.abs(energy).max())


@pytest.mark.few(1)
@pytest.mark.parametrize("branch", ["loading", "unloading"])
def test_the_stiffness_is_that_of_a_finer_path_to_the_stated_error(file: Path, branch: str) -> None:
    table = of_csv(exported(file, "stiff.csv", to="csv", branch=branch, units="um,nN"))
    x, stiffness, error, standard_error = table.to_numpy().T[[0, 5, 6, 7]]
    far, _ = curve(file, "loading")
    fine = {"separation": np.linspace(far[0], far[-1], 20 * (far.size - 1) + 1).tolist(), "unload": True}
    rm.run(scene(path=fine, batch={"estimator": "expected"}), file.parent / "finer.nc", resume=False)
    h, law = curve(file.parent / "finer.nc", branch)
    ordered = np.argsort(-h)
    exact = np.interp(x, -h[ordered] / 1e-6, np.gradient(law[ordered], -h[ordered], edge_order=2)) / 1e-3
    assert (np.abs(stiffness - exact) <= error)[1:].all()  # contact is made, or lost, at the first
    assert np.median(error / np.abs(exact)) < 0.02
    assert np.isnan(standard_error).all()


def test_the_stiffness_of_a_mean_has_its_jumps_and_its_standard_error_within(tmp_path: Path) -> None:
    path = {"separation": {"start": "6 sigma", "stop": "0 sigma", "steps": 60}, "unload": True}
    made = scene(path=path, batch={"realizations": 10}, output={"variables": ["force"]})
    rm.run(made, tmp_path / "ten.nc")
    x, value, error, spread = (
        of_csv(exported(tmp_path / "ten.nc", "ten.csv", to="csv", error=0.1)).to_numpy().T[[0, 5, 6, 7]]
    )
    with xr.open_dataset(tmp_path / "ten.nc") as data:
        on = data.isel(step=np.flatnonzero(data.branch == "loading"))
        at = np.searchsorted(-on.separation.to_numpy(), x)[1:-1]
        slopes = (on.force.values[:, at + 1] - on.force.values[:, at - 1]) / (
            on.separation.values[at - 1] - on.separation.values[at + 1]
        )
        np.testing.assert_allclose(value[1:-1], slopes.mean(axis=0), rtol=1e-9)
        np.testing.assert_allclose(spread[1:-1], slopes.std(axis=0, ddof=1) / 10**0.5, rtol=1e-9)
    expected = scene(path={"separation": {"start": "6 sigma", "stop": "0 sigma", "steps": 600}, "unload": True})
    law = rm.run({**expected, "batch": {"estimator": "expected"}}, tmp_path / "mean.nc")
    h, force = curve(tmp_path / "mean.nc", "loading")
    exact = np.interp(x, -h, np.gradient(force, -h))
    assert law.realization.size == 1
    assert (np.abs(value - exact) <= error + 2.0 * spread).mean() > 0.9


def test_the_header_tells_loss_tension_and_stiffness(file: Path) -> None:
    said = header_of(exported(file, "told.table", branch="unloading"))
    with xr.open_dataset(file) as data:
        lost = data.isel(realization=0).roughmdr.hysteresis()
    told = re.search(r"loss: (\S+) N m to (\S+) m within \S+ \(loading takes (\S+)\), there and back;", said)
    loss, reached, taken = map(float, told.groups())  # type: ignore[union-attr]
    assert reached == pytest.approx(-curve(file, "loading")[0].min(), rel=1e-5)
    assert loss == pytest.approx(float(lost.energy_lost), rel=1e-3)
    assert taken == pytest.approx(float(lost.work_of_loading), rel=1e-3)
    r, _, force = of_lammps(file.parent / "told.table")
    tension, overclosure, deepest = map(
        float, re.search(r"tension: (\S+) N at (\S+) m; the deepest at a step is (\S+) N", said).groups()
    )
    assert tension == pytest.approx(-force.min(), rel=1e-8)
    assert APART - overclosure == pytest.approx(r[force.argmin()], rel=1e-8)
    assert deepest == pytest.approx(-curve(file, "unloading")[1].min(), rel=1e-8)
    stiffest = float(re.search(r"stiffness: up to (\S+) N/m", said)[1])
    h, law = curve(file, "unloading")
    assert stiffest == pytest.approx(np.max(-np.diff(law) / np.diff(h)), rel=1e-3)


@pytest.mark.parametrize(
    ("units", "tag", "length", "force"),
    [("um,nN", "UNITS: micro", 1e-6, 1e-9), ("nm,pN", "UNITS: nano", 1e-9, 1e-12), ("mm,N", None, 1e-3, 1.0)],
)
def test_units_are_those_asked_for_and_named_as_lammps_knows_them(
    file: Path, units: str, tag: str | None, length: float, force: float
) -> None:
    si, own = (of_lammps(exported(file, f"{name}.table", units=name)) for name in ("m", units))
    np.testing.assert_allclose(own * np.array([[length], [length * force], [force]]), si, rtol=1e-12)
    assert (file.parent / "m.table").read_text().splitlines()[0].endswith("; UNITS: si")
    assert re.findall("UNITS: .*", (file.parent / f"{units}.table").read_text()) == ([tag] if tag else [])


def test_a_smooth_particle_is_lost_by_a_jump_at_the_tension_of_jkr(tmp_path: Path) -> None:
    """There is no line from the last contact to zero: the table ends where the force is still in tension."""
    radius, work = 10e-6, 0.05
    one = {"source": "random", "shape": "paraboloid", "count": 1, "height": 0, "patch": "100 um", "radius": radius}
    path = {"separation": {"start": "30 nm", "stop": "-70 nm", "steps": 300}, "unload": True}
    law = scene(asperities=one, path=path, material={"effective_modulus": "1 GPa"}, batch={"realizations": 1})
    rm.run(law, tmp_path / "smooth.nc")
    r, _, force = of_lammps(exported(tmp_path / "smooth.nc", "off.table", branch="unloading", error=0.05))
    assert force.min() == pytest.approx(-1.5 * np.pi * work * radius, rel=5e-3)
    lost = rm.pull_off(rm.Paraboloid(radius=radius), effective_modulus=1e9, work=work, control="displacement")
    step = 100e-9 / 299
    assert -lost.indentation - step <= r[-1] - APART <= -lost.indentation
    assert force[-1] < 1.05 * lost.force / 1.2 < 0.0
    x, on = of_csv(exported(tmp_path / "smooth.nc", "on.csv", to="csv", error=0.05)).to_numpy().T[:2]
    assert 0.0 <= x[0] < step  # on touching it jumps into contact
    assert on[0] < 0.0


def test_a_sweep_of_one_value_is_exported_as_its_cell(tmp_path: Path) -> None:
    plain = scene(path=WIDE, batch={"estimator": "expected"}, adhesion={"model": "jkr", "work": "20 mJ/m^2"})
    swept = scene(path=WIDE, batch={"estimator": "expected"}, sweep={"adhesion.work": ["20 mJ/m^2"]})
    rm.run(plain, tmp_path / "plain.nc")
    rm.run(swept, tmp_path / "swept.nc")
    own, alone = (exported(tmp_path / f"{name}.nc", f"{name}.csv", to="csv") for name in ("swept", "plain"))
    np.testing.assert_array_equal(of_csv(own), of_csv(alone))
    assert "loss: " in header_of(own)
    assert "key: " in header_of(own)


def test_a_law_all_in_tension_is_exported_without_a_warning(tmp_path: Path) -> None:
    path = {"separation": {"start": "6 sigma", "stop": "3.9 sigma", "steps": 60}, "unload": True}
    law = rm.run(scene(path=path, batch={"estimator": "expected"}), tmp_path / "tension.nc")
    assert float(law.force.max()) <= 0.0
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        table = of_csv(exported(tmp_path / "tension.nc", "on.csv", to="csv", branch="unloading", error=0.1))
    assert table["force [N]"].min() == pytest.approx(float(law.force.min()), rel=0.1)


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"distance": ""}, "distance is ''; lammps needs that of two centres"),
        ({"distance": "2 s"}, "distance is '2 s': "),
        ({"distance": "0.1 um"}, "distance is 100 nm; it must be above 0 and above the overclosure of the last step"),
        ({"distance": "-1 um"}, "distance is -1 um; it must be above 0"),
        ({"to": "csv", "distance": "1 um"}, "distance is '1 um'; .* others have none"),
        ({"quantity": "pressure"}, "lammps has no table of quantity 'pressure'; .*; lammps has force"),
        ({"to": "moose"}, "moose has no table of quantity 'force'; c, lammps, csv, json have"),
        ({"error": 1e-5}, "known to .* only"),
    ],
)
def test_what_cannot_be_is_refused(file: Path, options: dict[str, Any], says: str) -> None:
    with pytest.raises(rm.StoreError, match=says):
        exported(file, f"refused.{options.get('to', 'table')}", **options)
    assert not list(file.parent.glob("refused*"))


def test_a_law_that_ends_in_contact_is_refused(tmp_path: Path) -> None:
    path = {"separation": {"start": "1 sigma", "stop": "0 sigma", "steps": 30}}
    rm.run(scene(adhesion=None, path=path, batch={"estimator": "expected"}), tmp_path / "in.nc")
    with pytest.raises(rm.StoreError, match="the loading is in contact where its path is farthest, at "):
        exported(tmp_path / "in.nc", "in.table")


ROUGH_BALL = {
    "title": "A rough particle",
    "material": {"effective_modulus": "50 MPa"},
    "asperities": {
        "source": "random",
        "shape": "paraboloid",
        "density": "5e10 m^-2",
        "patch": "100 um",
        "height": {"distribution": "normal", "std": "40 nm"},
        "radius": "2 um",
    },
    "nominal": {"radius": "1 mm", "error": 1e-3},
    "batch": {"estimator": "expected"},
}


def test_a_rough_ball_has_a_force_and_no_pressure(tmp_path: Path) -> None:
    path = {"separation": {"start": "clear", "stop": "0 nm", "steps": 60}}
    rm.run({**ROUGH_BALL, "path": path}, tmp_path / "ball.nc")
    r, _, force = of_lammps(exported(tmp_path / "ball.nc", "ball.table", distance="1 mm", error=5e-2))
    separation, law = curve(tmp_path / "ball.nc", "loading")
    near = as_lammps(1e-3 + separation, r, force)[:-1]
    np.testing.assert_allclose(near, law[:-1], rtol=5e-2, atol=5e-3 * law.max())
    assert "separation of the undeformed body" in header_of(tmp_path / "ball.table")
    with pytest.raises(rm.StoreError, match=r"per nominal area, and the result has none under \[nominal\]: 'force'"):
        rm.export(tmp_path / "ball.nc", tmp_path / "ball.csv", to="csv")


_BOX = """
units {units}
boundary f f f
atom_style sphere
atom_modify map array
comm_modify cutoff {twice}
neighbor 0 bin
region box block -{twice} {twice} -{twice} {twice} -{twice} {twice} units box
create_box 1 box
create_atoms 1 single 0 0 0 units box
create_atoms 1 single 0 0 {near} units box
set group all diameter {diameter} density 1
{law}
group upper id 2
timestep 1
fix apart upper move linear 0 0 {rise} units box
thermo_style custom step pe
fix told all print 1 "at $(z[2]:%.17g) $(fz[2]:%.17g) $(pe:%.17g)" screen yes
run {steps}
"""
_PAIR = "pair_style table linear {size}\npair_coeff 1 1 {table} ROUGH_FORCE"
_WALL = (
    "pair_style zero {far}\npair_coeff * *\ngroup other id 2\n"
    "fix wall other wall/table linear {size} zlo 0.0 {table} ROUGH_FORCE {far}\nfix_modify wall energy yes"
)


@pytest.mark.large
@pytest.mark.skipif(not COMMAND, reason="the environment variable ROUGHMDR_LAMMPS holds no command that runs LAMMPS")
def test_lammps_pulls_two_particles_apart_and_one_off_a_wall(tmp_path: Path) -> None:
    path = {"separation": {"start": "200 nm", "stop": "-20 nm", "steps": 220}, "unload": True}
    made = {**ROUGH_BALL, "adhesion": {"model": "jkr", "work": "50 mJ/m^2"}, "path": path}
    rm.run(made, tmp_path / "ball.nc")
    table = exported(tmp_path / "ball.nc", "ball.table", branch="unloading", distance="1 mm", units="um,nN", error=2e-2)
    r, _, force = of_lammps(table)
    with xr.open_dataset(tmp_path / "ball.nc") as data:
        pull_off = float(data.pull_off_force.squeeze()) / 1e-9
    for kind, within in ((_PAIR, 1e-6), (_WALL, 1e-4)):
        near, steps = float(r[0]) * (1.0 + 1e-9), 2000
        rise = (float(r[-1]) * (1.0 + 1e-6) - near) / steps
        way = {"near": near, "rise": rise, "steps": steps, "twice": 2e3, "diameter": 1e3, "units": "micro"}
        law_of_pair = kind.format(size=r.size, table=table, far=float(r[-1]))
        done = subprocess.run(
            [*shlex.split(COMMAND), "-log", "none"],
            input=_BOX.format(**way, law=law_of_pair),
            text=True,
            capture_output=True,
            check=True,
        )
        told = [line.split()[1:] for line in done.stdout.splitlines() if line.startswith("at ")]
        at, felt, energy = np.array(told, dtype=float).T
        np.testing.assert_allclose(felt, as_lammps(at, r, force), atol=within * np.abs(force).max())
        assert felt.min() == pytest.approx(pull_off, rel=5e-3)
        assert felt[-1] == 0.0
        spent = -np.trapezoid(felt, at)
        assert spent == pytest.approx(energy[-1] - energy[0], rel=1e-3)
