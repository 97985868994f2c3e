"""Press realisations of surfaces of one spectrum as each source makes asperities of it."""

import warnings
from typing import Any

import numpy as np
import xarray as xr

import roughmdr as rm
from roughmdr.ensemble.spectral.section import SpectrumAsperities
from studies.study import named

HURST = (0.3, 0.5, 0.8)
SHARES = (2.5, 2.0, 1.5, 1.0)
"""Separations over the r.m.s. height."""
METHODS = ("nayak", "nayak in pairs", "summits in pairs", "hills in pairs", "boundary elements")
REALIZATIONS, QUICK = 64, 4
_SIDE, _LONG, _SHORT = 1e-4, 5e-5, 6e-6
_SLOPE = 1e-2  # small: nothing depends on it
_PAIRS = {"model": "pairwise"}


def surface(hurst: float) -> dict[str, Any]:
    """Return the section [asperities] of maps of a Hurst exponent."""
    waves = {"hurst": hurst, "long_wave": _LONG, "short_wave": _SHORT, "rms_slope": _SLOPE}
    return {"source": "spectrum", "patch": _SIDE, **waves}


def laws(hurst: float, realizations: int) -> dict[str, xr.Dataset]:
    """Return forces over realisations and steps by each method; boundary elements press the maps of the hills."""
    section = surface(hurst)
    moments = SpectrumAsperities.model_validate(section).summits.moments
    nayak = {"source": "nayak", "patch": _SIDE, **moments._asdict()}

    def run(asperities: dict[str, Any], **more: Any) -> xr.Dataset:
        return rm.run(
            {
                "title": "Surfaces of one spectrum",
                "seed": 7,
                "material": {"effective_modulus": 1.0},
                "asperities": asperities,
                "path": {"separation": [share * float(np.sqrt(moments.m0)) for share in SHARES]},
                "output": {"variables": ["force", "contact_fraction"]},
                "batch": {"realizations": realizations},
                **more,
            }
        )

    hills = run(section, interaction=_PAIRS, reference={"model": "boundary_elements"})
    reference = {name: hills[f"reference_{name}"] for name in ("force", "contact_fraction")}
    found = (
        run(nayak),
        run(nayak, interaction=_PAIRS),
        run({**section, "model": "summits"}, interaction=_PAIRS),
        hills,
        xr.Dataset(reference),
    )
    return dict(zip(METHODS, found, strict=True))


def measure(quick: bool) -> xr.Dataset:
    """Press surfaces of three Hurst exponents, many of each or a few."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rm.LimitWarning)
        found = [laws(hurst, QUICK if quick else REALIZATIONS) for hurst in HURST]
    over = ("hurst", "solver", "realization", "step")
    numbers = {
        name: np.array([[each[method][name].to_numpy() for method in METHODS] for each in found])
        for name in ("force", "contact_fraction")
    }
    return xr.Dataset(
        {
            "force": (over, numbers["force"], named("force over the effective modulus", "m2")),
            "contact_fraction": (over, numbers["contact_fraction"], named("contact area over nominal area")),
        },
        {
            "hurst": ("hurst", list(HURST), named("Hurst exponent")),
            "solver": list(METHODS),
            "share": ("step", list(SHARES), named("separation over r.m.s. height")),
        },
    )
