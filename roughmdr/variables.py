"""All variables of datasets and files, declared once: name, unit and description."""

from typing import NamedTuple


class Variable(NamedTuple):
    """A variable of a dataset or a file, in SI units."""

    name: str
    units: str
    long_name: str

    @property
    def attrs(self) -> dict[str, str]:
        """Its attributes in xarray and netCDF."""
        return {"units": self.units, "long_name": self.long_name}


def _declare(*declarations: tuple[str, str, str]) -> dict[str, Variable]:
    return {declaration[0]: Variable(*declaration) for declaration in declarations}


CURVE_VARIABLES = _declare(
    ("force", "N", "normal force of all asperities, compression positive"),
    ("contact_area", "m2", "sum of the contact areas"),
    ("contact_count", "1", "number of asperities in contact"),
    ("stiffness", "N m-1", "sum of the slopes dP/d(delta) of the branches, jumps not included"),
    ("pressure", "Pa", "force over nominal area"),
    ("contact_fraction", "1", "contact area over nominal area"),
    ("contact_radius_sum", "m", "sum of the contact radii"),
    ("energy", "J", "elastic and surface energy of all contacts, 0 out of contact"),
    ("dissipated_energy", "J", "energy lost in the jumps of contacts since the start of the path"),
)
"""Variables of a load-separation law that [output] can name."""

DEFAULT_VARIABLES = ("force", "contact_area", "contact_count", "stiffness")

ASPERITY = _declare(
    ("indentation", "m", "approach past first touch, positive pressed in"),
    ("force", "N", "normal force, compression positive"),
    ("contact_radius", "m", "radius of the contact"),
    ("contact_area", "m2", "area of the contact"),
    ("cohesive_radius", "m", "radius up to which the surfaces attract each other"),
    ("stiffness", "N m-1", "slope dP/d(delta) of the branch"),
)
"""Variables of a single asperity."""

FIELDS = _declare(
    ("r", "m", "distance from the axis of the asperity"),
    ("z", "m", "depth below the surface of the half-space"),
    ("pressure", "Pa", "normal pressure on the surface, compression positive"),
    ("surface_displacement", "m", "normal displacement of the surface, positive into the half-space"),
    ("sigma_zz", "Pa", "normal stress along the axis, tension positive"),
    ("sigma_rr", "Pa", "normal stress across the axis, tension positive"),
    ("shear", "Pa", "largest shear stress at a point of the axis, half of |sigma_zz - sigma_rr|"),
    ("largest_shear", "Pa", "largest shear stress on the axis"),
    ("largest_shear_depth", "m", "depth at which the shear stress on the axis is largest"),
)
"""Fields in the half-space under a single asperity."""

COORDINATES = _declare(
    ("separation", "m", "rigid flat above the datum plane"),
    ("branch", "", "direction in which the flat moved"),
    ("height", "m", "summit height above the datum plane"),
    ("x", "m", "x of the summit"),
    ("y", "m", "y of the summit"),
)

RUN_VARIABLES = _declare(
    ("run_time", "s", "time spent on the realization, or on all realizations of a statistic"),
    ("realization_count", "1", "number of realizations of the statistics"),
    ("numerical_error", "1", "estimated numerical error of the force over its largest magnitude"),
    ("status", "1", "outcome of the realization"),
    ("tabor_number", "1", "smallest Tabor number of the asperities"),
    ("adhesion_law", "1", "adhesion model that was used"),
    ("edge_slope", "1", "largest slope of a profile at the edge of its contact"),
    ("profile_extent", "1", "largest contact radius over the radius where its profile ends"),
    ("remark", "", "why the realization failed, or why it is doubtful"),
    ("cell_key", "", "hash of everything that decides the numbers of a cell, versions included"),
    ("accuracy_reached", "1", "standard error of the mean force, or error of an expected law, over the largest force"),
    ("accuracy_method", "1", "how the cell was computed"),
)
"""Variables about the runs of a result."""

DONE, FAILED, NOT_RUN = range(3)
"""Codes of ``status``."""
STATUSES = ("done", "failed", "not_run")
"""Meaning of each code of ``status``."""
ADHESION_CODES = ("none", "jkr", "dugdale")
"""Adhesion models; the index is the code in ``adhesion_law``."""

AUXILIARY_COORDINATES = ("separation", "branch", "cell_key", "remark")
"""Coordinates of a result besides its swept keys."""
