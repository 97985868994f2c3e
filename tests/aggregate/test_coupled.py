"""Batches of coupled asperities: bits, files, marked steps, and nothing of it where there is no [interaction]."""

import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from batches import write_scene
from command import said
from forms import large
from scenes import ASPERITIES, scene

import roughmdr as rm
from roughmdr.batch.plan import make_plan
from roughmdr.interaction import newton, solve
from roughmdr.interaction.jkr import jumps
from roughmdr.runner.backend import Backend
from roughmdr.runner.run import execute
from roughmdr.scene import read

PAIRWISE = {"model": "pairwise"}
DENSER = ASPERITIES | {"count": 400, "patch": "0.5 mm"}


def coupled(**changes: Any) -> dict[str, Any]:
    path = {"separation": {"start": "2 sigma", "stop": "0 sigma", "steps": 6}}
    plain = {
        "adhesion": None,
        "interaction": PAIRWISE,
        "asperities": DENSER,
        "path": path,
        "batch": {"realizations": 6},
    }
    return scene(**plain | changes)


@pytest.fixture(scope="module")
def base() -> xr.Dataset:
    return rm.run(coupled())


@pytest.mark.large
def test_a_run_says_how_many_contacts_overlap(base: xr.Dataset) -> None:
    assert (base.marked_steps == 0).all()
    assert (base.overlap_count >= 0).all()
    assert (base.numerical_error <= 1e-6).all()
    assert ((base.model_error > 0.0) & (base.model_error < 1.0)).all()
    assert (base.force.diff("step") > 0.0).all()


def test_coupled_asperities_carry_more_on_a_periodic_patch_and_less_on_a_free_one() -> None:
    """Their mean plane is held up by the flat on the one; on the other it gives way."""
    force = {
        name: rm.run(coupled(interaction=asked)).force.mean("realization").to_numpy()[-1]
        for name, asked in (("none", None), ("free", PAIRWISE | {"boundary": "free"}))
    }
    assert force["free"] < force["none"]


@pytest.mark.large
@pytest.mark.parametrize("keep", ["curves", "statistics"])
def test_a_step_without_equilibrium_is_marked(keep: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Here for want of iterations: the first contacts, which are few, are found; the last ones are not."""
    monkeypatch.setattr(newton, "_MAX_STEPS", 3)
    out = tmp_path / "out.nc"
    made = execute(make_plan(read(coupled(output={"keep": keep}))), out, Backend(workers=1))
    assert made is None or "marked" in made.attrs.get("warnings", "marked")
    with xr.open_dataset(out) as found:
        assert float(found.marked_steps.max()) > 0
        assert "marked" in found.attrs["warnings"]
        if keep == "curves":
            force = found.force.to_numpy()
            assert np.isnan(force).any()
            assert (np.isnan(force).sum(axis=1) <= found.marked_steps.to_numpy()).all()


@pytest.mark.large
def test_far_into_the_surface_steps_are_marked_and_have_no_value() -> None:
    path = {"separation": ["0 um", "-1 um", "-3 um"]}
    found = rm.run(coupled(path=path, batch=None))
    assert float(found.marked_steps.max()) >= 1
    assert "marked" in found.attrs["warnings"]
    deep = rm.run(coupled(path={"separation": ["0 um", "-8 um"]}, batch=None))
    assert np.isfinite(deep.force.values[..., 0]).all()
    assert np.isnan(deep.force.values[..., 1]).all()
    assert float(deep.marked_steps.max()) >= 1


_IMPORTED = """
import sys
from roughmdr.cli import main
try:
    main(["run", sys.argv[1], "-o", "out.nc", "--workers", "1"])
except SystemExit as end:
    assert not end.code
print("loaded:", *sorted(sys.modules))
"""


@pytest.mark.large
@pytest.mark.parametrize("interaction", [None, large(PAIRWISE)])
def test_without_interaction_nothing_of_it_is_imported(tmp_path: Path, interaction: dict[str, Any] | None) -> None:
    table = coupled(interaction=interaction, batch=None)
    write_scene(tmp_path, table)
    command = [sys.executable, "-c", _IMPORTED, "scene.toml"]
    told = subprocess.run(command, cwd=tmp_path, check=True, capture_output=True, text=True).stdout
    loaded = set(told[told.index("loaded:") :].split())
    solvers = {f"roughmdr.interaction.{name}" for name in ("solve", "mesh", "dense", "newton", "close", "contacts")}
    assert (solvers <= loaded) == (interaction is not None)
    if interaction is None:
        assert not sorted((solvers | {"roughmdr.aggregate.coupled"}) & loaded)


@pytest.mark.parametrize(
    ("shape", "seed", "at_rest"),
    [("paraboloid", 1, False), *(large("truncated_paraboloid", *case) for case in ((1, False), (1, True), (3, True)))],
)
def test_contacts_that_do_not_come_to_rest_are_marked(
    monkeypatch: pytest.MonkeyPatch, shape: str, seed: int, at_rest: bool
) -> None:
    """With their error stated; those of truncated paraboloids without overlap, at 2.4 % of contact, come to rest."""
    section = {
        **{"source": "random", "count": 60, "patch": "62 um", "placement": "random", "shape": shape},
        **{"radius": "10 um", "height": {"distribution": "normal", "std": "0.1 um"}},
        **({"flat_radius": "0.5 um"} if shape == "truncated_paraboloid" else {}),
    }
    if not at_rest:

        def unsettled(*given: Any) -> newton.Equilibrium:
            return newton.solve(*given)._replace(error=1e-3)

        monkeypatch.setattr(solve, "solve", unsettled)
    found = rm.load_separation(
        rm.generate(section, seed=seed),
        separation=np.linspace(2e-7, 0.0, 7),
        effective_modulus=1e9,
        variables=["force"],
        interaction="pairwise",
    )
    assert np.isfinite(found.force).all()
    assert found.overlap_fraction == 0.0
    assert found.largest_contact_fraction < 0.03
    if at_rest:
        assert found.numerical_error <= 1e-6
        assert found.marked_steps == 0.0
    else:
        assert found.numerical_error >= 1e-3
        assert found.marked_steps == 7.0


def overlapping(length: float) -> dict[str, Any]:
    """A scene that goes so deep that contacts overlap by most of their radii."""
    asperities = ASPERITIES | {"count": 20, "patch": 1e-4 * length, "placement": "random", "radius": 5e-5 * length}
    return scene(
        seed=7,
        asperities=asperities | {"height": {"distribution": "normal", "std": 1e-6 * length}},
        adhesion={"model": "jkr", "work": 0.05 * length},
        interaction=PAIRWISE,
        path={"separation": [*np.linspace(6e-6, -0.9e-6, 100) * length]},
        batch={"realizations": 1},
    )


@pytest.mark.large
@pytest.mark.parametrize("length", [1e-9, 1.0])
def test_contacts_that_make_and_lose_each_other_without_end_are_lost(
    length: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    count, jump = list[int](), jumps.jump
    monkeypatch.setattr(jumps, "jump", lambda *given: count.append(1) or jump(*given))
    with pytest.warns(rm.errors.LimitWarning):
        law = rm.run(overlapping(length))
    lost = np.isnan(law.force[0].to_numpy())
    assert lost[-1]
    assert not lost[:90].any()
    assert law.marked_steps[0] >= lost.sum()
    assert len(count) < 5 * 20  # and not 10 for each asperity in each of the last avalanches


@pytest.mark.large
def test_a_plan_says_where_no_equilibrium_is_found(tmp_path: Path) -> None:
    write_scene(tmp_path, overlapping(1.0))
    told = said("plan", "scene.toml", cwd=tmp_path)
    assert "pressure     not known at closest approach: no equilibrium is found there in 1 of 1 cells" in told
    assert "nan" not in told
