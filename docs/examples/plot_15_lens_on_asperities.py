"""
A lens on rubber with asperities
================================

A smooth glass lens is pressed on rubber with spherical asperities, and the contacts are seen through the glass. How
does their area grow with the load, what do the spread of the heights, the lens and adhesion do to it, and does adhesion
show when the lens is pulled off?

V. Acito, M. Ciavarella, A. M. Prevost and A. Chateauminois made this experiment (`arXiv:1902.06664
<https://arxiv.org/abs/1902.06664>`_). They find that the area is not linear in the load and depends strongly on the
spread of the heights, that the curvature of the lens has a large part in it, and that adhesion makes the area larger
even where the pull-off force vanishes. The numbers here are round ones of that kind, not those of the paper.
"""

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

import roughmdr as rm

# %%
# ``[nominal]`` puts the lens in place of the flat, with its apex over the middle of the patch. With ``[interaction]``
# every asperity has its place, and is as much lower as the lens leaves it; each contact lowers the surface under all
# others. ``boundary`` must be "free", since the lens does not repeat. The patch must be larger than the contact: a
# warning tells if it is not.

SCENE = {
    "title": "A lens on rubber with asperities",
    "seed": 5,
    "material": {"effective_modulus": "4 MPa"},
    "interaction": {"model": "pairwise", "boundary": "free"},
    "nominal": {"radius": "13 mm"},
    "asperities": {
        "source": "random",
        "shape": "paraboloid",
        "radius": "150 um",
        "density": "1e8 m^-2",
        "patch": "2.2 mm",
        "placement": "hard_core",
        "min_distance": "60 um",
        "height": {"distribution": "normal", "std": "5 um"},
    },
    "path": {"separation": {"start": "clear", "stop": "-6 um", "steps": 40}, "unload": True},
    "output": {"variables": ["force", "contact_area", "contact_count"]},
    "batch": {"realizations": 2, "estimator": "stratified"},
}
ROUGH = {"asperities.height.std": "10 um"}
STICKY = {"adhesion.model": "jkr", "adhesion.work": "30 mJ/m^2"}
flat = {section: table for section, table in SCENE.items() if section != "nominal"}

laws = {
    "lens, 5 um": rm.run(SCENE),
    "lens, 10 um": rm.run(SCENE, set=ROUGH),
    "lens, 5 um, adhesion": rm.run(SCENE, set=STICKY),
    "flat, 5 um": rm.run(flat, set={"path.separation.stop": "6 um"}),
}
mean = {name: law.mean("realization") for name, law in laws.items()}
loading = {name: law.isel(step=law.branch == "loading") for name, law in mean.items()}

# %%
# The areas at given loads:

LOADS = np.array([1.0, 3.0, 10.0])  # [mN]


def area_at(law, load):
    """Return the contact area [mm2] at loads [mN] on loading."""
    on = law.force.values > 0.0
    area = np.interp(np.log(load), np.log(1e3 * law.force.values[on]), np.log(1e6 * law.contact_area.values[on]))
    return np.exp(area)


areas = pd.DataFrame({name: 1e3 * area_at(law, LOADS) for name, law in loading.items()}, index=LOADS).T
areas.columns = [f"at {load:g} mN [1000 um2]" for load in LOADS]
growth = np.log(areas.iloc[:, -1] / areas.iloc[:, 0]) / np.log(LOADS[-1] / LOADS[0])
areas.assign(**{"power of the load": growth}).round(2)

# %%
# What carries the load, how near the contacts are to each other, and what is left at the pull-off:

numbers = pd.DataFrame(
    {
        name: {
            "contacts": float(law.contact_count.max()),
            "contact radius of the lens [mm]": 1e3 * float(law.nominal_contact_radius[39])
            if "lens" in name
            else np.nan,
            "contact fraction where they are [%]": 100.0 * float(law.largest_contact_fraction),
            "error by the coupling [%]": 100.0 * float(law.interaction_error),
            "pull-off force over the load [%]": -100.0 * float(law.pull_off_force) / float(law.force.max()),
        }
        for name, law in mean.items()
    }
).T
numbers.round(3)

# %%
figure, (left, right) = plt.subplots(1, 2, figsize=(8.5, 3.8), layout="constrained")
for name, law in loading.items():
    colour = {"lens, 5 um": "C0", "lens, 10 um": "C1", "flat, 5 um": "0.5"}[name.removesuffix(", adhesion")]
    style = "--" if "adhesion" in name else "-"
    force, area = 1e3 * law.force.values, 1e3 * 1e6 * law.contact_area.values
    left.plot(force, area, style, color=colour, label=name)
    on = force > 0.1
    right.semilogx(force[on], area[on] / force[on], style, color=colour)
left.set(xlabel="load [mN]", ylabel="contact area [1000 um²]", xlim=(0, 14), ylim=(0, 60))
right.set(xlabel="load [mN]", ylabel="area over load [1000 um²/mN]", xlim=(0.3, 15), ylim=(0, 9))
text = left.legend(fontsize=8)

# %%
# - The area grows less than in proportion to the load: as its power 0.88. Under a flat, which presses the same
#   asperities evenly, the power is 0.94: the lens crowds the load on the contacts in the middle.
# - Twice the spread of the heights makes 15 to 18 % less area at the same load, on larger contacts over a wider region.
# - Adhesion adds 59 % to the area at 1 mN and 36 % at 10 mN. It does not show in the pull-off force, which is 0.2 % of
#   the load: the half-space pushes the contacts off one after the other, and only the last ones pull.
# - The contacts are 8 to 10 % of the area that they crowd on, but only 1 % of the patch. The stated error of the
#   coupling goes by the first, so that it does not depend on how much of the patch is empty.
#
# The contacts under the lens, from above:

picture = rm.plot(laws["lens, 5 um, adhesion"], kind="map")
