"""The flat on a machine, of every kind of contact: no earlier passage on its way, and what its jumps lose."""

from itertools import pairwise

import numpy as np
import pytest
import xarray as xr
from scenes import detachment_depths

import roughmdr as rm
from roughmdr.aggregate.problem import Problem
from roughmdr.aggregate.under_machine import follow, separations_of
from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.loading.machine import DEAD_LOAD, spring

E, W = 4e6, 0.05
_TOP = 4e-6  # where no contact is left
COLUMNS = {
    "paraboloid": {"radius": [3e-5, 8e-5]},
    "cone": {"slope": [0.05, 0.2]},
    "power_law": {"exponent": [1.2, 4.0], "width": [2e-5, 3e-5], "rise": [1e-6, 2e-6]},
    "steep power_law": {"exponent": [0.55, 0.75], "width": [2e-5, 3e-5], "rise": [5e-6, 6e-6]},
    "truncated_cone": {"slope": [0.1, 0.3], "flat_radius": [1e-7, 3e-6]},
    "flat_punch": {"radius": [1e-6, 4e-6]},
}


def rough(kind: str, count: int, seed: int) -> xr.Dataset:
    rng = np.random.default_rng(seed)
    arrays = {name: ("asperity", rng.uniform(*ends, count)) for name, ends in COLUMNS[kind].items()}
    height = ("asperity", np.sort(rng.normal(0.0, 3e-7, count))[::-1])
    return xr.Dataset({"height": height, **arrays}, attrs={"shape": kind.rsplit(maxsplit=1)[-1]})


def controls(data: xr.Dataset, dead: bool, material: dict) -> tuple[np.ndarray, dict]:
    """Turning points that load, pull back, load again and pull off; with the stiffness of a spring of that order."""
    low = float(data.height.min()) - 2e-7
    law = rm.load_separation(data, separation=[_TOP, low], unload=True, variables=("force", "stiffness"), **material)
    stiffness = 0.3 * float(law.stiffness[1])
    tension = abs(float(law.pull_off_force))
    load = max(float(law.force[1]), 2.0 * tension)
    if dead:
        return np.array([0.0, load, -0.7 * tension, 0.5 * load, -1.1 * tension]), {}
    far = _TOP + 1.5 * tension / stiffness
    turns = [_TOP, low - load / stiffness, 0.0, low - 0.5 * load / stiffness, far]
    return np.array(turns), {"machine_stiffness": stiffness}


@pytest.mark.few(1)
@pytest.mark.parametrize("dead", [True, False])
@pytest.mark.parametrize(
    ("kind", "adhesion"),
    [(kind, "jkr") for kind in COLUMNS]
    + [("paraboloid", "dugdale"), ("flat_punch", "dugdale"), ("paraboloid", "none")],
)
def test_the_flat_stands_where_the_demand_is_met_first(kind: str, adhesion: str, dead: bool) -> None:
    data = rough(kind, 12, seed=len(kind))
    material = {"effective_modulus": E, "work": 0.0 if adhesion == "none" else W}
    material |= {"adhesion": "dugdale", "strength": 3e5} if adhesion == "dugdale" else {}
    turns, machine = controls(data, dead, material)
    if adhesion == "none":
        turns = np.abs(turns) if dead else turns
    steps = np.concatenate([np.linspace(a, b, 8)[:-1] for a, b in pairwise(turns)])
    found = rm.load_separation(data, **{"force" if dead else "remote": steps}, **machine, **material)
    h = found.separation.values
    standing = np.flatnonzero(np.isfinite(h))
    force = rm.load_separation(data, separation=h[: standing[-1] + 1], **material).force.values
    demand = -force if dead else h[: force.size] - force / machine["machine_stiffness"]
    asked = -steps if dead else steps
    scale = np.ptp(asked)
    touching = found.contact_count.values[: force.size] > 0
    if dead:  # just above first touch no contact bears a load of 0
        touching &= np.arange(force.size) > 0
    np.testing.assert_allclose(demand[touching], asked[: force.size][touching], rtol=0.0, atol=1e-11 * scale)
    # Between two steps, at many more separations, the demand is not met before.
    for step in standing[1:]:
        if not np.isfinite(h[step - 1]) or h[step] == h[step - 1] or asked[step] == asked[step - 1]:
            continue
        way = h[step - 1] + (h[step] - h[step - 1]) * (1.0 - np.geomspace(1.0, 1e-6, 60))
        path = np.concatenate([h[:step], way])
        between = rm.load_separation(data, separation=path, **material).force.values[step:]
        met = -between if dead else way - between / machine["machine_stiffness"]
        rising = asked[step] > asked[step - 1]
        assert (met <= asked[step] + 1e-9 * scale if rising else met >= asked[step] - 1e-9 * scale).all()


@pytest.mark.parametrize("kinds", [("paraboloid",), ("paraboloid", "cone")], ids="-".join)
def test_the_search_is_compiled_once_for_all_laws(kinds: tuple[str, ...]) -> None:
    """Laws whose parameters are numbers, with and without adhesion."""
    compiled = []
    for kind, work in [*((kind, W) for kind in kinds), ("paraboloid", 0.0)]:
        rm.load_separation(rough(kind, 5, seed=1), force=[0.0, 1e-6], effective_modulus=E, work=work)
        compiled.append(len(follow.signatures))
    assert compiled[0] >= 1
    assert len(set(compiled)) == 1


NODES, WEIGHTS = np.polynomial.legendre.leggauss(24)


def work_of_flat(data: xr.Dataset, way: list[tuple[float, float]], events: np.ndarray) -> tuple[float, np.ndarray]:
    """-∫ F dh over the pieces that the flat goes through, between all events; and the force at the ends of each."""
    path, weights, ends = [], [], []
    for begin, end in way:
        inner = events[(events > min(begin, end)) & (events < max(begin, end))]
        stops = np.array([begin, *(np.sort(inner) if end > begin else np.sort(inner)[::-1]), end])
        ends.append(len(path))
        path.append(begin)
        weights.append(0.0)
        for a, b in pairwise(stops):  # smooth in the root of the distance to the upper end, where a fold may be
            top, s = max(a, b), np.sqrt(abs(b - a))
            root = s * (1.0 + NODES) / 2.0
            h, weight = top - root * root, WEIGHTS * s * root
            order = np.argsort(-h if b < a else h)
            path += h[order].tolist()
            weights += (np.sign(b - a) * weight[order]).tolist()
        ends.append(len(path))
        path.append(end)
        weights.append(0.0)
    force = rm.load_separation(data, separation=path, effective_modulus=E, work=W).force.values
    return -float(np.sum(force * weights)), force[ends].reshape(-1, 2)


@pytest.mark.parametrize("dead", [True, False])
@pytest.mark.parametrize(
    "kind", ["paraboloid", "power_law", "steep power_law", "flat_punch", pytest.param("cone", marks=pytest.mark.large)]
)
def test_the_work_of_a_closed_cycle_is_what_contacts_and_machine_lose(kind: str, dead: bool) -> None:
    """-∮ F dX over the way of the flat, which knows neither the energy of contacts nor that of jumps."""
    data = rough(kind, 9, seed=3 + len(kind))
    material = {"effective_modulus": E, "work": W}
    turns, given = controls(data, dead, material)
    cycle = turns[[0, 1, -1]]
    machine = DEAD_LOAD if dead else spring(given["machine_stiffness"])
    law = rm.load_separation(
        data,
        **{"force" if dead else "remote": cycle},
        **given,
        **material,
        variables=("contact_count", "dissipated_energy", "machine_dissipated_energy"),
    )
    assert float(law.contact_count[-1]) == 0.0
    ensemble = Ensemble.from_dataset(data)
    demand = -cycle if dead else cycle
    stands, jumps = separations_of(Problem(ensemble, E, Adhesion(W)), machine, demand, jumps=True)
    depth = detachment_depths(data, **material)
    z = data.height.values
    clear = float((z + depth).max()) * (1.0 + 1e-9)
    touch = float(z.max())
    way, at = [], touch
    for jump in jumps:
        if jump.step == 2 and not any(end == stands[1] for _, end in way):
            way.append((at, stands[1]))
            at = stands[1]
        way.append((at, jump.before))
        at = clear if jump.after > clear else jump.after
    way.append((at, clear))
    events = np.concatenate([z, z + depth])
    work, force = work_of_flat(data, [(a, b) for a, b in way if a != b], events)
    if dead:
        work += sum(jump.demand * ((clear if jump.after > clear else jump.after) - jump.before) for jump in jumps)
    else:
        work += float(np.sum(force[:, 1] ** 2 - force[:, 0] ** 2)) * 0.5 * machine.compliance
    total, of_machine = float(law.dissipated_energy[-1]), float(law.machine_dissipated_energy[-1])
    assert 0.0 < of_machine < total
    assert work == pytest.approx(total, rel=1e-10)
