"""The batch: the same bits for any number of workers and any tasks, and what the result holds."""

import doctest
import sys

import numpy as np
import pytest
import xarray as xr
from scenes import CONDUCTION, scene

import roughmdr as rm
from roughmdr.model_error.parts import PARTS
from roughmdr.variables import CONDUCTANCES, CURVE_VARIABLES, SAMPLE


@pytest.fixture(scope="module")
def base() -> xr.Dataset:
    return rm.run(scene(), workers=1)


def test_more_realisations_begin_with_the_same_ones(base: xr.Dataset) -> None:
    more = rm.run(scene(batch={"realizations": 18}))
    np.testing.assert_array_equal(more.force[:16], base.force)
    assert len(np.unique(more.force.isel(step=39))) == 18


def test_the_contract_of_the_result(base: xr.Dataset) -> None:
    assert base.sizes == {"realization": 16, "step": 80}
    assert set(base.coords) == {"separation", "branch", "cell_key"}
    assert list(base.data_vars) == [
        "force", "contact_area", "contact_count", "stiffness",
        *(f"pull_off_{name}" for name in ("force", "separation", "contacts", "contact_area")),
        *(f"pull_off_{name}" for name in ("pressure", "contact_fraction")),
        "pull_off_count", "pull_off_force_of_mean", "pull_off_pressure_of_mean", "nominal_area", "run_time",
        "numerical_error", "model_error", *PARTS, "overlap_fraction", "largest_contact_fraction",
        "asperity_origin", *SAMPLE, "trusted_separation", "edge_slope", "profile_extent", "status",
    ]  # fmt: skip
    for name in ("force", "contact_area", "contact_count", "stiffness"):
        assert base[name].dims == ("realization", "step")
        assert base[name].dtype == np.float64
        assert base[name].attrs == CURVE_VARIABLES[name].attrs
    assert base.separation.units == "m"
    np.testing.assert_allclose(base.separation[:40], np.linspace(3e-6, -0.5e-6, 40), rtol=1e-15)
    np.testing.assert_array_equal(base.separation[40:], base.separation[:40][::-1])
    assert base.branch.to_numpy().tolist() == ["loading"] * 40 + ["unloading"] * 40
    assert (base.status == 0).all()
    assert (base.run_time > 0.0).all()
    assert ((base.numerical_error > 0.0) & (base.numerical_error < 1e-10)).all()
    assert base.attrs["Conventions"] == "CF-1.11"
    assert base.attrs["seed"] == 7
    for name in ("title", "source", "history", "references", "packages"):
        assert base.attrs[name]
    assert rm.run({**read_back(base)}).force.equals(base.force)


def read_back(result: xr.Dataset) -> dict[str, object]:
    import tomllib

    return tomllib.loads(result.attrs["scene"])


def test_what_is_left_out_is_said() -> None:
    lines = rm.run(scene(adhesion=None, batch=None)).attrs["left_out"].splitlines()
    parts = [line.split(": ")[0] for line in lines]
    assert "adhesion" in parts
    assert "positions" in parts
    assert "interaction" in parts
    assert all(": " in line for line in lines)
    assert "adhesion" not in [line.split(": ")[0] for line in rm.run(scene(batch=None)).attrs["left_out"].splitlines()]


def test_every_variable_can_be_asked_for_alone_and_equals_itself_among_others() -> None:
    known = CURVE_VARIABLES | CONDUCTANCES
    every = rm.run(scene(output={"variables": list(known)}, conduction=CONDUCTION, batch=None))
    for name in known:
        alone = rm.run(scene(output={"variables": [name]}, conduction=CONDUCTION, batch=None))
        assert [v for v in alone.data_vars if v in known] == [name]
        np.testing.assert_array_equal(alone[name], every[name])


def test_dimensionless_twins() -> None:
    result = rm.run(scene(output={"variables": ["force", "pressure", "contact_area", "contact_fraction"]}, batch=None))
    np.testing.assert_allclose(result.pressure, result.force / 1e-6, rtol=1e-15)
    np.testing.assert_allclose(result.contact_fraction, result.contact_area / 1e-6, rtol=1e-15)


@pytest.mark.parametrize("workers", [0, -1, 1.5, True])
def test_a_wrong_number_of_workers_is_refused(workers: object) -> None:
    with pytest.raises(rm.RoughmdrError, match="workers is"):
        rm.run(scene(), workers=workers)  # type: ignore[arg-type]


def test_the_example_of_run_is_what_it_says() -> None:
    assert doctest.testmod(sys.modules[rm.run.__module__]) == (0, 3)
