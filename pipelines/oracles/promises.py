"""How far results for one asperity are from those of 60 digits, and what is promised (docs/trust.md)."""

from collections.abc import Mapping
from typing import NamedTuple

from oracles.dugdale import FIELDS, State
from oracles.dugdale_power_law import DugdalePowerLaw
from oracles.jkr import JkrPowerLaw
from oracles.multiprecision import Number, mp

Results = Mapping[str, float]  # the variables of rm.indent for one contact, by name
UNIT = mp.mpf(2) ** -53
_MIN, _MAX = mp.mpf("1e-299"), mp.mpf("1e299")
_ROUNDINGS = 32 * UNIT  # error of the control and of its two terms, with adhesion of finite range


class Judged(NamedTuple):
    """The error of one result."""

    error: float  # [1] relative to the natural scale of the quantity
    allowed: float

    @property
    def excess(self) -> float:
        """Above 1 the result is wrong."""
        return self.error / self.allowed


def representable(numbers: list[Number]) -> bool:
    """Return whether floats hold all the numbers, with a margin."""
    return all(_MIN < abs(number) < _MAX for number in numbers)


def natural_scales(exact: JkrPowerLaw) -> list[Number]:
    """Return what floats must hold of a contact under JKR adhesion: its folds; nothing without adhesion."""
    if not exact.work:
        return []
    grips, dead_load = exact.fold("indentation"), exact.fold("force")
    stiffness = 2 * exact.effective_modulus * grips
    forces = [exact.state(grips)["force"], exact.state(dead_load)["force"], stiffness * exact.dl(grips)]
    return [grips, exact.state(grips)["indentation"], stiffness, *forces]


def numbers_at(exact: JkrPowerLaw, a: Number) -> list[Number]:
    """Return what floats must hold of the contact with radius ``a``."""
    return [a * a, *exact.state(a).values()]


def judge(exact: JkrPowerLaw, control: str, got: Results) -> dict[str, Judged]:
    """Return the errors of a contact without adhesion or under JKR adhesion, except of what no float can hold."""
    branch = "force" if control == "force" else "indentation"
    value = mp.mpf(got[control])
    true = value if control == "contact_radius" else exact.radius(control, value)
    state, there, fold = (exact.state(a) for a in (true, mp.mpf(got["contact_radius"]), exact.fold(branch)))
    X = 1 - state[branch] / fold[branch] if exact.work else mp.mpf(1)
    forward = mp.mpf("1e-12") + mp.mpf("3e-16") / mp.sqrt(X)
    found = {
        "contact_radius": (abs(there["contact_radius"] - true) / true, forward, true),
        "contact_area": (abs(got["contact_area"] / (mp.pi * true**2) - 1), 2 * forward, true**2),
    }
    pressed = {"indentation": exact.g(true), "force": 2 * exact.effective_modulus * exact.reduced_load(true)}
    for name, compression in pressed.items():
        scale = max(abs(state[name]), abs(fold[name]))
        given = name == control or (name == "indentation" and control == "contact_radius")
        # Each of the four roundings that make a (of its scale, the growth, the product, and a itself) moves g by n u.
        steepness = max(1, 4 * exact.n * UNIT * compression / scale / mp.mpf("1e-14"))
        bound = mp.mpf("1e-14" if given else "1e-13") * steepness
        found[f"backward {name}"] = abs(there[name] - got[name]) / scale, bound, scale
        found[name] = abs(state[name] - got[name]) / scale, forward, scale
    k = state["stiffness"]
    k_error = abs(got["stiffness"] - k) / max(abs(k), 2 * exact.effective_modulus * true)
    found["stiffness"] = k_error, mp.mpf("1e-12") + mp.mpf("1e-15") / X, k
    return _as_floats(found)


def judge_dugdale(exact: DugdalePowerLaw, control: str, got: Results) -> dict[str, Judged]:
    """Return the errors of a contact under adhesion of finite range, except of what no float can hold."""
    branch, given_radius = "force" if control == "force" else "indentation", control == "contact_radius"
    value = mp.mpf(got[control])
    true = exact.at_radius(value) if given_radius else exact.retracted(control, value)
    X, rounded = distance(exact, branch, true), true
    if not given_radius:
        pressed = 2 * exact.effective_modulus * exact.jkr.reduced_load(true.a)
        compression = pressed if branch == "force" else exact.jkr.g(true.a)
        rounded = exact.retracted(control, value + _ROUNDINGS * (abs(value) + 2 * compression))
    forward = mp.mpf("1e-12") + (0 if given_radius else mp.mpf("1e-15") / mp.sqrt(X))
    rigid = 2 * exact.effective_modulus
    scales = {
        "contact_radius": true.c,
        "cohesive_radius": true.c,
        "indentation": max(abs(true.delta), abs(exact.pull_off("indentation").delta)),
        "force": max(abs(true.force), abs(exact.pull_off("force").force)),
        "stiffness": max(abs(true.stiffness), rigid * true.a),
    }
    found = {}
    for name, scale in scales.items():
        field = FIELDS.get(name, name)
        right = getattr(true, field)
        worth = abs(getattr(rounded, field) - right) / scale  # of the roundings of the control
        allowed = forward + worth
        if name == "stiffness":
            radius = (_ROUNDINGS if given_radius else allowed) * rigid * true.c / scale
            allowed = mp.mpf("1e-11") + mp.mpf("1e-14") / X + worth + radius
        found[name] = abs(mp.mpf(got[name]) - right) / scale, allowed, scale
    return _as_floats(found)


def distance(exact: DugdalePowerLaw, branch: str, state: State) -> Number:
    """Return the distance of the control to the end of its branch (unstable: to the pull-off), over the pull-off."""
    pull_off = exact.pull_off(branch)
    _, fold = exact.fold_below(branch, state.under(branch)) or (None, pull_off)
    return abs((state.under(branch) - fold.under(branch)) / pull_off.under(branch))


def _as_floats(found: Mapping[str, tuple[Number, Number, Number]]) -> dict[str, Judged]:
    """Return the errors and what is allowed of the quantities whose sizes, the third numbers, floats can hold."""
    return {
        name: Judged(float(error), float(allowed))
        for name, (error, allowed, size) in found.items()
        if representable([size])
    }
