"""Every variable that roughmdr hands out, declared once: its name, unit and description."""

from typing import NamedTuple


class Variable(NamedTuple):
    """A named quantity in SI units."""

    name: str
    units: str
    long_name: str

    @property
    def attrs(self) -> dict[str, str]:
        """The attributes that an xarray variable of it carries."""
        return {"units": self.units, "long_name": self.long_name}


def _table(*rows: tuple[str, str, str]) -> dict[str, Variable]:
    return {row[0]: Variable(*row) for row in rows}


CURVE_VARIABLES = _table(
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
"""Variables of a load-separation law that can be asked for."""

DEFAULT_VARIABLES = ("force", "contact_area", "contact_count", "stiffness")

ASPERITY = _table(
    ("indentation", "m", "approach past first touch, positive pressed in"),
    ("force", "N", "normal force, compression positive"),
    ("contact_radius", "m", "radius of the contact"),
    ("contact_area", "m2", "area of the contact"),
    ("cohesive_radius", "m", "radius up to which the surfaces attract each other"),
    ("stiffness", "N m-1", "slope dP/d(delta) of the branch"),
)
"""Variables of a single asperity."""

FIELDS = _table(
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
"""Variables of the half-space under a single asperity."""

COORDINATES = _table(
    ("separation", "m", "rigid flat above the datum plane"),
    ("branch", "", "direction in which the flat moved"),
    ("height", "m", "summit height above the datum plane"),
    ("x", "m", "position of the summit"),
    ("y", "m", "position of the summit"),
)

RUN_VARIABLES = _table(
    ("run_time", "s", "time spent on the realization, or on all that a statistic is of"),
    ("realization_count", "1", "number of realizations that the statistics are of"),
    ("numerical_error", "1", "estimated numerical error of the force over its largest magnitude"),
    ("status", "1", "what became of the realization"),
    ("tabor_number", "1", "least Tabor number of the asperities"),
    ("adhesion_law", "1", "law of adhesion that was taken"),
    ("edge_slope", "1", "largest slope of a profile at the edge of its contact"),
    ("profile_extent", "1", "largest contact radius over the radius where its profile ends"),
    ("remark", "", "why it failed, or what makes it doubtful"),
    ("cell_key", "", "hash of all that decides the numbers of a cell, and of the versions"),
    ("accuracy_reached", "1", "standard error of the mean force over its largest value; of an expected law its error"),
    ("accuracy_method", "1", "how the cell was computed"),
)
"""Variables that stand in every result."""

DONE, FAILED, NOT_RUN = range(3)
"""Codes of ``status``."""
STATUSES = ("done", "failed", "not_run")
"""Meanings of the codes of ``status``."""
ADHESION_CODES = ("none", "jkr", "dugdale")
"""Adhesion models, each at its code in ``adhesion_law``."""

AUXILIARY_COORDINATES = ("separation", "branch", "cell_key", "remark")
"""Those of them that are coordinates of a result, beside its swept keys."""
