"""The accuracy that DESIGN section 3 promises, at random parameters over the whole range a user may come with."""

from typing import NamedTuple

import numpy as np
import pytest
from twins import Real, Twin, mp

import roughmdr as rm

CONTROLS = ("indentation", "force", "contact_radius")
SHAPES = ("paraboloid", "cone", "power_law")
CASES = 30
VALUES = 6


class Case(NamedTuple):
    shape: rm.Paraboloid | rm.Cone | rm.PowerLaw
    modulus: float
    work: float

    @property
    def twin(self) -> Twin:
        return Twin(*self)


def draw(rng: np.random.Generator, kind: str, adhesive: bool) -> Case:
    width, rise = (10.0 ** rng.uniform(-10.0, 0.0, 2)).tolist()
    exponent = 0.5 + 10.0 ** rng.uniform(-2.0, 2.2999)
    coefficient = Twin(rm.PowerLaw(exponent=exponent, width=width, rise=rise), 1.0, 0.0).g_at_1
    if kind == "paraboloid":
        shape = rm.Paraboloid(radius=width)
    elif kind == "cone":
        shape = rm.Cone(slope=rise / width)
    elif rng.random() < 0.5 and coefficient < 1e300:
        shape = rm.PowerLaw(exponent=exponent, coefficient=rise / width**exponent)
    else:
        shape = rm.PowerLaw(exponent=exponent, width=width, rise=rise)
    return Case(shape, 10.0 ** rng.uniform(3.0, 13.0), 10.0 ** rng.uniform(-9.0, 1.0) if adhesive else 0.0)


def control_values(rng: np.random.Generator, twin: Twin, control: str, width: float) -> list[Real]:
    """At 1 - value/value at the fold (without adhesion: value/value at a = width) log-uniform in 1e-12 to 1e3."""
    law = twin.force if control == "force" else twin.indentation
    fold = twin.fold("force" if control == "force" else "indentation")
    distances = [mp.mpf(10) ** x for x in rng.uniform(-12.0, 3.0, VALUES)]
    values = [law(fold) * (1 - X) if twin.work else law(mp.mpf(width)) * X for X in distances]
    if control != "contact_radius":
        return values
    stable = [twin.radius("indentation", value) for value in values]
    return [*stable, fold * mp.mpf(rng.random())] if twin.work else stable


def scales(twin: Twin, answers: list[Real]) -> list[Real]:
    """All that a float must hold: the natural scales under both controls, and every answer."""
    natural = []
    if twin.work:
        held, dead = twin.fold("indentation"), twin.fold("force")
        natural = [held, twin.indentation(held), twin.force(held), 2 * twin.modulus * held, twin.force(dead)]
        natural.append(2 * twin.modulus * held * twin.stretch(held))
    return natural + [
        answer for a in answers for answer in (a, a * a, twin.indentation(a), twin.force(a), twin.stiffness(a))
    ]


def representable(numbers: list[Real]) -> bool:
    return all(mp.mpf("1e-299") < abs(number) < mp.mpf("1e299") for number in numbers)


def excesses(twin: Twin, control: str, got: dict[str, float]) -> dict[str, float]:
    """Each error over its bound."""
    law = {"indentation": twin.indentation, "force": twin.force}
    a = mp.mpf(got["contact_radius"])
    # Each of the four roundings that make a (of its scale, the growth, the product, and a itself) moves delta by n u.
    steep = max(1, 4 * twin.n * 2.0**-53 / 1e-14)
    fold = twin.fold("force" if control == "force" else "indentation")
    scale = {name: max(abs(mp.mpf(got[name])), abs(law[name](fold))) for name in law}
    bound = {"indentation": mp.mpf("1e-13"), "force": mp.mpf("1e-13")}
    bound["indentation" if control == "contact_radius" else control] = mp.mpf("1e-14")
    errors = {f"backward {name}": abs(law[name](a) - got[name]) / (scale[name] * bound[name] * steep) for name in law}
    own = "force" if control == "force" else "indentation"
    exact = a if control == "contact_radius" else twin.radius(control, got[control])
    X = 1 - law[own](exact) / law[own](fold) if twin.work else mp.mpf(1)
    forward = mp.mpf("1e-12") + mp.mpf("3e-16") / mp.sqrt(X)
    k, plain = twin.stiffness(exact), 2 * twin.modulus * exact
    errors["contact_radius"] = abs(a - exact) / (forward * exact)
    errors["contact_area"] = abs(got["contact_area"] - mp.pi * exact**2) / (2 * forward * exact**2 * mp.pi)
    for name, formula in law.items():
        errors[name] = abs(formula(exact) - got[name]) / (forward * scale[name])
    errors["stiffness"] = abs(got["stiffness"] - k) / ((mp.mpf("1e-12") + mp.mpf("1e-15") / X) * max(abs(k), plain))
    size = {"contact_radius": exact, "contact_area": exact**2, "stiffness": k, **scale}
    held = {name for name, number in size.items() if representable([number])}
    return {name: float(error) for name, error in errors.items() if name.removeprefix("backward ") in held}


@pytest.mark.parametrize("control", CONTROLS)
@pytest.mark.parametrize("adhesive", [False, True], ids=["elastic", "jkr"])
@pytest.mark.parametrize("kind", SHAPES)
def test_every_output_is_as_accurate_as_promised(kind: str, adhesive: bool, control: str) -> None:
    rng = np.random.default_rng([SHAPES.index(kind), adhesive, CONTROLS.index(control)])
    refused = 0
    for _ in range(CASES):
        case = draw(rng, kind, adhesive)
        twin = case.twin
        width = 10.0 ** rng.uniform(-10.0, 0.0) if kind != "power_law" else case.shape.width or 1.0
        exact_values = control_values(rng, twin, control, width)
        answers = exact_values
        if control != "contact_radius":
            answers = [twin.radius(control, value) for value in exact_values]
        values = [float(value) for value in exact_values]
        try:
            contact = rm.indent(case.shape, modulus=case.modulus, work=case.work, **{control: values})
        except rm.OutOfRange:
            assert not representable(scales(twin, answers)), case
            refused += 1
            continue
        for i in range(len(values)):
            got = {name: float(contact[name][i]) for name in contact.variables}
            for name, excess in excesses(twin, control, got).items():
                assert excess <= 1.0, (case, name, excess, got)
    assert refused < CASES / 2
