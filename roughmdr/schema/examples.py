"""Examples of what to write in a scene where something required is missing."""

_SECTIONS = {
    "material": {"modulus": '"3 MPa"', "poisson": "0.49"},
    "counter": {"modulus": '"70 GPa"', "poisson": "0.22"},
    "adhesion": {"model": '"jkr"', "work": '"50 mJ/m^2"'},
    "asperities": {
        "source": '"random"',
        "shape": '"paraboloid"',
        "count": "2000",
        "patch": '"1 mm"',
        "height": '{ distribution = "normal", std = "1 um" }',
        "radius": '"50 um"',
    },
    "interaction": {"model": '"pairwise"'},
    "conduction": {"conductivity": '"400 W/m/K"', "resistivity": '"17e-9 ohm m"'},
    "viscoelastic": {"relaxation": '[{ time = "10 ms", share = 0.5 }]', "speed": '"1 um/s"'},
    "path": {"separation": '{ start = "4 sigma", stop = "0 sigma", steps = 200 }'},
    "tangential": {"friction": "0.3"},
    "accuracy": {"relative": "1e-2"},
}
_KEYS = {
    "asperities.file": '"map.nc"',
    "asperities.second.share": "0.2",
    "asperities.exponent": "2.0",
    "asperities.slope": "0.1",
    "asperities.flat_radius": '"1 um"',
    "asperities.blend_radius": '"1 um"',
    "asperities.cap_radius": '"100 um"',
    "asperities.edge_radius": '"1 um"',
    "asperities.terms": '{ "2" = 1e4, "4" = 1e14 }',
    "asperities.r": '[0, "1 um", "2 um"]',
    "asperities.f": '[0, "10 nm", "50 nm"]',
    "path.separation.start": '"4 sigma"',
    "path.separation.stop": '"0 sigma"',
    "path.separation.steps": "200",
    "path.force.stop": '"1 mN"',
    "path.force.steps": "200",
    "path.pressure.stop": '"1 MPa"',
    "path.pressure.steps": "200",
    "path.remote.stop": '"-2 sigma"',
    "path.remote.steps": "200",
    "path.lateral.steps": "50",
    "tangential.stiffness_ratio": "0.8",
    "path.machine_stiffness": '"1 kN/m"',
    "path.preload": '"1 mN"',
    "path.preload_pressure": '"1 MPa"',
    "path.preload_contact_fraction": "0.02",
    "path.steps": "200",
    **{f"{section}.{key}": value for section, keys in _SECTIONS.items() for key, value in keys.items()},
}


def example_of(key: str) -> str:
    """Return what to write for a dotted key or section of a scene, or a key of [asperities]; empty if there is none."""
    if key in _SECTIONS:
        return f"[{key}] " + ", ".join(f"{name} = {value}" for name, value in _SECTIONS[key].items())
    value = _KEYS.get(key) or _KEYS.get(f"asperities.{key}")
    return f"{key.rsplit('.', maxsplit=1)[-1]} = {value}" if value else ""
