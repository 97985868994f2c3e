"""How far answers for one asperity are from those of 60 digits, and what is promised (README, How right, how fast)."""

from collections.abc import Mapping
from typing import NamedTuple

from cohesive_twin import CohesiveTwin, State
from twins import Real, Twin, mp

Answers = Mapping[str, float]
"""What ``rm.indent`` says of one contact, by name."""
UNIT = mp.mpf(2) ** -53
_LEAST, _LARGEST = mp.mpf("1e-299"), mp.mpf("1e299")
_ROUNDINGS = 32 * UNIT  # of the control and the two terms that it is the difference of, where adhesion has a range


class Judged(NamedTuple):
    """One answer."""

    error: float
    """Over the natural scale of what it is the answer for."""
    allowed: float

    @property
    def excess(self) -> float:
        """Above 1 it is wrong."""
        return self.error / self.allowed


def representable(numbers: list[Real]) -> bool:
    """Whether floats hold all of them, with a little to spare."""
    return all(_LEAST < abs(number) < _LARGEST for number in numbers)


def natural_scales(twin: Twin) -> list[Real]:
    """What a float must hold of a contact under JKR adhesion: its folds under both controls; none without adhesion."""
    if not twin.work:
        return []
    held, dead = twin.fold("indentation"), twin.fold("force")
    return [
        held,
        twin.indentation(held),
        twin.force(held),
        2 * twin.effective_modulus * held,
        twin.force(dead),
        2 * twin.effective_modulus * held * twin.stretch(held),
    ]


def answers_at(twin: Twin, a: Real) -> list[Real]:
    """What a float must hold of the contact with radius ``a``."""
    return [a, a * a, twin.indentation(a), twin.force(a), twin.stiffness(a)]


def judge(twin: Twin, control: str, got: Answers) -> dict[str, Judged]:
    """The answers of a contact without adhesion or under JKR adhesion; those that no float can hold are left out."""
    law = {"indentation": twin.indentation, "force": twin.force}
    own = "force" if control == "force" else "indentation"
    a, value, fold = mp.mpf(got["contact_radius"]), mp.mpf(got[control]), twin.fold(own)
    exact = value if control == "contact_radius" else twin.radius(control, value)
    pressed = {
        "indentation": twin.g(exact),
        "force": 2 * twin.effective_modulus * (exact * twin.g(exact) - twin.G(exact)),
    }
    scale = {name: max(abs(formula(exact)), abs(formula(fold))) for name, formula in law.items()}
    bound = {"indentation": mp.mpf("1e-13"), "force": mp.mpf("1e-13")}
    bound["indentation" if control == "contact_radius" else control] = mp.mpf("1e-14")
    found = {}
    for name, formula in law.items():
        # Each of the four roundings that make a (of its scale, the growth, the product, and a itself) moves g by n u.
        steep = max(1, 4 * twin.n * UNIT * pressed[name] / scale[name] / mp.mpf("1e-14"))
        found[f"backward {name}"] = abs(formula(a) - got[name]) / scale[name], bound[name] * steep
    X = 1 - law[own](exact) / law[own](fold) if twin.work else mp.mpf(1)
    forward = mp.mpf("1e-12") + mp.mpf("3e-16") / mp.sqrt(X)
    k, plain = twin.stiffness(exact), 2 * twin.effective_modulus * exact
    found["contact_radius"] = abs(a - exact) / exact, forward
    found["contact_area"] = abs(got["contact_area"] / (mp.pi * exact**2) - 1), 2 * forward
    for name, formula in law.items():
        found[name] = abs(formula(exact) - got[name]) / scale[name], forward
    k_error = abs(got["stiffness"] - k) / max(abs(k), plain)
    found["stiffness"] = k_error, mp.mpf("1e-12") + mp.mpf("1e-15") / X
    size = {"contact_radius": exact, "contact_area": exact**2, "stiffness": k, **scale}
    return _floats(found, {name for name, number in size.items() if representable([number])})


def judge_cohesive(twin: CohesiveTwin, control: str, got: Answers) -> dict[str, Judged]:
    """The answers of a contact under adhesion of finite range."""
    own = "force" if control == "force" else "indentation"
    sought = control != "contact_radius"
    value = mp.mpf(got[control])
    exact = twin.answer(control, value) if sought else twin.at_radius(value)
    X, moved = distance(twin, own, exact), [exact]
    if sought:
        slack = _ROUNDINGS * (abs(value) + 2 * twin.compression(own, exact))
        moved.append(twin.answer(control, value + slack))
    forward = mp.mpf("1e-12") + (mp.mpf("1e-15") / mp.sqrt(X) if sought else 0)
    rigid = 2 * twin.plain.effective_modulus
    size = {
        "contact_radius": exact.cohesive_radius,
        "cohesive_radius": exact.cohesive_radius,
        "indentation": max(abs(exact.indentation), abs(twin.pull_off("indentation").indentation)),
        "force": max(abs(exact.force), abs(twin.pull_off("force").force)),
        "stiffness": max(abs(exact.stiffness), rigid * exact.contact_radius),
    }
    found = {}
    for name, scale in size.items():
        worth = max(abs(getattr(state, name) - getattr(exact, name)) for state in moved) / scale
        allowed = forward + worth
        if name == "stiffness":
            radius = (forward + worth if sought else _ROUNDINGS) * rigid * exact.cohesive_radius / scale
            allowed = mp.mpf("1e-11") + mp.mpf("1e-14") / X + worth + radius
        found[name] = abs(mp.mpf(got[name]) - getattr(exact, name)) / scale, allowed
    return _floats(found, {name for name, scale in size.items() if representable([scale])})


def foot_of(twin: CohesiveTwin, own: str, state: State) -> State:
    """Where the branch of a state ends on the way back; of an unstable one the pull-off."""
    return next((foot for foot in twin.feet[own] if foot.under(own) <= state.under(own)), twin.pull_off(own))


def distance(twin: CohesiveTwin, own: str, state: State) -> Real:
    """How far the control is from where the branch of a state ends, over that of the pull-off to 0."""
    return abs((state.under(own) - foot_of(twin, own, state).under(own)) / twin.pull_off(own).under(own))


def _floats(found: Mapping[str, tuple[Real, Real]], held: set[str]) -> dict[str, Judged]:
    """The judgements on what floats can hold."""
    return {
        name: Judged(float(error), float(allowed))
        for name, (error, allowed) in found.items()
        if name.removeprefix("backward ") in held
    }
