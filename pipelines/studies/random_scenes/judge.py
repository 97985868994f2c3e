"""What must be true of any scene: it is refused in words, or its numbers are finite and as physics says."""

import math
import re
import warnings
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
import tomli_w
import xarray as xr
from numpy.typing import NDArray
from random_scenes_laws import DONE, PUSHING, ROUNDING, Law, excursions, laws_of

import roughmdr as rm
from roughmdr import errors
from roughmdr.errors import FailedRuns, LimitWarning, RoughmdrError, Unfinished
from roughmdr.scene import Scene, read

COMPUTED, FAILED, REFUSED = OUTCOMES = ("computed", "a run failed", "refused")
_GROWING = ("contact_area", "contact_count", "contact_radius_sum")
_FOLDERS = re.compile(r"/\S*/|\bscene: ")
_NUMBERS = re.compile(r"[-+]?\d[\w.+-]*|'[^']*'|\([^)]*\)")


class Defect(AssertionError):  # noqa: N818 - it is what is looked for
    """What no scene may lead to."""


class Verdict(NamedTuple):
    """What became of a scene."""

    outcome: str
    reason: str = ""
    comparisons: int = 0
    """How many pairs of numbers were held against each other."""


class Claims:
    """Claims about numbers, counted."""

    def __init__(self) -> None:
        self.made = 0

    def hold(self, what: str, holds: NDArray[np.bool_] | bool) -> None:
        """Defect unless all of them hold."""
        found = np.asarray(holds)
        self.made += found.size
        if not found.all():
            raise Defect(f"{what}: not so at {np.argwhere(~np.atleast_1d(found))[0].tolist()}")


def judge(table: dict[str, Any]) -> Verdict:
    """Run a scene in memory and look at what comes of it; Defect, with the scene in TOML, where that is wrong."""
    try:
        return _judged(table)
    except Defect as defect:
        raise Defect(f"{defect}\n\n{tomli_w.dumps(table)}") from defect.__cause__


def _judged(table: dict[str, Any]) -> Verdict:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            warnings.simplefilter("ignore", LimitWarning)
            warnings.simplefilter("ignore", FailedRuns)
            scene = read(table)
            result = rm.run(scene, workers=1)
    except Unfinished as error:
        raise Defect(f"an unhandled exception in a run: {error}") from error
    except RoughmdrError as error:
        return Verdict(REFUSED, reason_of(f"{type(error).__name__}: {error}"))
    except Exception as error:
        raise Defect(f"an unhandled {type(error).__name__}: {error}") from error
    claims = check(result, scene)
    failed = result.status.to_numpy() == 1
    if failed.any():
        return Verdict(FAILED, reason_of(str(result.remark.to_numpy()[failed][0])), claims.made)
    return Verdict(COMPUTED, comparisons=claims.made)


def reason_of(message: str) -> str:
    """A refusal without its numbers, so that those of one kind can be counted."""
    return _NUMBERS.sub("#", _FOLDERS.sub("", message.partition("\n")[0]))[:120]


def check(result: xr.Dataset, scene: Scene) -> Claims:
    """Hold a result against what must be true of it; Defect where it is not."""
    claims = Claims()
    _hold_numbers(claims, result)
    laws = list(laws_of(result, scene))
    for law in laws:
        _hold_identities(claims, law)
        if law.scene.work > 0.0:
            _hold_with_adhesion(claims, law)
        else:
            _hold_without_adhesion(claims, law)
    if scene.accuracy is None:
        _hold_over_work(claims, scene, laws)
    else:
        missed = result.variables["accuracy_reached"].values > scene.accuracy.relative
        claims.hold("an error that is missed is told of", ~missed | ("was not reached" in str(result.attrs)))
    return claims


def _hold_numbers(claims: Claims, result: xr.Dataset) -> None:
    """Nothing is infinite; what was computed is a number; a run that was not says why, in words of its own."""
    status = result.variables["status"].values
    for name, variable in result.variables.items():
        values = variable.values
        if values.dtype.kind != "f":
            continue
        claims.hold(f"{name} is not infinite", ~np.isinf(values))
        if "step" in variable.dims and name != "separation" and not str(name).endswith("_sem"):
            claims.hold(f"{name} is a number", ~np.isnan(values) | (status != DONE)[..., None])
    error = result.variables["numerical_error"].values
    claims.hold("an error is a number, and not negative", (error >= 0.0) | (status != DONE))
    for remark in result.variables["remark"].values[status == 1] if "remark" in result.coords else ():
        names = [part for part in str(remark).split(": ") if isinstance(getattr(errors, part, None), type)]
        expected = bool(names) and issubclass(getattr(errors, names[0]), RoughmdrError)
        claims.hold(f"a run fails for a reason, not with {remark}", expected)


def _hold_identities(claims: Claims, law: Law) -> None:
    """What holds at every step of its own."""
    curves = law.curves
    for name in (*_GROWING, "contact_fraction"):
        if name in curves:
            claims.hold(f"{name} is not negative", curves[name] >= -law.slack(name) * law.expected)
    if law.drawn and "contact_count" in curves:
        count = curves["contact_count"]
        claims.hold("contact_count is whole", count == np.round(count))
        gone = ["contact_area", "contact_radius_sum", "contact_fraction"]
        if not law.far_reaching:
            gone += ["force", "pressure", "stiffness", "energy"]
        for name in gone:
            if name in curves:
                claims.hold(f"no contact, no {name}", curves[name][count == 0.0] == 0.0)
    area = law.scene.asperities.nominal_area
    for ratio, whole in (("pressure", "force"), ("contact_fraction", "contact_area")):
        if ratio in curves and whole in curves and area:
            with np.errstate(under="ignore"):
                same = np.isclose(curves[ratio], curves[whole] / area, rtol=ROUNDING, atol=1e-300)
            claims.hold(f"{ratio} is {whole} over the nominal area", same)
    if not law.drawn and not law.expected:
        for name, (mean, least, most) in ((name, rows) for name, rows in curves.items() if len(rows)):
            slack = law.slack(name)[1:].max()
            claims.hold(f"the mean of {name} is no extreme", (least - slack <= mean) & (mean <= most + slack))
    if law.drawn and {"contact_area", "contact_radius_sum", "contact_count"} <= curves.keys():
        one = np.sqrt(curves["contact_area"] / math.pi)
        total, count = curves["contact_radius_sum"], curves["contact_count"]
        known = curves["contact_area"] > 1e-290
        inside = (one * (1.0 - ROUNDING) <= total) & (total <= one * np.sqrt(count) * (1.0 + ROUNDING))
        claims.hold("radii and areas go together", inside[known])


def _hold_without_adhesion(claims: Claims, law: Law) -> None:
    """No memory: all grows as the flat comes down, the force between the lines that the stiffness draws."""
    order = np.argsort(-law.separation, kind="stable")
    down = -np.diff(law.separation[order])
    curves = {name: values[:, order] for name, values in law.curves.items()}
    for name, values in curves.items():
        if name == "dissipated_energy":
            claims.hold("nothing is lost without adhesion", values == 0.0)
            continue
        rises, slack = np.diff(values, axis=1), 2.0 * law.slack(name)
        claims.hold(f"{name} does not fall as the flat comes down", rises >= -slack)
        if not law.expected:
            claims.hold(f"{name} has no memory", rises[:, down == 0.0] == 0.0)
        claims.hold(f"{name} is not negative", values >= -0.5 * slack)
    if {"force", "stiffness"} <= curves.keys() and (law.drawn or law.expected):
        force, stiffness, slack = curves["force"], curves["stiffness"], 2.0 * law.slack("force")
        with np.errstate(over="ignore", under="ignore"):
            least, most = stiffness[:, :-1] * down, stiffness[:, 1:] * down
        room = slack + 1e-9 * most
        claims.hold(
            "force and stiffness agree",
            (np.diff(force, axis=1) >= least - room) & (np.diff(force, axis=1) <= most + room),
        )
    if {"contact_radius_sum", "stiffness"} <= curves.keys():
        exact = 2.0 * law.scene.effective_modulus * curves["contact_radius_sum"]
        same = np.abs(curves["stiffness"] - exact) <= np.maximum(
            2.0 * ROUNDING * exact, law.expected * 2.0 * law.slack("stiffness")
        )
        claims.hold("stiffness is 2 E* times the sum of the radii", same)


def _hold_with_adhesion(claims: Claims, law: Law) -> None:
    """Contacts grow as the flat comes down and shrink as it rises; whoever held on more is larger, and pulls more."""
    way = np.diff(law.separation)
    for name in (*_GROWING, "contact_fraction"):
        if name in law.curves:
            rises, slack = np.diff(law.curves[name], axis=1), 2.0 * law.slack(name)
            claims.hold(f"{name} does not fall as the flat comes down", rises[:, way <= 0.0] >= -slack)
            claims.hold(f"{name} does not rise as the flat does", rises[:, way >= 0.0] <= slack)
    if {"dissipated_energy", "energy", "force"} <= law.curves.keys():
        # A loss is a difference of energies, and no more right than they are.
        spent, held, force = (law.curves[name] for name in ("dissipated_energy", "energy", "force"))
        whole = np.abs(held).max(axis=1) + np.abs(force).max(axis=1) * np.ptp(law.separation)
        slack = 2.0 * law.slack("dissipated_energy") + ROUNDING * whole[:, None]
        claims.hold("what is lost is lost", np.diff(spent, axis=1, prepend=0.0) >= -slack)
    for earlier, later in excursions(law.separation):
        for name in (*_GROWING, "contact_fraction", *PUSHING):
            if name in law.curves:
                less, more = (later, earlier) if name in PUSHING else (earlier, later)
                gain, slack = law.curves[name][:, more] - law.curves[name][:, less], 2.0 * law.slack(name)[:, 0]
                claims.hold(f"{name} after the flat was lower, against before", gain >= -slack)


def _hold_over_work(claims: Claims, scene: Scene, laws: list[Law]) -> None:
    """More adhesion: larger contacts, and less force, at every step."""
    axes = [axis.key for axis in scene.sweep.axes]
    if scene.sweep.mode != "product" or "adhesion.work" not in axes:
        return
    at = axes.index("adhesion.work")
    shape = tuple(scene.sweep.sizes.values())
    numbers = np.moveaxis(np.arange(len(laws)).reshape(shape), at, 0).reshape(shape[at], -1)
    for row in numbers.T:
        ordered = sorted((laws[number] for number in row), key=lambda law: law.scene.work)
        for weak, strong in pairwise(ordered):
            if strong.scene.adhesion_model.model == "auto" or len(weak.error) != len(strong.error):
                continue
            for name in (*_GROWING, *PUSHING):
                if name in weak.curves:
                    gain = strong.curves[name] - weak.curves[name]
                    slack = weak.slack(name) + strong.slack(name)
                    claims.hold(f"{name} with more work", (-gain if name in PUSHING else gain) >= -slack)
