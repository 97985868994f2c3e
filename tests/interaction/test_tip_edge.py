"""Tips that end at an edge on a tilted surface: against boundary elements, and continuous from no load to any."""

import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings, strategies as st
from scenes import ensemble
from scipy.optimize import brentq, minimize_scalar
from test_contacts import EXAMPLES, one

import roughmdr as rm
from roughmdr.interaction.interface import Contacts
from roughmdr.interaction.tip_edge import held, level, whole_edge
from roughmdr.numerics.arguments import Floats
from roughmdr.shapes.base import Shape

EDGED: dict[str, Shape] = {
    name: EXAMPLES[name] for name in ("truncated_cone", "truncated_paraboloid", "capped_paraboloid", "rounded_punch")
} | {"flat_punch": rm.FlatPunch(radius=0.06)}


BY_ELEMENTS: dict[float, dict[float, float]] = {
    0.0: {1.5: 3.0205, 1.0: 2.1243, 0.5: 1.3394, 0.0: 0.6944, -0.25: 0.4349, -0.5: 0.2246, -0.75: 0.0727},
    0.25: {2.0: 3.6771, 1.5: 2.7408, 1.0: 1.8800, 0.5: 1.1221, 0.0: 0.5037, -0.25: 0.2638, -0.5: 0.0862},
}
"""Force over E* tilt b^2 of a flat-ended punch, indentation over tilt b; by k over tilt/b: boundary elements
(``oracles.boundary_elements``) of 128 and 256 points across, without the error of the grid to first order."""


@pytest.mark.parametrize("k", BY_ELEMENTS)
def test_a_tilted_flat_punch(k: float) -> None:
    """The load is too large, by 0.09 at most, and by 0.7 to 1.2 times 0.4 (1 - a)^(3/2), which is told."""
    for indentation, force in BY_ELEMENTS[k].items():

        def beyond(load: float, indentation: float = indentation) -> float:
            return held(load, 1.0, k)[2] - indentation

        load = brentq(beyond, 0.0, whole_edge(1.0, k), rtol=1e-12)
        error, told = 1.0 - force / (2.0 * load), 0.4 * (1.0 - held(load, 1.0, k)[0]) ** 1.5
        assert 0.0 < 2.0 * load * error < 0.09
        assert 0.7 * told < error < 1.2 * told


@pytest.mark.large
@settings(deadline=None, max_examples=50)
@given(st.floats(1e-3, 1.0), st.floats(0.01, 10.0), st.floats(0.0, 10.0))
def test_the_edge_holds_the_contact_of_least_indentation(share: float, tilt: float, k: float) -> None:
    """Against a search for the least over the radius, and over the centre by the parabola that it is in it."""
    load = share * whole_edge(tilt, k)
    a, c, indentation = held(load, tilt, k)

    def of(radius: float, across: float) -> float:
        return load / radius + 2.0 / 3.0 * k * radius**2 - across * tilt + k * across**2

    def least(radius: float) -> float:
        return of(radius, min(0.5 * tilt / max(k, 0.5 * tilt), 1.0 - radius**2))

    radii = np.linspace(1e-3, 1.0, 1000)
    near = radii[int(np.argmin([least(radius) for radius in radii]))]
    best = minimize_scalar(least, bounds=(max(near - 1e-3, 1e-4), min(near + 1e-3, 1.0)), options={"xatol": 1e-12})
    scale = abs(indentation) + tilt + k
    assert indentation == pytest.approx(min(best.fun, least(1.0)), abs=1e-9 * scale)
    assert indentation == pytest.approx(of(a, c), abs=1e-12 * scale)
    assert 0.0 <= c <= 1.0 - a * a + 1e-12
    nearer, farther = (held(load * (1.0 + step), tilt, k)[2] for step in (-1e-5, 1e-5))
    if share < 0.99:
        assert (farther - nearer) / (2e-5 * load) == pytest.approx(1.0 / a, rel=1e-4)


def test_the_whole_edge_is_that_of_a_contact_that_stays() -> None:
    for tilt, k in ((0.3, 0.0), (0.3, 0.7), (0.0, 0.7)):
        load = whole_edge(tilt, k)
        a, c, indentation = held(load, tilt, k)
        assert (a, c) == pytest.approx((1.0, 0.0), abs=1e-12)
        assert indentation == pytest.approx(level(load, k)[1], rel=1e-12)


def along(shape: Shape, x: Floats, curvature: float, tilt: float) -> dict[str, Floats]:
    """Contacts at each x, on one surface."""
    law, asperities = one(shape)
    rows = []
    for each in x:
        contacts = Contacts(*np.zeros((len(Contacts._fields), 1)))
        law.load_alone(np.array([each]), asperities, contacts)
        law.respond(asperities, np.array([[0.0], [0.6 * tilt], [-0.8 * tilt], [4.0 * curvature]]), contacts)
        rows.append([float(row[0]) for row in contacts])
    return dict(zip(Contacts._fields, np.array(rows).T, strict=True))


@pytest.mark.parametrize(("curvature", "tilt"), [(0.0, 0.02), (0.3, 0.02), (1e-3, 0.02), (0.3, 0.0), (0.2, 1.5)])
@pytest.mark.parametrize("name", EDGED)
def test_contacts_change_without_a_jump(name: str, curvature: float, tilt: float) -> None:
    """From before first touch on; the nearer the loads to each other, the nearer all else, and load only adds depth."""
    shape = EDGED[name]
    jumps = []
    for count in (200, 2000):
        x = np.linspace(-0.05, 0.4, count) ** 3
        found = along(shape, x, curvature, tilt)
        depth = x + found["lift"]
        assert (np.diff(depth) > 0.0).all()
        jumps.append(
            [
                np.abs(np.diff(found[key])).max()
                for key in ("load", "lift", "radius", "punch", "second_moment", "tilting")
            ]
        )
    assert (np.array(jumps[1]) <= 0.2 * np.array(jumps[0]) + 1e-15).all()


def three(**changes: object) -> xr.Dataset:
    """Three truncated paraboloids; the neighbours of the lowest tilt the surface under it by a twentieth."""
    given = {"radius": 1e3 * np.array([1.0, 1.2, 0.8]), "flat_radius": [1.0, 0.8, 0.6]} | changes
    place = {"x": [0.0, 3.6, 0.6], "y": [0.0, 0.9, 3.2]}
    return ensemble(given.pop("height"), 49.0, "truncated_paraboloid", **place, **given)


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("lowest", "separation", "force"),
    [(0.61, 0.5, 1.32238), (0.66, 0.5, 1.35194), (0.28, 0.0, 3.12459), (0.40, 0.0, 3.20662)],
)
def test_a_contact_on_a_part_of_its_flat(lowest: float, separation: float, force: float) -> None:
    """Boundary elements on grids of 300 and 450 points a side, without their error to first order (4e-5)."""
    made = three(height=1e-3 * np.array([1.0, 0.8, lowest]))
    found = rm.load_separation(
        made, separation=[1e-3 * separation], effective_modulus=1.0,
        interaction={"model": "pairwise", "boundary": "free"}, variables=["force", "model_error_curve"],
    )  # fmt: skip
    assert float(found.numerical_error) <= 1e-6
    off = abs(float(found.force[0]) / (1e-3 * force) - 1.0)
    assert off < 6e-4
    assert off < float(found.model_error_curve[0])


@pytest.mark.parametrize("name", EDGED)
def test_ensembles_come_to_rest_at_each_step(name: str) -> None:
    """Up to a third of the patch in contact, in other units too; the load grows with each step."""
    boundary = ["free", "periodic"]
    for seed in range(6):
        rng = np.random.default_rng([seed, len(name)])
        unit, count = 10.0 ** rng.uniform(-9.0, 0.0), int(rng.integers(4, 16))
        numbers = {"flat_radius": 1.0, "slope": 0.05, "radius": 20.0, "edge_radius": 20.0, "cap_radius": 60.0}
        numbers |= {"blend_radius": 1.0} if name == "capped_paraboloid" else {}
        numbers |= {"radius": 1.0} if name == "flat_punch" else {}
        given = {key: unit * value for key, value in numbers.items() if key in EDGED[name].parameters}
        given |= {"slope": 0.05} if name == "truncated_cone" else {}
        side = 7.0 * count**0.5
        cells = rng.permutation(int(count**0.5 + 1.0) ** 2)[:count]
        x, y = (np.array(np.divmod(cells, int(count**0.5 + 1.0))) + rng.uniform(0.0, 0.6, (2, count))) * side
        z = unit * rng.normal(0.0, 0.04, count)
        across = int(count**0.5 + 1.0)
        made = ensemble(
            z, (unit * side) ** 2, name, x=unit * x / across, y=unit * y / across, **given
        )  # fmt: skip
        down = float(z.max()) - unit * np.linspace(2e-3, 0.1, 12)
        law = rm.load_separation(
            made, separation=down, effective_modulus=3e6, variables=["force"],
            interaction={"model": "pairwise", "boundary": boundary[seed % 2]},
        )  # fmt: skip
        assert (np.diff(law.force.values) > 0.0).all()
        assert float(law.numerical_error) <= 1e-6
