"""Contacts that adhere and yield, pressed to a preload and pulled off: a plain twin, limits, energies, refusals."""

import math
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from forms import large
from hypothesis import given, settings, strategies as st

from roughmdr.aggregate import simulate
from roughmdr.aggregate.problem import Problem
from roughmdr.ensemble import Ensemble
from roughmdr.errors import OutOfRange, SceneError
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.loading.machine import MachinePath, Preload, travel
from roughmdr.numerics.arguments import Floats
from roughmdr.scene.read import read
from roughmdr.stages.plastic.body import NO_MARK, Body
from roughmdr.stages.plastic.drawn import DrawnAsperities
from roughmdr.stages.plastic.law import plastic_law
from roughmdr.stages.plastic.models import kernels_of
from roughmdr.stages.plastic.total import rows_of

NAMES = ["separation", "force", "contact_count", "contact_fraction", "energy", "dissipated_energy"]
HARD = 1e-7
"""E*/Y of asperities that do not yield."""


class Rough:
    """Asperities of radii about 1 and heights that scatter by ``spread``, in units of a length [m] and a pressure [Pa].

    E* is 1, Y and w are given over it.
    """

    def __init__(
        self,
        stiff: float,
        sticky: float,
        *,
        count: int = 40,
        spread: float = 0.02,
        seed: int = 1,
        units: Any = (1.0, 1.0),
    ) -> None:
        self.length, self.pressure = units
        rng = np.random.default_rng(seed)
        self.height = np.sort(rng.normal(0.0, spread, count))[::-1] * self.length
        self.radius = rng.uniform(0.5, 2.0, count) * self.length
        work = sticky * self.length * self.pressure
        self.body = Body(self.pressure, self.pressure / stiff, work, 0.3, math.inf, 0.0)
        area = 100.0 * self.length**2
        ensemble = Ensemble("paraboloid", self.height, {"radius": self.radius}, nominal_area=area)
        self.problem = Problem(ensemble, self.pressure, Adhesion(work, "jkr") if work > 0.0 else Adhesion(0.0))
        self.force = self.pressure * self.length**2

    def path(self, preload: Preload, steps: int) -> MachinePath:
        way = travel(steps)
        way = np.concatenate([way, way[::-1]])
        return MachinePath.to_preload(way, preload, machine_stiffness=None, adhesive=self.body.work > 0.0)

    def law(self, load: float, steps: int = 12, quantity: str = "force") -> Any:
        value = load if quantity == "contact_fraction" else load * self.force
        return plastic_law(
            DrawnAsperities(self.problem, "mdr", self.body), self.path(Preload(quantity, value), steps), NAMES
        )

    def elastic(self, load: float, steps: int = 12) -> Any:
        return simulate(self.problem, self.path(Preload("force", load * self.force), steps), NAMES)

    def first_bearing(self, load: float) -> float | None:
        """Separation where contacts bear a load first: between two touches, where the force rises, by halving.

        None if the highest is pressed deeper than 0.2: contacts may then be larger than the nominal area.
        """
        kernels: Any = kernels_of("mdr", self.body)
        rows = rows_of(kernels, self.radius, self.body)

        def force(h: float, touched: int) -> float:
            total = 0.0
            for z, row in zip(self.height[:touched].tolist(), rows, strict=False):
                mark = kernels.mark(z - h, row, self.body) if z > h else NO_MARK
                total += kernels.state(z - h, 0.0, mark, row, self.body).force
            return total

        deepest = float(self.height[0]) - 0.2 * self.length
        heights = [h for h in self.height.tolist() if h > deepest]
        for touched, (above, below) in enumerate(pairwise([*heights, deepest]), start=1):
            high, low = above, below
            if force(low, touched) < load * self.force:
                continue
            for _ in range(200):
                middle = 0.5 * (low + high)
                low, high = (middle, high) if force(middle, touched) >= load * self.force else (low, middle)
            return float(low)
        return None


def close(found: Floats, exact: Floats | float, scale: float) -> None:
    np.testing.assert_allclose(found, exact, rtol=0.0, atol=scale)


@settings(deadline=None, max_examples=12)
@given(
    st.floats(0.0, 4.0).map(lambda power: 10.0**power),
    st.floats(-8.0, -3.0).map(lambda power: 10.0**power),
    st.floats(-7.0, 0.5).map(lambda power: 10.0**power),
    st.integers(0, 99),
    st.sampled_from([(1.0, 1.0), (1e-9, 1e12), (1e-6, 70e9), (1e3, 1.0)]),
)
def test_the_turning_point_is_where_the_load_is_borne_first(
    stiff: float, sticky: float, load: float, seed: int, units: Any
) -> None:
    rough = Rough(stiff, sticky, seed=seed, units=units)
    plain = rough.first_bearing(load)
    if plain is None:
        return
    found = rough.law(load).variables
    close(found["separation"][11:13], plain, 1e-12 * (rough.height[0] - plain))
    close(found["force"][11:13], load * rough.force, 1e-10 * rough.force * (load + rough.body.work / rough.force))
    assert found["force"][-1] == found["contact_count"][-1] == 0.0  # pulled off


@pytest.mark.parametrize("units", [(1e-6, 70e9), large((1.0, 1.0))])
@pytest.mark.parametrize("sticky", [1e-5, large(1e-7), large(1e-3)])
def test_hard_asperities_are_elastic(sticky: float, units: Any) -> None:
    """Strong adhesion too, where the load is borne after many touches that pull."""
    rough = Rough(HARD, sticky, count=100, units=units)
    for load in (1e-6, 1e-3, 0.1):
        found, elastic = rough.law(load), rough.elastic(load)
        depth = np.ptp(elastic.variables["separation"])
        largest = np.abs(elastic.variables["force"]).max()
        close(found.variables["separation"], elastic.variables["separation"], 1e-12 * depth)
        close(found.variables["force"], elastic.variables["force"], 1e-9 * largest)
        assert found.pull_off.force == pytest.approx(elastic.pull_off.force, rel=1e-9)
        assert found.pull_off.separation == pytest.approx(elastic.pull_off.separation, abs=1e-9 * depth)
        for name in ("energy", "dissipated_energy"):
            scale = np.abs(elastic.variables[name]).max()
            close(found.variables[name], elastic.variables[name], 1e-9 * scale)


def test_weak_adhesion_leaves_the_dry_preload() -> None:
    """The separation changes with the square root of w, as the stretch of the springs does."""
    dry = Rough(300.0, 0.0).law(0.01).variables["separation"][11]
    off = [abs(Rough(300.0, sticky).law(0.01).variables["separation"][11] - dry) for sticky in (1e-10, 1e-12, 1e-14)]
    assert off[0] < 1e-4
    assert off[1] < 0.2 * off[0]
    assert off[2] < 0.2 * off[1]


def test_the_work_of_the_loop_is_lost() -> None:
    errors = []
    for steps in (500, 4000):
        found = Rough(100.0, 1e-4).law(0.05, steps).variables
        h, force = found["separation"], found["force"]
        work = -float(np.sum(0.5 * (force[1:] + force[:-1]) * np.diff(h)))
        assert found["energy"][-1] == 0.0
        errors.append(abs(work / found["dissipated_energy"][-1] - 1.0))
    assert errors[1] < 0.3 * errors[0] < 1e-2  # steps do not meet jumps


def test_pressures_and_contact_fractions_are_preloads_as_well() -> None:
    rough = Rough(100.0, 1e-4)
    by_force = rough.law(0.05).variables
    by_area = rough.law(by_force["contact_fraction"][11], quantity="contact_fraction").variables
    by_pressure = rough.law(0.05 / 100.0, quantity="pressure").variables if rough.length == 1.0 else by_force
    for found in (by_area, by_pressure):
        close(found["separation"], by_force["separation"], 1e-12 * np.ptp(by_force["separation"]))


def test_a_load_out_of_reach_is_refused() -> None:
    """Spheres that are pressed flat bear no more."""
    rough = Rough(100.0, 1e-4)
    rough.body = rough.body._replace(squared=1.0)
    with pytest.raises(OutOfRange, match="out of reach"):
        rough.law(100.0)


SCENE = {
    "title": "sticky",
    "seed": 1,
    "material": {"effective_modulus": 1e9},
    "adhesion": {"work": 0.1, "model": "jkr"},
    "asperities": {"source": "random", "shape": "paraboloid", "count": 10, "patch": 1e-4, "radius": 1e-6},
    "plasticity": {"yield_strength": 1e8},
    "output": {"variables": ["force"]},
}
SCENE["asperities"]["height"] = {"distribution": "normal", "std": 1e-8}  # type: ignore[index]


@pytest.mark.parametrize(
    ("path", "key"),
    [
        ({"force": [1e-6]}, "force"),
        ({"pressure": [1e3]}, "pressure"),
        ({"remote": [0.0], "machine_stiffness": 1.0}, "remote"),
        ({"preload": 1e-6, "machine_stiffness": 1.0}, "machine_stiffness"),
    ],
)
def test_loads_and_springs_are_refused(path: Any, key: str) -> None:
    with pytest.raises(SceneError, match=rf"path\.{key}: does not go .* need path\.separation or a preload alone"):
        read(SCENE | {"path": path})
    assert read(SCENE | {"path": {"preload": 1e-6, "unload": True}}).path.to_preload
