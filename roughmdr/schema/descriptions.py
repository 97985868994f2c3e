"""A line on each key of a scene, for editors: what it is. Units, bounds and defaults are those of its declaration."""

SHAPE_WORDS = {
    "radius": "Radius: of curvature at the tip, of the sphere, or of the flat punch",
    "slope": "Slope of the flank, the tangent of its angle to the plane",
    "exponent": "Exponent n of the profile; above 1/2 with adhesion",
    "coefficient": "Coefficient c of the profile c r^n, in m^(1-n)",
    "width": "Radius at which the profile has its rise",
    "rise": "Height of the profile at its width",
    "flat_radius": "Radius of the flat end",
    "blend_radius": "Radius at which the rounded tip meets the flank",
    "cap_radius": "Radius of curvature of the cap; not below radius",
    "edge_radius": "Radius of curvature of the edge",
}
"""Lines on the parameters of shapes."""
_BODY = {"modulus": "Young's modulus", "poisson": "Poisson's ratio"}
_STEPS = "Number of steps, both ends included"
_LOADS = {"start": "First load", "stop": "Last load", "steps": _STEPS}
_SECTIONS: dict[str, dict[str, str]] = {
    "": {
        "title": "Title of results and pictures. Default: the name of the file",
        "seed": "Seed of all random numbers: the same seed gives the same result to the last bit",
        "material": "Elastic constants: effective_modulus alone, or modulus and poisson",
        "counter": "The other body, which is rigid without this section",
        "adhesion": "Adhesion between the surfaces; none without this section",
        "asperities": "Where the asperities come from",
        "interaction": "How asperities feel each other; they are independent without this section",
        "path": "Way of the rigid flat, or what the machine does that moves it",
        "output": "Variables of the result",
        "batch": "Number of realisations, and how each is made",
        "accuracy": "An error asked for in place of a number of realisations",
        "sweep": "Values of keys to run the scene with, by their dotted names in quotes",
    },
    "material": {"effective_modulus": "E*, 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2; in place of all others", **_BODY},
    "counter": _BODY,
    "adhesion": {
        "model": '"jkr" where the Tabor number is large, "dugdale" of finite range, "auto": JKR where it is right',
        "work": "Work of adhesion of the pair, not the surface energy of one side",
        "strength": 'Stress of the attraction, for "dugdale" and "auto"',
        "range": "Range of the attraction, work/strength, in place of strength",
        "error": 'For "auto": JKR is used where its force is off by less, over the largest force. Default: 0.01',
    },
    "asperities": {
        "source": '"random": from distributions; "nayak": summits of a Gaussian surface; "spectrum": hills or summits '
        'of maps of one; "surface": those of a height map; "file": a saved ensemble',
        "shape": "Shape of the asperities, which decides the other keys",
        "count": "Number of asperities",
        "density": "Mean number of asperities per area, in place of count: a Poisson number in each realisation",
        "patch": "Side of the square nominal area, or of the square of the same area where a lattice has an oblong one",
        "placement": 'Positions, for [interaction]: "random", "hard_core" with min_distance, "square" or "hexagonal"',
        "pitch": "Distance of neighbours on a lattice, in place of count: the sites on the patch are counted",
        "vacancies": "Whether a lattice on a square patch, only nearly hexagonal, may have empty sites",
        "min_distance": 'Least distance of two asperities, for placement = "hard_core"',
        "height": "Heights of the summits above the datum plane z = 0; with a std alone their mean is 0",
        "second": "A second population; keys left out are as in the first",
        "correlation": "Spearman's rank correlation of the height with one shape parameter",
        "terms": 'Terms of the power series, { "exponent" = coefficient }',
        "r": "Radii of the tabulated profile, rising from 0",
        "f": "Heights of the tabulated profile at r, from 0",
        "m0": "Mean square of the heights of a profile of the surface",
        "m2": "Mean square of its slopes",
        "m4": "Mean square of its curvatures",
        "hurst": "Hurst exponent of the spectrum",
        "long_wave": "Longest wave of the spectrum",
        "short_wave": "Shortest wave of the spectrum",
        "rms_height": "Root mean square of the heights of the surface",
        "rms_slope": "Root mean square of its slopes, in place of rms_height",
        "model": '"summits": a paraboloid each; "hills", for [interaction]: the profile of each hill',
        "anisotropy": "Stretch of lengths along x over that along y",
        "points": "Points of a map for a shortest wave",
        "file": "File of the map or of the ensemble, relative to the scene",
        "size": "Side of the map, or both along x and y, or { across, down } the rows of its file, which does not say",
        "unit": "Unit of the heights of the map, where its file does not say",
        "channel": "Name of the map, where its file has several",
        "detrend": 'Trend that is removed. Default: "quadratic", of periodic maps "mean"',
        "periodic": "Whether the map repeats. Default: as its file says, else false",
        "cutoff": "Shorter waves are removed",
        "outliers": 'Marks of undefined points and spikes become "undefined", or are "kept". Default: they are refused',
        **SHAPE_WORDS,
    },
    "asperities.second": {"share": "Share of all asperities"},
    "interaction": {
        "model": '"pairwise": each is displaced by each other one; "mean_field": by the mean pressure of all',
        "boundary": '"periodic": the patch repeats; "free": it lies alone on a half-space',
        "order": "1: contacts are points to each other; 2: of finite size, on a curved and tilted surface",
        "error": "Largest relative error of the force by the solver",
        "beyond": 'Where too many contacts overlap: "flag" marks the step, "boundary_elements" solves it on a grid',
    },
    "path": {
        "separation": "Separations of the flat from the datum plane: a table of start, stop and steps, or a list",
        "force": "Dead loads in place of separations: a table of start, stop and steps, or a list",
        "pressure": "Dead loads over the nominal area: a table of start, stop and steps, or a list",
        "remote": "Positions of the far end of the machine's spring: a table of start, stop and steps, or a list",
        "lateral": "Lateral displacements, while a single separation, force or pressure is held",
        "machine_stiffness": "Stiffness of the spring, with remote or a preload",
        "preload": "Load until this force; with unload = true pull it off then",
        "preload_pressure": "Load until this force over the nominal area",
        "preload_contact_fraction": "Load until this contact area over the nominal area",
        "steps": "Number of steps of the loading to a preload",
        "hold": "Steps more at the last one, before unload",
        "unload": "Whether the steps follow in reverse",
    },
    "path.separation": {
        "start": 'First separation; "clear": where nothing touches. Default: "clear"',
        "stop": "Where loading ends: a separation, or { contact_fraction = ... } or { pressure = ... }",
        "steps": _STEPS,
    },
    "path.separation.stop": {
        "contact_fraction": "Contact area over nominal area at which loading ends",
        "pressure": "Force over nominal area at which loading ends",
    },
    "path.remote": {
        "start": 'First position; "clear": where nothing touches. Default: "clear"',
        "stop": "Where loading ends",
        "steps": _STEPS,
    },
    "path.lateral": {
        "start": "First lateral displacement",
        "stop": "Last lateral displacement",
        "amplitude": "Lateral displacement at which cycles about 0 turn, in place of stop",
        "cycles": "Number of cycles after the first loading: to minus the amplitude and back",
        "steps": "Number of steps, both ends included; with amplitude those of a quarter of a cycle",
    },
    "path.force": _LOADS,
    "path.pressure": _LOADS,
    "output": {
        "variables": "Variables over the steps that are computed and stored",
        "keep": '"curves" of each realisation, or their "statistics": mean, standard error, least and greatest',
    },
    "batch": {
        "estimator": '"sampled" at random, "stratified": evenly spread, "expected": the mean law by integration',
        "realizations": "Number of random ensembles",
    },
    "accuracy": {
        "relative": "Standard error of the mean force over its largest value",
        "max_realizations": "Most realisations of a cell",
        "method": '"auto": the cheaper of draws and the expected law; or an estimator',
    },
}


def describe_key(section: str, name: str) -> str:
    """Return the line on a key of a section, which is dotted, and empty for the scene itself."""
    if section in ("asperities.second", "asperities.correlation") and name not in _SECTIONS.get(section, {}):
        which = "the second population" if section == "asperities.second" else "its correlation with the height"
        return f"{_SECTIONS['asperities'][name]}: {which}"
    return _SECTIONS[section][name]
