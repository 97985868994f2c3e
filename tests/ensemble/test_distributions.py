"""Distributions mean in a scene what they mean in scipy.stats; only mean and std move them."""

import math
import warnings
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
import scipy.stats
from command import said
from hypothesis import Phase, assume, given, settings, strategies as st
from scenes import ASPERITIES, scene

import roughmdr as rm
from roughmdr.ensemble.random.distribution_families import known_families
from roughmdr.scene import read

UM = 1e-6
SLOW = ("levy_stable", "studentized_range")  # seconds for a quantile
FAMILIES = [name for name in known_families() if name not in SLOW and hasattr(scipy.stats, name)]
LEVELS = np.array([0.03, 0.2, 0.5, 0.8, 0.97])
NOT_AT_ZERO = "its mean is not at z = 0"


@st.composite
def families(draw: st.DrawFn) -> tuple[str, dict[str, float]]:
    """A continuous distribution of scipy.stats with own parameters for which it is defined."""
    name = draw(st.sampled_from(FAMILIES))
    family = getattr(scipy.stats, name)
    names = [] if family.shapes is None else family.shapes.split(", ")
    number = st.one_of(st.floats(0.2, 8.0), st.floats(0.05, 0.95), st.floats(-4.0, -0.2), st.integers(1, 9).map(float))
    own = draw(st.tuples(*[number] * len(names)).filter(lambda numbers: bool(quiet(family._argcheck, *numbers))))
    return name, dict(zip(names, own, strict=True))


def quiet(function: Any, *arguments: Any, **named: Any) -> Any:
    """Call a function of scipy without its warnings."""
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        return function(*arguments, **named)


def contradicted(family: Any, own: tuple[float, ...], mean: float, variance: float) -> bool:
    """Return whether scipy's moments contradict its own quantiles (the inequalities of Markov and Chebyshev)."""
    for share in (1e-3, 1e-5, 1e-7, 1e-9):
        for end in (quiet(family.ppf, share, *own), quiet(family.isf, share, *own)):
            if math.isfinite(mean) and not share * (end - mean) ** 2 <= variance:
                return True
    return not quiet(family.support, *own)[0] <= mean <= quiet(family.support, *own)[1]


def generated(asperities: dict[str, Any], **options: int) -> tuple[Any, str]:
    """The ensemble, and its warnings."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        found = rm.generate(asperities, **options)
    return found, "\n".join(str(warning.message) for warning in caught)


class Asked(NamedTuple):
    """A distribution as a scene has it, and as scipy has it."""

    entry: dict[str, Any]
    twin: Any
    below: float
    """The level at which it is cut off."""
    mean_off_zero: bool
    wrong: bool
    """Whether scipy's moments cannot be right."""


def asked_for(family: tuple[str, dict[str, float]], by: str, of: str, unit: float, place: float) -> Asked:
    """The family by some of its parameters; cut off at a low level where asked, so that radii are above 0."""
    name, own = family
    scipy_family, height = getattr(scipy.stats, name), "height" in of
    mean, variance = map(float, quiet(scipy_family.stats, *own.values(), moments="mv"))
    try:
        wrong = contradicted(scipy_family, tuple(own.values()), mean, variance)
    except (ArithmeticError, RuntimeError, ValueError):  # of scipy, whose inverse leads nowhere
        assume(False)
    middle, size = mean if math.isfinite(mean) else 0.0, math.sqrt(variance) if 0.0 < variance < math.inf else 1.0
    moved = "mean" in by or "std" in by
    assume(not moved or (math.isfinite(mean) and 0.0 < variance < math.inf))
    scale = 2.5 * unit / size if "std" in by else 2.5 * unit
    entry: dict[str, Any] = {"distribution": name, **own, "std" if "std" in by else "scale": 2.5 * unit}
    loc = -scale * middle if by == "std" and height else 0.0
    if "loc" in by:
        entry["loc"] = loc = place * unit
    elif "mean" in by:
        entry["mean"], loc = place * unit, place * unit - scale * middle
    twin, below = quiet(scipy_family, *own.values(), loc=loc, scale=scale), 0.0
    if of == "radius cut off":
        entry["min"] = max(float(quiet(twin.ppf, 0.1)), 1e-3 * scale)
        below = float(quiet(twin.cdf, entry["min"]))
        assume(below < 0.9)
    return Asked(entry, twin, below, height and by == "own" and abs(middle) > 1e-9 * size, wrong)


_distributions = given(
    families(),
    st.sampled_from(["own", "own and loc", "scale and mean", "std", "std and mean", "std and loc"]),
    st.sampled_from(["height", "height of the second", "radius", "radius cut off"]),
    st.sampled_from([1e-9, 1e-6, 1.0]),
    st.floats(-3.0, 3.0),
)


@settings(deadline=None, max_examples=2, phases=[Phase.generate])  # to shrink takes minutes
@_distributions
def test_any_distribution_is_that_of_scipy(
    family: tuple[str, dict[str, float]], by: str, of: str, unit: float, place: float
) -> None:
    check_distribution(family, by, of, unit, place)


@pytest.mark.large
@settings(deadline=None, max_examples=100, phases=[Phase.generate])
@_distributions
def test_many_distributions_are_those_of_scipy(
    family: tuple[str, dict[str, float]], by: str, of: str, unit: float, place: float
) -> None:
    check_distribution(family, by, of, unit, place)


def check_distribution(family: tuple[str, dict[str, float]], by: str, of: str, unit: float, place: float) -> None:
    """Check that its quantiles are equal, and those of draws within their sampling error."""
    asked, height = asked_for(family, by, of, unit, place), "height" in of
    section = {**ASPERITIES, "height": "1 um", "radius": "50 um", "count": 400}
    if of == "height of the second":
        section["second"] = {"share": 1.0, "height": asked.entry}
    else:
        section["height" if of == "height" else "radius"] = asked.entry
    try:
        found, warned = generated(section, seed=5)
    except rm.SceneError as error:
        reasons = ["cannot be drawn from", "must be above 0", *(["no finite mean"] if asked.wrong else [])]
        assert any(reason in str(error) for reason in reasons)  # noqa: PT017
        assume(False)
    population = read(scene(asperities=section, path={"separation": [0.0]})).asperities.populations.members[-1]
    mine = (population.height if height else population.parameters["radius"]).quantile(LEVELS)
    near = 6.0 * np.sqrt(LEVELS * (1.0 - LEVELS) / 400)
    fractions = np.clip([LEVELS - near, LEVELS, LEVELS + near], 0.0, 1.0)
    least, known, most = quiet(asked.twin.ppf, asked.below + (1.0 - asked.below) * fractions)
    tiny = 1e-6 * np.abs(known) + 1e-6 * float(np.ptp(known))
    assert (np.abs(mine - known) <= tiny).all()
    drawn = np.quantile(found.height if height else found.radius, LEVELS, method="inverted_cdf")
    assert (drawn >= least - tiny).all()
    assert (drawn <= most + tiny).all()
    if not asked.wrong:
        assert (NOT_AT_ZERO in warned) == asked.mean_off_zero


@pytest.mark.parametrize("estimator", ["sampled", "stratified", "expected"])
def test_the_force_is_that_of_scipys_heights(estimator: str) -> None:
    """The force of Hertzian contacts, all pressed in, from the moment of the heights above the flat, without loc."""
    a, size, radius, effective_modulus = 2.0, 1e-6, 50e-6, 4e6
    section = {**ASPERITIES, "radius": radius, "height": {"distribution": "gamma", "a": a, "scale": size}}
    found = rm.run(
        {
            "material": {"effective_modulus": effective_modulus},
            "asperities": section,
            "path": {"separation": [0.0]},
            "output": {"variables": ["force"]},
            "batch": {"estimator": estimator, "realizations": 1 if estimator == "expected" else 64},
        }
    )
    moment = math.gamma(a + 1.5) / math.gamma(a) * size**1.5
    exact = 1000 * 4.0 / 3.0 * effective_modulus * math.sqrt(radius) * moment
    tolerance = {"sampled": 4.0 * 1.25 / math.sqrt(64_000), "stratified": 3e-3, "expected": 1e-9}
    assert float(found.force.mean()) == pytest.approx(exact, rel=tolerance[estimator])
    assert NOT_AT_ZERO in found.attrs["warnings"]


def test_multiples_of_sigma_are_from_z_0_all_the_same() -> None:
    height = {"distribution": "gamma", "a": 4.0, "scale": "1 um"}
    asked = read(scene(asperities={**ASPERITIES, "height": height}))
    assert asked.asperities.sigma == pytest.approx(2 * UM, rel=1e-14)
    assert asked.path.values(asked.asperities.sigma)[0] == pytest.approx(6 * UM, rel=1e-14)


OWN = {"distribution": "expon", "scale": "1 um"}
SAID = [{"loc": 0.0}, {"mean": 0.0}, {"mean": "1 um"}]


def test_heights_without_a_location_are_warned_of(tmp_path: Path) -> None:
    """By plan, run and generate; not where a location is given, nor for radii or heights that scipy centres."""
    table = scene(asperities={**ASPERITIES, "count": 20, "height": OWN}, batch={"realizations": 2})
    told = r"asperities\.height: expon .* loc = 0, and its mean is not at z = 0; say loc = 0 .*, or mean = 0"
    with pytest.warns(rm.LimitWarning, match=told):
        rm.run(table, tmp_path / "out.nc")
    with pytest.warns(rm.LimitWarning, match=told):
        rm.generate(table["asperities"], seed=1)
    for command in (["plan", "out.nc"], ["info", "out.nc"], ["run", "out.nc", "-o", "again.nc"]):
        assert "warning      asperities.height: expon" in said(*command, cwd=tmp_path)
    second = {"second": {"share": 0.1, "height": OWN}}
    assert "asperities.second.height: expon" in generated({**ASPERITIES, **second}, seed=1)[1]
    quiet_ones = [{"height": {**OWN, **each}} for each in SAID]
    quiet_ones += [{"height": {"distribution": "expon", "std": "1 um"}}]
    quiet_ones += [{"height": {"distribution": name, "scale": "1 um"}} for name in ("norm", "cauchy", "logistic")]
    quiet_ones += [{"radius": {"distribution": "expon", "scale": "1 um", "min": "1 nm"}}]
    for changes in quiet_ones:
        assert generated({**ASPERITIES, **changes}, seed=1)[1] == ""


def test_a_sweep_warns_once_with_the_number_of_cells() -> None:
    table = scene(asperities={**ASPERITIES, "count": 20, "height": OWN}, batch={"realizations": 1})
    found = rm.run({**table, "sweep": {"asperities.height.distribution": ["normal", "expon", "rayleigh"]}})
    told = [line for line in found.attrs["warnings"].splitlines() if NOT_AT_ZERO in line]
    assert len(told) == 2
    assert all(line.endswith("(in 1 of 3 cells)") for line in told)


@pytest.mark.parametrize("given_loc", [{"loc": 0.0}, {}])
def test_an_explicit_loc_changes_no_number(given_loc: dict[str, float]) -> None:
    """Results of a scene that says loc = 0 are those of one that leaves it out."""
    table = scene(asperities={**ASPERITIES, "count": 20, "height": {**OWN, **given_loc}}, batch={"realizations": 2})
    plain = rm.run(scene(asperities={**ASPERITIES, "count": 20, "height": OWN}, batch={"realizations": 2}))
    found = rm.run(table)
    assert found.cell_key.item() == plain.cell_key.item()
    np.testing.assert_array_equal(found.force, plain.force)


def test_a_scale_must_be_given() -> None:
    with pytest.raises(rm.SceneError, match="gamma needs a std or a scale"):
        rm.generate({**ASPERITIES, "height": {"distribution": "gamma", "a": 2.0}}, seed=1)


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("family", "mean"),
    [
        ({"distribution": "invweibull", "c": 0.45}, False),
        ({"distribution": "invweibull", "c": 1.5}, True),
        ({"distribution": "gengamma", "a": 6.589088322973744, "c": -0.2700305081750756}, True),
        ({"distribution": "gengamma", "a": 2.0, "c": -0.4}, False),
        ({"distribution": "kappa4", "h": -0.5812889286827593, "k": 2.0}, False),
    ],
)
def test_wrong_moments_of_scipy_are_rejected(family: dict[str, Any], mean: bool) -> None:
    """scipy gives gamma(1 - 1/c) as the mean of 1/x, for example, a number where the integral is infinite."""
    with pytest.raises(rm.SceneError, match="no finite mean and standard deviation"):
        rm.generate({**ASPERITIES, "height": {**family, "std": "1 um"}}, seed=1)
    height = read(scene(asperities={**ASPERITIES, "height": {**family, "scale": 1.0}}, path={"separation": [0.0]}))
    assert math.isnan(height.asperities.sigma)
    assert math.isfinite(height.asperities.height.mean) == mean
    with pytest.raises(rm.SceneError, match="cannot be given in sigma: the heights' standard deviation is nan m"):
        read(scene(asperities={**ASPERITIES, "height": {**family, "scale": 1.0}}))
