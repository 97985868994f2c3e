"""The asperities of the first scene without adhesion, independent and coupled: force over separation, and its ratio."""

import numpy as np
import xarray as xr
from studies.comparison import INTERACTIONS, in_cases, law_or_nan, panels
from studies.study import Figure, Study, named

import roughmdr as rm

UM = 1e-6
MODULUS = 3e6 / (1.0 - 0.49**2)  # [Pa]
ASPERITIES = {False: 2000, True: 200}
_LAW = {"force": ("force", "N"), "contact_fraction": ("contact fraction", "1")}
COLOURS = ("0.5", "#8a5fb0", "#1b6ca8", "#c8553d")


def ensemble_of(count: int) -> xr.Dataset:
    """Return paraboloids at random, as dense as in the scene."""
    section = {
        "source": "random", "shape": "paraboloid", "placement": "random", "count": count,
        "patch": 1e-3 * (count / 2000) ** 0.5,
        "height": {"distribution": "normal", "std": UM},
        "radius": {"distribution": "lognormal", "mean": 50 * UM, "std": 5 * UM},
    }  # fmt: skip
    return rm.generate(section, seed=2026)


def measure(quick: bool) -> xr.Dataset:
    """Return force and contact fraction by each of ``INTERACTIONS``."""
    ensemble = ensemble_of(ASPERITIES[quick])
    separation = np.linspace(3.0 * UM, UM, 10 if quick else 40)
    laws = [law_or_nan(ensemble, separation, *_LAW, effective_modulus=MODULUS, interaction=each)
            for each in INTERACTIONS.values()]  # fmt: skip
    return xr.Dataset(
        in_cases(_LAW, laws, "model", "step"),
        {"model": list(INTERACTIONS), "separation": ("step", separation, named("separation", "m"))},
    )


def draw(result: xr.Dataset) -> Figure:
    """Draw forces over the separation, and over that of independent asperities."""
    figure, (left, right) = panels(10, 4.4, 2)
    alone = result["force"].sel(model="independent")
    for name, colour in zip(INTERACTIONS, COLOURS, strict=True):
        own = result.sel(model=name)
        left.semilogy(result["separation"] / UM, 1e3 * own["force"].where(own["force"] > 0.0), color=colour, label=name)
        right.plot(100.0 * own["contact_fraction"], own["force"] / alone, color=colour, label=name)
    left.set(xlabel="separation [µm]", ylabel="force [mN]", title="2000 paraboloids on 1 mm²")
    right.set(xlabel="contact area [% of the patch]", ylabel="force over that of independent asperities")
    left.legend(fontsize=9)
    return figure


def report(result: xr.Dataset) -> str:
    """Return the force over that of independent asperities at closest approach."""
    last = result.isel(step=-1)
    ratio = last["force"] / last["force"].sel(model="independent")
    return "\n".join(
        f"{name}: force {float(ratio.sel(model=name)):.4g} times that of independent asperities, "
        f"contact {100.0 * float(last['contact_fraction'].sel(model=name)):.3g} %"
        for name in INTERACTIONS
    )


STUDY = Study(
    "interaction", "Asperities that feel each other", measure, draw, report,
    f"{ASPERITIES[True]} of {ASPERITIES[False]} asperities, a quarter of the steps",
)  # fmt: skip
