"""The study of the pull-off with and without coupling in its quick form."""

import numpy as np
import pytest
import xarray as xr
from carried_out import CarriedOut
from studies.coupled_pull_off import (
    JUMP_ON_RADIUS,
    MODELS,
    MODULUS,
    PULL_OFF_FORCE,
    PULL_OFF_LENGTH,
    RADIUS,
    STEPS,
    WORK,
    Surface,
    along,
    beyond_pairs,
    change,
    cycle,
)

import roughmdr as rm

STUDIED = "coupled_pull_off"


def test_the_scales_are_those_of_a_contact_alone() -> None:
    alone = rm.Paraboloid(radius=RADIUS)
    found = rm.pull_off(alone, effective_modulus=MODULUS, work=WORK, control="displacement")
    assert -float(found.indentation) == pytest.approx(PULL_OFF_LENGTH, rel=1e-9)
    made = rm.indent(alone, indentation=0.0, effective_modulus=MODULUS, work=WORK)
    assert float(made.contact_radius) == pytest.approx(JUMP_ON_RADIUS, rel=1e-9)


@pytest.mark.large
def test_every_unloading_ends_with_all_contacts_parted(result: xr.Dataset) -> None:
    assert np.isfinite(result["pull_off_force"]).all()
    assert (result["pull_off_force"] < 0.0).all()
    assert (result["dissipated_energy"] > 0.0).all()


@pytest.mark.large
def test_no_independent_surface_holds_more_than_its_contacts_one_by_one(result: xr.Dataset) -> None:
    alone = result.sel(model="independent")
    assert (-alone["pull_off_force"] <= alone["pull_off_contacts"] * PULL_OFF_FORCE * (1.0 + 1e-9)).all()


@pytest.mark.large
def test_independent_contacts_lose_as_much_as_each_one_alone(result: xr.Dataset) -> None:
    """Each contact that is made is parted: on its own way down and up it jumps twice, whatever its height."""
    once = cycle_of_one(Surface(1.0, 1, 1000.0).generate(0).assign(height=("asperity", [0.0])))
    alone = result.sel(model="independent")
    np.testing.assert_allclose(alone["dissipated_energy"], alone["contacts"] * once, rtol=1e-9)


def cycle_of_one(ensemble: xr.Dataset) -> float:
    separation = np.array([2.0, -2.0]) * PULL_OFF_LENGTH
    law = rm.load_separation(
        ensemble, separation=separation, unload=True, effective_modulus=MODULUS, work=WORK,
        variables=["force", "dissipated_energy"],
    )  # fmt: skip
    return float(law["dissipated_energy"][-1])


@pytest.mark.large
def test_independent_asperities_know_nothing_of_their_distance(result: xr.Dataset) -> None:
    """The heights are drawn on their own, so that they are equal at all distances."""
    alone = result["pull_off_force"].sel(model="independent")
    for _, same in alone.groupby(["spread", "asperities"]):
        flat = same.stack(each=[dim for dim in same.dims if dim != "realization"])
        np.testing.assert_allclose(flat - flat.isel(each=0), 0.0, atol=1e-12 * float(abs(flat).max()))


@pytest.mark.large
def test_coupling_fades_with_the_distance() -> None:
    """Its first order falls as the load of a neighbour over the distance."""
    changes = []
    for distance in (10.0, 100.0, 1000.0):
        ensemble = Surface(0.3, 9, distance).generate(0)
        independent, coupled = (cycle(ensemble, model, 10) for model in MODELS.values())
        changes.append(abs(coupled["dissipated_energy"] / independent["dissipated_energy"] - 1.0))
    assert changes[2] < 0.2 * changes[1] < 0.04 * changes[0]


@pytest.mark.large
@pytest.mark.parametrize("model", MODELS)
def test_the_pull_off_is_located_between_the_steps(model: str) -> None:
    ensemble = Surface(0.3, 25, 10.0).generate(0)
    coarse, fine = (cycle(ensemble, MODELS[model], steps)["pull_off_force"] for steps in (STEPS, 2 * STEPS))
    assert coarse == pytest.approx(fine, rel=1e-6)


@pytest.mark.few(1)
@pytest.mark.parametrize("model", MODELS)
def test_nothing_is_gained_on_the_way(model: str) -> None:
    ensemble = Surface(1.0, 25, 7.0).generate(1)
    law = along(ensemble, np.linspace(4.0, -1.5, 20) * PULL_OFF_LENGTH, MODELS[model])
    assert (np.diff(law["dissipated_energy"]) >= 0.0).all()
    assert float(law["contact_count"][-1]) == float(law["force"][-1]) == float(law["energy"][-1]) == 0.0
    assert float(law["pull_off_force"]) <= float(law["force"].min())


@pytest.mark.large
def test_the_files_hold_all_surfaces(studied: CarriedOut, result: xr.Dataset) -> None:
    assert (studied.folder / "coupled_pull_off.png").stat().st_size > 10_000
    rows = [line for line in studied.text.splitlines() if line.startswith("| ")]
    assert len(rows) == 2 + result.sizes["surface"]
    assert not beyond_pairs(result).any()
    assert np.isfinite(change(result, "pull_off_force")).all()
