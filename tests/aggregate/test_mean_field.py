"""The mean field: its coefficient by sums and quadrature, the force by an independent root, and where it has none."""

import math
from typing import Any

import numpy as np
import pytest
from oracles.pairwise import periodic_green
from scenes import ASPERITIES, ensemble, scene
from scipy.integrate import dblquad
from scipy.optimize import brentq

import roughmdr as rm
from roughmdr.aggregate.mean_field import coupling_of, mean_inverse_distance, shift
from roughmdr.ensemble.patch_source import LATTICE_CONSTANTS
from roughmdr.interaction import Interaction

E = 4e6
FREE, PERIODIC = (Interaction(model="mean_field", boundary=boundary) for boundary in ("free", "periodic"))
SECTION = {**ASPERITIES, "count": 400, "radius": "50 um"}
PATH = np.linspace(3e-6, -1e-6, 30)


def test_the_mean_distance_on_a_square_is_its_closed_form() -> None:
    closed = 4.0 / 3.0 * (1.0 - math.sqrt(2.0) + 3.0 * math.log(1.0 + math.sqrt(2.0)))
    assert closed == pytest.approx(2.97321, abs=5e-6)
    assert mean_inverse_distance(1.0, 1.0) == pytest.approx(closed, rel=1e-14)
    assert mean_inverse_distance(1e-6, 1e-6) == pytest.approx(closed * 1e6, rel=1e-14)
    assert coupling_of(FREE, E, (2.0, 2.0), 0.1) == pytest.approx(0.94640 / (2.0 * E), rel=1e-5)


@pytest.mark.parametrize("ratio", [1.0, 0.5, 0.1])
def test_the_mean_distance_on_a_rectangle_is_that_of_quadrature(ratio: float) -> None:
    """In polar coordinates the integrand, (a - x)(b - y) of the differences, has no pole."""

    def integrand(r: float, angle: float) -> float:
        return (1.0 - r * math.cos(angle)) * (ratio - r * math.sin(angle))

    def far(angle: float) -> float:
        return min(1.0 / math.cos(angle), ratio / math.sin(angle) if angle > 0.0 else math.inf)

    corner = math.atan(ratio)
    parts = [
        dblquad(integrand, *ends, 0.0, far, epsabs=1e-14, epsrel=1e-13)[0]
        for ends in ((0.0, corner), (corner, 0.5 * math.pi - 1e-15))
    ]
    assert mean_inverse_distance(1.0, ratio) == pytest.approx(4.0 * sum(parts) / ratio**2, rel=1e-10)
    assert mean_inverse_distance(ratio, 1.0) == mean_inverse_distance(1.0, ratio)


def test_a_long_strip_has_no_cancellation() -> None:
    """For t -> 0 the mean is that of 1/r on a line cut off at the width: 2 (ln(2/t) + 1/2 - 2/3 ...)."""
    thin = [mean_inverse_distance(1.0, t) for t in (1e-8, 1e-12)]
    assert thin[1] - thin[0] == pytest.approx(2.0 * math.log(1e4), rel=1e-7)


@pytest.mark.large
def test_the_constant_of_the_hexagonal_lattice_is_its_ewald_sum() -> None:
    """A patch of n x m cells of two sites, nearly square: the square's sum converges to that of the lattice."""
    for rows, columns in ((8, 7), (22, 19)):
        row, column = np.divmod(np.arange(rows * columns), columns)
        across, along = (column + 0.5 * (row % 2)) / columns, row / rows
        total = float(periodic_green(across, along, 1.0, 1.0)[0].sum()) * math.pi / math.sqrt(rows * columns)
        assert total == pytest.approx(-LATTICE_CONSTANTS["hexagonal"], rel=2e-4)
    (own,) = periodic_green(np.zeros(1), np.zeros(1), 1.0, 1.0)[0]
    assert own * math.pi == pytest.approx(-LATTICE_CONSTANTS["square"], rel=1e-8)


def test_of_a_lattice_the_mean_field_is_the_field_of_all_sites() -> None:
    section = {**SECTION, "placement": "hexagonal", "count": 56, "vacancies": True}
    placed = rm.generate(section, seed=1)
    green = periodic_green(placed.x.to_numpy(), placed.y.to_numpy(), 1e-3, E)
    distance = float(placed.attrs["exclusion_distance"])
    assert coupling_of(PERIODIC, E, (1e-3, 1e-3), distance) == pytest.approx(green[0].sum() / 56, rel=1e-3)


@pytest.mark.large
@pytest.mark.parametrize(
    ("spacings", "within"),
    [
        (0.0, 0.0),
        pytest.param(0.3, 0.1, marks=pytest.mark.large),
        (0.5, 0.15),
        pytest.param(0.7, 0.35, marks=pytest.mark.large),
    ],
)
def test_of_a_hard_core_the_mean_field_is_the_mean_over_the_others(spacings: float, within: float) -> None:
    count, found = 300, []
    for seed in range(20):
        placement = (
            {"placement": "hard_core", "min_distance": spacings * 1e-3 / count**0.5} if spacings else
            {"placement": "random"}
        )  # fmt: skip
        placed = rm.generate({**SECTION, "count": count, **placement}, seed=seed)
        green = periodic_green(placed.x.to_numpy(), placed.y.to_numpy(), 1e-3, E)
        np.fill_diagonal(green, 0.0)
        found.append(green.sum() / count / (count - 1))
    distance = spacings * 1e-3 / count**0.5
    mean, error = np.mean(found), np.std(found) / math.sqrt(len(found))
    assert abs(mean - coupling_of(PERIODIC, E, (1e-3, 1e-3), distance)) < 4.0 * error + within * abs(mean)


def solved(asperities: Any, interaction: Any, **arguments: Any) -> Any:
    return rm.load_separation(asperities, separation=PATH, effective_modulus=E, interaction=interaction, **arguments)


@pytest.mark.parametrize("boundary", ["free", "periodic"])
def test_the_force_is_that_of_independent_asperities_at_the_shifted_separation(boundary: str) -> None:
    asperities = rm.generate({**SECTION, "placement": "hexagonal"}, seed=2)
    names = ["force", "contact_area", "contact_count", "stiffness", "energy", "contact_radius_sum", "pressure"]
    curve = solved(asperities, {"model": "mean_field", "boundary": boundary}, variables=names)
    distance = float(asperities.attrs["exclusion_distance"])
    sides = asperities.attrs["patch_x"], asperities.attrs["patch_y"]
    c = coupling_of(Interaction(model="mean_field", boundary=boundary), E, sides, distance)  # type: ignore[arg-type]
    assert (c > 0.0) == (boundary == "free")
    radius, height = 5e-5, asperities.height.to_numpy()

    def independent(s: float) -> float:
        return math.fsum(4.0 / 3.0 * E * math.sqrt(radius) * np.maximum(height - s, 0.0) ** 1.5)

    for h, force in zip(PATH.tolist(), curve.force.values.tolist(), strict=True):
        most = independent(h) if c > 0.0 else 2.0 * independent(h)
        root = brentq(lambda f, h=h: f - independent(h + c * f), 0.0, most or 1.0, xtol=1e-300, rtol=1e-14)
        assert force == pytest.approx(root, rel=3e-12)
    there = rm.load_separation(
        asperities, separation=PATH + c * curve.force.values, effective_modulus=E, variables=names
    )
    for name in ("force", "contact_area", "contact_count", "contact_radius_sum"):
        np.testing.assert_allclose(curve[name], there[name], rtol=1e-11)
    np.testing.assert_allclose(curve.stiffness, there.stiffness / (1.0 + c * there.stiffness), rtol=1e-11)
    np.testing.assert_allclose(curve.energy, there.energy + 0.5 * c * there.force**2, rtol=1e-10)
    np.testing.assert_array_equal(curve.separation, PATH)
    assert 0.0 < float(curve.numerical_error) < 1e-11
    assert "overlap_count" not in curve


def test_stiffness_and_energy_belong_to_the_force() -> None:
    asperities = rm.generate(SECTION, seed=3)
    fine = np.linspace(2e-6, 0.0, 2001)
    names = ["force", "stiffness", "energy"]
    curve = rm.load_separation(
        asperities, separation=fine, effective_modulus=E, variables=names,
        interaction={"model": "mean_field", "boundary": "free"},
    )  # fmt: skip
    slope = -np.gradient(curve.force.values, fine, edge_order=2)
    np.testing.assert_allclose(curve.stiffness[1:-1], slope[1:-1], rtol=1e-3, atol=1e-3 * slope.max())
    work = np.trapezoid(curve.force.values, -fine)
    assert float(curve.energy[-1] - curve.energy[0]) == pytest.approx(work, rel=1e-6)


def test_without_a_coupling_nothing_changes() -> None:
    asperities = rm.generate(SECTION, seed=1)
    np.testing.assert_array_equal(solved(asperities, "mean_field").force, solved(asperities, None).force)
    few = rm.generate({**SECTION, "count": 5, "patch": "1 m"}, seed=1)
    free, alone = solved(few, {"model": "mean_field", "boundary": "free"}), solved(few, None)
    np.testing.assert_allclose(free.force, alone.force, rtol=1e-4)
    assert (free.force <= alone.force).all()


def test_in_other_units_the_law_is_the_same() -> None:
    curves = []
    for unit, modulus in ((1.0, 1.0), (1e-9, 1e12), (1e3, 1e-3)):
        asperities = ensemble(np.array([1.0, 0.7, 0.2]) * unit, 900.0 * unit * unit, radius=50.0 * unit)
        asperities.attrs["exclusion_distance"] = 3.0 * unit
        for boundary in ("free", "periodic"):
            curve = rm.load_separation(
                asperities, separation=np.array([0.9, 0.5, 0.0]) * unit, effective_modulus=modulus,
                interaction={"model": "mean_field", "boundary": boundary},
            )  # fmt: skip
            curves.append(curve.force.values / (modulus * unit * unit))
    for curve in curves[2:]:
        assert min(np.abs(curve / curves[number] - 1.0).max() for number in (0, 1)) < 1e-11


def test_where_the_contacts_are_stiffer_than_the_surface_there_is_no_equilibrium() -> None:
    """F = k0 (s - h0 ...): linear springs of stiffness k under c < 0 have one only while |c| k < 1."""

    def springs(s: Any) -> tuple[Any, Any]:
        return 3.0 * np.maximum(1.0 - s, 0.0), np.where(s < 1.0, 3.0, 0.0)

    found = shift(springs, np.array([1.5, 1.0, 0.5]), -0.2)
    np.testing.assert_allclose(found.force, [0.0, 0.0, 3.0 * 0.5 / (1.0 - 0.6)], rtol=1e-13)
    with pytest.raises(rm.OutOfRange, match=r"no equilibrium at a separation of 0\.5 m"):
        shift(springs, np.array([1.5, 0.5, 0.4]), -0.34)
    crowded = ensemble(np.zeros(100), 1e-8, radius=1e-3)
    crowded.attrs["exclusion_distance"] = 1e-5
    with pytest.raises(rm.OutOfRange, match="mean_field"):
        rm.load_separation(crowded, separation=-1e-7, effective_modulus=E, interaction="mean_field")


@pytest.mark.few(1)
@pytest.mark.parametrize("boundary", ["free", "periodic"])
def test_the_expected_law_is_the_mean_of_many_large_realisations(boundary: str) -> None:
    """The mean field is that of the force of all: of large ensembles, whose forces hardly differ, both are one law."""
    table = scene(
        material={"effective_modulus": E},
        adhesion=None,
        asperities={**ASPERITIES, "count": 20_000, "patch": "3 mm", "placement": "hexagonal"},
        interaction={"model": "mean_field", "boundary": boundary},
        path={"separation": ["2 sigma", "1 sigma", "0.5 sigma"]},
        batch={"realizations": 1, "estimator": "expected"},
        output={"variables": ["force", "contact_area", "stiffness"]},
    )
    expected = rm.run(table).squeeze("realization")
    drawn = rm.run({**table, "batch": {"realizations": 20, "estimator": "stratified"}})
    alone = rm.run({key: value for key, value in table.items() if key != "interaction"}).squeeze("realization")
    for name in ("force", "contact_area", "stiffness"):
        mean, sem = drawn[name].mean("realization"), drawn[name].std("realization", ddof=1) / math.sqrt(20)
        assert (abs(mean - expected[name]) < 5.0 * sem + 1e-5 * mean).all(), name
    assert (abs(alone.force / expected.force - 1.0) > 1e-3).any()
    assert (expected.numerical_error < 1e-8).all()
