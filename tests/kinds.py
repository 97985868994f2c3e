"""Scenes of every kind that take milliseconds: one of each section, shape of path, source and law."""

from typing import Any

from scenes import ASPERITIES, CONDUCTION, scene

VARIED: dict[str, Any] = {**ASPERITIES, "count": 12, "patch": "0.2 mm"}
FEW = {**VARIED, "radius": "50 um"}
PLACED = {**FEW, "placement": "hard_core", "min_distance": "20 um"}


SPREAD = {"distribution": "normal", "mean": 1e-7, "std": 1e-6, "min": -3e-6, "max": 3e-6}
EVERY_KEY = {
    **VARIED,
    "placement": "hard_core",
    "min_distance": 1e-6,
    "height": SPREAD,
    "second": {"share": 0.3, "height": {"distribution": "uniform", "loc": -1e-6, "scale": 3e-6}},
    "correlation": {"radius": 0.4},
}
WAVES = {"hurst": 0.8, "long_wave": 5e-5, "short_wave": 2e-5, "rms_height": 1e-6}
CLEAR, TO_PRESSURE, TO_FRACTION = (
    {"separation": {"start": "clear", "stop": stop, "steps": 6}}
    for stop in ("0.5 sigma", {"pressure": 2e3}, {"contact_fraction": 5e-3})
)
RANGE = {"separation": {"start": 3e-6, "stop": 5e-7, "steps": 6}, "unload": True}
LATERAL = {"amplitude": 2e-8, "steps": 6}
DUGDALE = {"model": "dugdale", "work": 0.02}
EXPECTED = {"estimator": "expected"}
FRICTION = {"friction": 0.4}
HARD = {"modulus": "3 MPa", "poisson": 0.49, "hardness": 2e5}


def elastic(**changes: Any) -> dict[str, Any]:
    """A scene of a few asperities and steps, without adhesion unless that is given."""
    return scene(**{"adhesion": None, "asperities": FEW, "path": RANGE, "batch": {"realizations": 2}, **changes})


def curved(**body: Any) -> dict[str, Any]:
    """A curved body that begins clear of adhesive asperities."""
    adhesive = {"adhesion": {"model": "jkr", "work": 0.05}, "output": {"variables": ["force"]}, "batch": EXPECTED}
    path = {"separation": {"stop": 1e-6, "steps": 3}}
    return elastic(**adhesive, path=path, nominal={**body, "error": 1e-2})


KINDS: dict[str, dict[str, Any]] = {
    "independent": elastic(asperities=EVERY_KEY, counter={"modulus": 1e7, "poisson": 0.3}),
    "density": elastic(asperities={**{k: v for k, v in FEW.items() if k != "count"}, "density": 3e8}, path=CLEAR),
    "effective": elastic(material={"effective_modulus": 3e6}, path=TO_PRESSURE, accuracy={"relative": 0.5}, batch=None),
    "jkr": elastic(adhesion={"model": "jkr", "work": 0.02}, path=CLEAR, asperities=VARIED, material=HARD),
    "dugdale": elastic(adhesion={**DUGDALE, "strength": 1e6}, path=CLEAR),
    "adhesive pairs": elastic(
        adhesion={"model": "jkr", "work": 0.02}, asperities=PLACED, interaction={"model": "pairwise"}, path=RANGE,
        output={"variables": ["force", "energy", "dissipated_energy"]},
    ),
    "drawn to an error": elastic(
        asperities={**FEW, "radius": {"distribution": "lognormal", "mean": "50 um", "std": "50 um"}},
        accuracy={"relative": 0.2, "method": "sampled"},
        batch=None,
    ),
    "evenly drawn to an error": elastic(accuracy={"relative": 0.05, "method": "stratified"}, batch=None),
    "range": elastic(adhesion={"model": "auto", "work": 0.02, "range": 2e-8, "error": 0.01}, path=CLEAR),
    "pairwise": elastic(
        asperities={**FEW, "placement": "random"},
        interaction={"model": "pairwise", "boundary": "periodic", "order": 1, "error": 1e-5, "beyond": "flag"},
        path=TO_FRACTION,
    ),
    "lattice": elastic(
        asperities={**{k: v for k, v in FEW.items() if k != "count"}, "placement": "square", "pitch": 1.9e-5},
        interaction={"model": "mean_field"},
        path=CLEAR,
    ),
    "mean field": elastic(interaction={"model": "mean_field"}, path=TO_PRESSURE, batch=EXPECTED),
    "conduction": elastic(
        conduction={**CONDUCTION, "counter_conductivity": 20.0},
        output={"variables": ["thermal_conductance", "electrical_conductance"]},
        path=RANGE,
    ),
    "yielding": elastic(
        material={"modulus": "3 MPa", "poisson": 0.4},
        plasticity={"yield_strength": 2e4, "model": "mdr"},
    ),
    "yielding spheres": elastic(
        material={"modulus": "3 MPa", "poisson": 0.4}, plasticity={"hardness": 6e4, "body": "sphere"}
    ),
    "yielding cones": elastic(
        asperities={**{k: v for k, v in FEW.items() if k != "radius"}, "shape": "cone", "slope": 0.1},
        material={"modulus": "3 MPa", "poisson": 0.4},
        plasticity={"yield_strength": 2e4},
    ),
    "viscoelastic": elastic(
        viscoelastic={
            "relaxation": [{"time": 1.0, "share": 0.5}], "speed": 1e-6, "retraction_speed": 2e-6, "dwell": 1.0,
        },
        path=RANGE,
    ),
    "sticking": elastic(
        material={"effective_modulus": 3e6},
        tangential={"stiffness_ratio": 0.8},
        output={"variables": ["tangential_stiffness"]},
        path=RANGE,
    ),
    "slip at a separation": elastic(tangential=FRICTION, path={"separation": "0.5 um", "lateral": LATERAL}),
    "slip at a force": elastic(tangential=FRICTION, path={"force": 1e-4, "lateral": LATERAL}),
    "slip at a pressure": elastic(
        tangential=FRICTION, path={"pressure": 2e3, "lateral": {"start": 1e-9, "stop": 2e-8, "steps": 6}}
    ),
    "force": elastic(path={"force": {"start": 1e-6, "stop": 1e-4, "steps": 6}}),
    "pressure": elastic(
        path={"pressure": {"start": 1.0, "stop": 2e3, "steps": 6}}, interaction={"model": "mean_field"}
    ),
    "remote": elastic(
        path={"remote": {"start": 3e-6, "stop": 1e-7, "steps": 6}, "machine_stiffness": 100.0, "unload": True},
        adhesion={"model": "jkr", "work": 0.02},
    ),
    "preload": elastic(path={"preload": 1e-4, "machine_stiffness": 100.0, "steps": 6, "unload": True}),
    "preload pressure": elastic(path={"preload_pressure": 2e3, "steps": 6}),
    "preload fraction": elastic(path={"preload_contact_fraction": 5e-3, "steps": 6}),
    "curved paraboloid": curved(radius=1e-3),
    "curved cone": curved(shape="rounded_cone", slope=0.01, blend_radius=1e-5),
    "nayak": elastic(asperities={"source": "nayak", "patch": 2e-4, **WAVES}, path=CLEAR),
    "moments": elastic(
        asperities={"source": "nayak", "patch": 1e-4, "m0": 1e-12, "m2": 1e-2, "m4": 4e8}, path=RANGE
    ),
    "spectrum": elastic(
        asperities={
            **{key: value for key, value in WAVES.items() if key != "rms_height"}, "rms_slope": 0.1,
            "source": "spectrum", "model": "summits", "patch": 1e-4, "points": 6.0, "anisotropy": 1.1,
        },
        path=RANGE,
    ),
    "reference": elastic(
        asperities={"source": "spectrum", "model": "summits", "patch": 1e-4, **WAVES},
        reference={"model": "boundary_elements", "error": 0.3},
        path={"separation": [2e-6, 1.5e-6]},
        batch=None,
    ),
}  # fmt: skip
