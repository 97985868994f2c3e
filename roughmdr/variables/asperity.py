"""Variables of a single asperity, and fields in the half-space under it."""

from roughmdr.variables.variable import declare

ASPERITY = declare(
    ("indentation", "m", "approach past first touch, positive pressed in"),
    ("force", "N", "normal force, compression positive"),
    ("contact_radius", "m", "radius of the contact"),
    ("contact_area", "m2", "area of the contact"),
    ("cohesive_radius", "m", "radius up to which the surfaces attract each other"),
    ("stiffness", "N m-1", "slope dP/d(delta) of the branch"),
    ("remote", "m", "far end of the spring, past where the slack spring brings the tip to first touch"),
)
"""Variables of a single asperity."""

FIELDS = declare(
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
