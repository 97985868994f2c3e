"""Adhesive asperities that feel each other, on a machine: by hand where it can be done, first passages elsewhere."""

import math
from itertools import pairwise
from pathlib import Path

import mpmath as mp
import numpy as np
import pytest
import xarray as xr
from forms import large
from scenes import ASPERITIES, scene

import roughmdr as rm

UNITS = [(1.0, 1.0, 1.0 / (2.0 * math.pi)), (2e-5, 3e6, 0.05), (20e-9, 70e9, 0.08)]
"""R [m], E* [Pa], w [J/m2]."""


def scales(radius: float, modulus: float, work: float) -> tuple[float, float, float]:
    """a0 and d0 [m], and 2 E* a0 d0 [N]."""
    a0 = float(np.cbrt(2.0 * math.pi * work * radius**2 / modulus))
    return a0, a0**2 / radius, 2.0 * modulus * a0 * (a0**2 / radius)


def placed(radius: float, at: list[tuple[float, float]], height: list[float], side: float) -> xr.Dataset:
    """Paraboloids at positions and heights [m] on a patch of a side [m]."""
    x, y = np.array(at, dtype=float).T
    columns = {"height": height, "radius": np.full(len(height), radius), "x": x, "y": y}
    arrays = {name: ("asperity", np.asarray(values, dtype=float)) for name, values in columns.items()}
    return xr.Dataset(arrays, attrs={"shape": "paraboloid", "patch": side, "nominal_area": side**2})


def fold(compliance: float) -> tuple[float, float]:
    """Position [d0] and load [2 E* a0 d0] at which one contact lets go that gives way by this much [d0] for a load."""
    with mp.workdps(30):
        c = mp.mpf(compliance)
        t = mp.findroot(lambda t: 4 * t**3 - 1 + c * (4 * t**5 - 3 * t**2), (0.62, 0.95), solver="anderson")
        return float(t - t**4 - c * (2 * t**6 / 3 - t**3)), float(2 * t**6 / 3 - t**3)


@pytest.mark.few(5)
@pytest.mark.parametrize(("radius", "modulus", "work"), UNITS)
@pytest.mark.parametrize("kappa", [0.03, 1.0, 40.0])
@pytest.mark.parametrize("count", [1, 2, 3])
def test_equal_contacts_on_a_spring_let_go_where_the_reduced_problem_folds(radius, modulus, work, kappa, count) -> None:
    """Contacts that all feel g times their load give way by g + count/kappa together."""
    a0, d0, load = scales(radius, modulus, work)
    distance, stiffness = 5.0, 2.0 * modulus * a0 * kappa
    corners = [(0.0, 0.0), (distance, 0.0), (0.5 * distance, 0.5 * math.sqrt(3.0) * distance)][:count]
    data = placed(radius, [(a0 * x, a0 * y) for x, y in corners], [0.0] * count, 40.0 * a0)
    far, force = fold((count - 1) * 2.0 / (math.pi * distance) + count / kappa)
    remote = d0 * np.array([0.0, far * (1.0 - 1e-8), far * (1.0 + 1e-8)])
    found = rm.load_separation(
        data,
        remote=remote,
        machine_stiffness=stiffness,
        effective_modulus=modulus,
        work=work,
        interaction={"model": "pairwise", "boundary": "free", "order": 1},
    )
    assert found.contact_count.values.tolist() == [count, count, 0.0]
    assert float(found.force[1]) == pytest.approx(count * force * load, rel=1e-3)  # as the root of the distance
    rtol = np.array([1e-11, 1e-8, 1e-11])  # next to the fold the load follows the separation steeply
    assert (
        abs(found.force - stiffness * (found.separation - found.remote)) <= rtol * count * (load + stiffness * d0)
    ).all()
    assert float(found.separation[2]) == remote[2]


@pytest.mark.parametrize(("radius", "modulus", "work"), UNITS)
def test_one_contact_under_a_dead_load_holds_up_to_its_pull_off_force(radius, modulus, work) -> None:
    a0, d0, _ = scales(radius, modulus, work)
    data, force = placed(radius, [(0.0, 0.0)], [0.3 * d0], 20.0 * a0), 1.5 * math.pi * work * radius
    found = rm.load_separation(
        data,
        force=[0.0, -force * (1.0 - 1e-9), -force * (1.0 + 1e-9), 0.0],
        effective_modulus=modulus,
        work=work,
        interaction={"model": "pairwise", "boundary": "free"},
    )
    assert found.contact_count.values.tolist() == [1.0, 1.0, 0.0, 1.0]
    assert np.isnan(found.separation.values).tolist() == [False, False, True, False]
    assert float(found.separation[3]) == pytest.approx(float(found.separation[0]), rel=1e-10)


def loss(compliance: float) -> float:
    """Energy [2 E* a0 d0^2] that one contact loses in a cycle that gives way by this much [d0] for a load."""
    with mp.workdps(30):
        c = mp.mpf(compliance)

        def load(t: mp.mpf) -> mp.mpf:
            return 2 * t**6 / 3 - t**3

        def energy(t: mp.mpf) -> mp.mpf:
            return mp.quad(lambda s: load(s) * (4 * s**3 - 1), [0, t]) + c * load(t) ** 2 / 2

        parted = mp.findroot(lambda t: 4 * t**3 - 1 + c * (4 * t**5 - 3 * t**2), (0.62, 0.95), solver="anderson")
        made = mp.findroot(lambda t: t**3 - 1 + c * (2 * t**5 / 3 - t**2), (0.9, 1.15), solver="anderson")
        return float(energy(parted) - energy(made))


@pytest.mark.few(1)
@pytest.mark.parametrize(("radius", "modulus", "work"), UNITS)
@pytest.mark.parametrize("kappa", [0.1, 1.0, 20.0])
@pytest.mark.parametrize("count", [1, 2, 3])
def test_a_cycle_of_equal_contacts_loses_what_the_reduced_problem_loses(radius, modulus, work, kappa, count) -> None:
    a0, d0, load = scales(radius, modulus, work)
    distance = 5.0
    corners = [(0.0, 0.0), (distance, 0.0), (0.5 * distance, 0.5 * math.sqrt(3.0) * distance)][:count]
    found = rm.load_separation(
        placed(radius, [(a0 * x, a0 * y) for x, y in corners], [0.0] * count, 40.0 * a0),
        remote=d0 * np.linspace(1.0, -1.0, 5) * (1.0 + count / kappa),
        machine_stiffness=2.0 * modulus * a0 * kappa,
        effective_modulus=modulus,
        work=work,
        unload=True,
        interaction={"model": "pairwise", "boundary": "free", "order": 1},
        variables=("dissipated_energy", "machine_dissipated_energy"),
    )
    total, of_machine = (
        float(found[name][-1]) / (count * load * d0) for name in ("dissipated_energy", "machine_dissipated_energy")
    )
    at_others = (count - 1) * 2.0 / (math.pi * distance)
    assert total == pytest.approx(loss(at_others + count / kappa), rel=1e-9)
    assert total - of_machine == pytest.approx(loss(at_others), rel=1e-9)


def test_the_loss_of_one_contact_on_a_spring() -> None:
    """The figure is that of a computation with 30 digits."""
    assert loss(1.0) == pytest.approx(0.240488279597161, rel=1e-14)


def random_case(seed: int) -> tuple[xr.Dataset, dict, np.ndarray, float]:
    """An ensemble, crowded or not, its material, turning points of its machine, and the stiffness of that or 0."""
    rng = np.random.default_rng(seed)
    radius, modulus, work = UNITS[seed % 3]
    a0, d0, load = scales(radius, modulus, work)
    count, apart = int(rng.integers(2, 9)), rng.uniform(2.2, 6.0)
    cells = rng.permutation(9)[:count]
    at = [apart * a0 * np.array([cell % 3 + 0.5 * rng.random(), cell // 3 + 0.5 * rng.random()]) for cell in cells]
    z = rng.normal(0.0, 10.0 ** rng.uniform(-3.0, 0.3), count)
    z -= z.max()
    data = placed(radius, at, (d0 * z).tolist(), 3.5 * apart * a0)
    data["radius"] = data.radius * rng.uniform(0.7, 1.3, count)
    material = {
        "effective_modulus": modulus,
        "work": work,
        "interaction": {"model": "pairwise", "order": 1 + seed % 2, "boundary": ["free", "periodic"][seed // 2 % 2]},
    }
    if rng.random() < 0.35:
        return data, material, load * count * np.append(0.0, rng.uniform(-0.6, 1.2, 5)), 0.0
    kappa = 10.0 ** rng.uniform(-2.0, 1.5)
    way = 1.0 / kappa
    turns = d0 * np.append(1.0, rng.uniform(z.min() - 1.0 - 0.5 * way, 1.2 + 0.6 * way, 5))
    return data, material, turns, 2.0 * modulus * a0 * kappa * count


@pytest.mark.large
@pytest.mark.parametrize("seed", [0, *map(large, range(1, 13))])
def test_random_ensembles_stand_where_the_demand_is_met_first(seed: int) -> None:
    data, material, turns, stiffness = random_case(seed)
    steps = np.concatenate([np.linspace(a, b, 6)[:-1] for a, b in pairwise(turns)])
    given = {"remote": steps, "machine_stiffness": stiffness} if stiffness else {"force": steps}
    losses = "dissipated_energy", "machine_dissipated_energy"
    found = rm.load_separation(data, **given, **material, variables=("force", "contact_count", *losses))
    asked = steps if stiffness else -steps
    off = np.isnan(found.separation.values)
    plain = rm.load_separation(data, **given, **material).separation
    _, d0, load = scales(*UNITS[seed % 3])
    np.testing.assert_allclose(plain, found.separation, rtol=0.0, atol=1e-10 * d0)
    h = np.where(off, np.nanmax(found.separation, initial=0.0) + 3.0 * d0, found.separation)
    part = 1 + np.arange(20)
    begin = np.append(max(h[0], d0), h[:-1])
    path = np.append(begin[0], (begin[:, None] + (h - begin)[:, None] * part / part.size).ravel())
    path[part.size :: part.size] = h
    law = rm.load_separation(data, separation=path, **material, variables=("force", "contact_count", losses[0]))
    demand = path - law.force.values / stiffness if stiffness else -law.force.values
    unit = max(d0, float(abs(law.force).max()) / stiffness) if stiffness else data.asperity.size * load
    touching = law.contact_count.values > 0
    at = np.arange(1, h.size + 1) * part.size
    # Where contacts have more area than the patch, neither has a count.
    np.testing.assert_array_equal(law.contact_count.values[at][~off], found.contact_count.values[~off])
    on = touching[at] & ~off
    np.testing.assert_allclose(demand[at][on], asked[on], rtol=0.0, atol=1e-10 * unit)
    total, of_machine = (found[name].values for name in losses)
    np.testing.assert_allclose(total - of_machine, law[losses[0]].values[at], rtol=0.0, atol=1e-9 * np.nanmax(total))
    assert (np.diff(of_machine[np.isfinite(of_machine)]) >= -1e-12 * np.nanmax(total)).all()
    for step in np.flatnonzero(~off[1:] & ~off[:-1]) + 1:
        way = slice(at[step - 1] + 1, at[step])
        beyond = np.sign(asked[step] - asked[step - 1]) * (demand[way] - asked[step])
        assert (beyond[touching[way]] <= 1e-9 * unit).all()


@pytest.mark.large
def test_more_steps_on_a_leg_move_nothing() -> None:
    radius, modulus, work = UNITS[1]
    a0, d0, load = scales(radius, modulus, work)
    data = placed(radius, [(0.0, 0.0), (5.0 * a0, a0), (a0, 6.0 * a0)], [0.2 * d0, 0.0, -0.1 * d0], 20.0 * a0)
    material = {"effective_modulus": modulus, "work": work, "interaction": "pairwise"}
    many = np.concatenate([np.linspace(0.0, 2.0 * load, 13), np.linspace(2.0 * load, -0.8 * load, 13)[1:]])
    few = rm.load_separation(data, force=many[::4], **material).separation.values
    all_of_them = rm.load_separation(data, force=many, **material).separation.values
    np.testing.assert_allclose(few, all_of_them[::4], rtol=0.0, atol=1e-10 * d0)


@pytest.mark.large
def test_a_scene_presses_to_a_preload_and_pulls_until_all_contacts_are_lost(tmp_path: Path) -> None:
    asked = scene(
        asperities={**ASPERITIES, "count": 12, "placement": "random"},
        path={"preload": "2 uN", "machine_stiffness": "50 N/m", "steps": 6, "unload": True},
        interaction={"model": "pairwise"},
    )
    result = rm.run(asked, out=tmp_path / "pulled.nc")
    assert (result.contact_count.isel(step=-1) == 0.0).all()
    np.testing.assert_allclose(result.force.isel(step=5), 2e-6, rtol=1e-9)
    assert np.isfinite(result.pull_off_force).all()


def test_adhesion_with_a_range_is_refused() -> None:
    radius, modulus, work = UNITS[1]
    data = placed(radius, [(0.0, 0.0)], [0.0], 1e-3)
    with pytest.raises(rm.SceneError, match="'pairwise' goes with adhesion 'jkr' only, not 'dugdale'"):
        rm.load_separation(
            data,
            force=[1e-6],
            effective_modulus=modulus,
            work=work,
            adhesion="dugdale",
            strength=1e6,
            interaction="pairwise",
        )
