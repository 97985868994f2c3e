"""The accuracy that DESIGN section 3 promises, at random parameters over the whole range a user may come with."""

from typing import NamedTuple

import numpy as np
import pytest
from oracles.jkr import JkrPowerLaw, PowerShape
from oracles.multiprecision import Number, mp
from oracles.promises import judge, natural_scales, numbers_at, representable

import roughmdr as rm

CONTROLS = ("indentation", "force", "contact_radius")
SHAPES = ("paraboloid", "cone", "power_law")
CASES = 30
VALUES = 6


class Case(NamedTuple):
    shape: PowerShape
    effective_modulus: float
    work: float

    @property
    def exact(self) -> JkrPowerLaw:
        return JkrPowerLaw(*self)


def draw(rng: np.random.Generator, kind: str, adhesive: bool) -> Case:
    width, rise = (10.0 ** rng.uniform(-10.0, 0.0, 2)).tolist()
    exponent = 0.5 + 10.0 ** rng.uniform(-2.0, 2.2999)
    coefficient = JkrPowerLaw(rm.PowerLaw(exponent=exponent, width=width, rise=rise), 1.0, 0.0).g_at_1
    if kind == "paraboloid":
        shape = rm.Paraboloid(radius=width)
    elif kind == "cone":
        shape = rm.Cone(slope=rise / width)
    elif rng.random() < 0.5 and coefficient < 1e300:
        shape = rm.PowerLaw(exponent=exponent, coefficient=rise / width**exponent)
    else:
        shape = rm.PowerLaw(exponent=exponent, width=width, rise=rise)
    return Case(shape, 10.0 ** rng.uniform(3.0, 13.0), 10.0 ** rng.uniform(-9.0, 1.0) if adhesive else 0.0)


def control_values(rng: np.random.Generator, exact: JkrPowerLaw, control: str, width: float) -> list[Number]:
    """At 1 - value/value at the fold (without adhesion: value/value at a = width) log-uniform in 1e-12 to 1e3."""
    branch = "force" if control == "force" else "indentation"
    fold = exact.fold(branch)
    distances = [mp.mpf(10) ** x for x in rng.uniform(-12.0, 3.0, VALUES)]
    unit = exact.state(fold if exact.work else mp.mpf(width))[branch]
    values = [unit * (1 - X if exact.work else X) for X in distances]
    if control != "contact_radius":
        return values
    stable = [exact.radius("indentation", value) for value in values]
    return [*stable, fold * mp.mpf(rng.random())] if exact.work else stable


@pytest.mark.few(1)
@pytest.mark.parametrize("control", CONTROLS)
@pytest.mark.parametrize("adhesive", [False, True], ids=["elastic", "jkr"])
@pytest.mark.parametrize("kind", SHAPES)
def test_every_output_is_as_accurate_as_promised(kind: str, adhesive: bool, control: str) -> None:
    rng = np.random.default_rng([SHAPES.index(kind), adhesive, CONTROLS.index(control)])
    refused = 0
    for _ in range(CASES):
        case = draw(rng, kind, adhesive)
        exact = case.exact
        width = 10.0 ** rng.uniform(-10.0, 0.0) if kind != "power_law" else case.shape.width or 1.0
        exact_values = control_values(rng, exact, control, width)
        answers = exact_values
        if control != "contact_radius":
            answers = [exact.radius(control, value) for value in exact_values]
        values = [float(value) for value in exact_values]
        try:
            contact = rm.indent(
                case.shape, effective_modulus=case.effective_modulus, work=case.work, **{control: values}
            )
        except rm.OutOfRange:
            needed = [*natural_scales(exact), *(number for a in answers for number in numbers_at(exact, a))]
            assert not representable(needed), case
            refused += 1
            continue
        for i in range(len(values)):
            got = {name: float(contact[name][i]) for name in contact.variables}
            for name, judged in judge(exact, control, got).items():
                assert judged.excess <= 1.0, (case, name, judged, got)
    assert refused < CASES / 2
