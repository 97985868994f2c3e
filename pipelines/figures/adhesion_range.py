"""Adhesion of finite range: how far JKR is right, by the Tabor number.

One paraboloid at several Tabor numbers, its pull-off force from DMT to JKR, and for rough surfaces how far the force of
JKR is from Dugdale's, from which the choice of model "auto" comes.
"""

import math
from typing import Any, Literal

import numpy as np
import xarray as xr
from scipy.stats import norm
from studies.study import Figure, Study, blank, named, without_limits

import roughmdr as rm
from roughmdr.aggregate.tabor import SHIFT

MODULUS, WORK, RADIUS = 4e6, 0.05, 50e-6  # a soft rubber against a rigid body [Pa], [J/m^2], [m]
TIP = rm.Paraboloid(radius=RADIUS)
SHOWN = (0.1, 0.5, 1.0, 5.0)  # Tabor numbers of the curves
NUMBERS = np.logspace(-3.0, 3.0, 61)
TABOR_NUMBERS, ASPERITIES = {False: NUMBERS.size, True: 3}, {False: 5000, True: 300}
ROUGH_NUMBERS = np.array([1.0, 3.0, 10.0, 30.0, 100.0])
RATIOS = (0.1, 0.3, 1.0, 3.0, 10.0)  # std of the heights over the depth of the JKR pull-off
STOPS = (2.0, 0.0, -1.0)  # lowest separations of the flat, in std
STEPS = 200
CONTROLS: tuple[Literal["force"], Literal["displacement"]] = ("force", "displacement")
_TINY = 1e-300  # replaces no force at all on logarithmic axes
_MATERIAL: Any = {"effective_modulus": MODULUS, "work": WORK}


def strength(tabor: float) -> float:
    """Return sigma0 [Pa] of a Tabor number."""
    return tabor / rm.tabor(TIP, **_MATERIAL, strength=1.0)


def material(tabor: float) -> dict[str, Any]:
    """Return the arguments of Dugdale adhesion with a Tabor number, of JKR adhesion where it is infinite."""
    return _MATERIAL if math.isinf(tabor) else {**_MATERIAL, "adhesion": "dugdale", "strength": strength(tabor)}


def pull_off(points: int) -> xr.Dataset:
    """Return the pull-off force [N] of the paraboloid over the Tabor number, under dead load and fixed grips."""
    numbers = NUMBERS[:: max(1, (NUMBERS.size - 1) // (points - 1))]
    force = [[float(rm.pull_off(TIP, **material(mu), control=control).force) for control in CONTROLS]
             for mu in numbers.tolist()]  # fmt: skip
    return xr.Dataset(
        {"pull_off_force": (("tabor", "control"), force, named("pull-off force", "N"))},
        {"tabor": ("tabor", numbers, {"long_name": "Tabor number"}), "control": list(CONTROLS)},
    )


def rough(count: int) -> xr.Dataset:
    """Return how far the force of JKR is from Dugdale's, over the largest."""
    depth = -float(rm.pull_off(TIP, **_MATERIAL, control="displacement").indentation)
    quantiles = norm.ppf((np.arange(count) + 0.5) / count)
    error = np.empty((len(RATIOS), len(STOPS), ROUGH_NUMBERS.size))
    for i, j, k in np.ndindex(error.shape):
        std, mu = RATIOS[i] * depth, float(ROUGH_NUMBERS[k])
        columns = {"height": ("asperity", quantiles * std), "radius": ("asperity", np.full(count, RADIUS))}
        ensemble = xr.Dataset(columns, attrs={"shape": "paraboloid"})
        path = np.linspace(5.0 * std + WORK / strength(mu), STOPS[j] * std, STEPS)
        asked: dict[str, Any] = {"separation": path, "unload": True}
        jkr, dugdale = (rm.load_separation(ensemble, **asked, **material(number)).force for number in (math.inf, mu))
        error[i, j, k] = abs(jkr - dugdale).max() / max(float(abs(dugdale).max()), _TINY)
    dims = ("roughness", "stop", "rough_tabor")
    return xr.Dataset(
        {"jkr_error": (dims, error, named("largest difference of the forces over the largest"))},
        coords={
            "roughness": ("roughness", list(RATIOS), {"long_name": "std of the heights over the depth at pull-off"}),
            "stop": ("stop", list(STOPS), {"long_name": "closest separation, in std of the heights"}),
            "rough_tabor": ("rough_tabor", ROUGH_NUMBERS, {"long_name": "Tabor number"}),
        },
    )


def measure(quick: bool) -> xr.Dataset:
    """Return all numbers of the figure."""
    with without_limits():
        result = xr.merge([pull_off(TABOR_NUMBERS[quick]), rough(ASPERITIES[quick])])
    return result.assign_attrs(**_MATERIAL, radius=RADIUS)


def draw(result: xr.Dataset) -> Figure:
    """Draw curves, pull-off forces, and the error of JKR."""
    figure = blank(15, 4.6)
    curves, off, error = figure.subplots(1, 3)
    scale, depth = math.pi * WORK * RADIUS, -float(rm.pull_off(TIP, **_MATERIAL, control="displacement").indentation)
    for i, mu in enumerate((*SHOWN, math.inf)):
        color, label = ("k", "JKR") if math.isinf(mu) else (f"C{i}", f"Tabor number {mu:g}")
        lowest = float(rm.pull_off(TIP, **material(mu), control="displacement").indentation)
        delta = lowest + (2.0 * depth - lowest) * np.linspace(0.0, 1.0, 400) ** 2
        force = rm.indent(TIP, **material(mu), indentation=delta).force / scale
        curves.plot(delta / depth, force, color=color, label=label)
        curves.plot(delta[0] / depth, force[0], "o", color=color, ms=4)
    curves.set(xlabel="indentation / |δc| of JKR", ylabel="force / πwR", xlim=(-8, 2), ylim=(-2.1, 2.0))
    curves.set_title("retraction of one paraboloid; dots: pull-off")
    for control, label in (("force", "dead load"), ("displacement", "fixed grips")):
        off.semilogx(result.tabor, -result.pull_off_force.sel(control=control) / scale, label=label)
    for value, name in ((2.0, "DMT, 2 πwR"), (1.5, "JKR, dead load"), (5.0 / 6.0, "JKR, fixed grips")):
        off.axhline(value, color="0.7", lw=0.8)
        off.text(1.2e-3 if value < 2.0 else 20.0, value + 0.02, name, fontsize=8, color="0.4")
    off.set(xlabel="Tabor number", ylabel="pull-off force / πwR", title="pull-off between DMT and JKR")
    for i, ratio in enumerate(result.roughness.to_numpy()):
        worst = result.jkr_error.sel(roughness=ratio).max("stop")
        error.loglog(result.rough_tabor, worst, "o-", color=f"C{i}", label=f"std = {ratio:g} |δc|")
        error.loglog(result.rough_tabor, SHIFT / ratio / result.rough_tabor, "--", color=f"C{i}", lw=0.8)
    error.set(xlabel="Tabor number", ylabel="largest |F(JKR) - F(Dugdale)| / largest |F|", ylim=(1e-5, 3.0))
    error.set_title("rough surfaces; dashed: the rule of model 'auto'")
    for axes in (curves, off, error):
        axes.legend(fontsize=8)
    return figure


def report(result: xr.Dataset) -> str:
    """Return the largest error of JKR over the rule."""
    worst = float((result.jkr_error * result.roughness * result.rough_tabor / SHIFT).max())
    return f"the error of JKR is at most {worst:.2f} of {SHIFT:g} |δc|/std/Tabor number"


STUDY = Study(
    "adhesion_range", "Adhesion of finite range", measure, draw, report,
    f"{TABOR_NUMBERS[True]} of {TABOR_NUMBERS[False]} Tabor numbers, "
    f"{ASPERITIES[True]} of {ASPERITIES[False]} asperities",
)  # fmt: skip
