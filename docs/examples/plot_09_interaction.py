"""
Asperities that feel each other
===============================

A contact lowers the surface under its neighbours. How wrong is a law of independent asperities, what does a mean field
or a coupling in pairs change, and does the stated model error tell you? Boundary elements give the answer.
"""

import numpy as np
import pandas as pd
from matplotlib import pyplot as plt

import roughmdr as rm

# %%
# Sixty equal paraboloids stand at least 90 um apart on a patch of 1 mm that repeats. Positions are needed here, so the
# scene has a ``placement``. The list of separations is the same for every model.

SCENE = {
    "title": "Paraboloids on rubber",
    "seed": 3,
    "material": {"effective_modulus": "4 MPa"},
    "asperities": {
        "source": "random",
        "shape": "paraboloid",
        "count": 60,
        "patch": "1 mm",
        "placement": "hard_core",
        "min_distance": "90 um",
        "radius": "300 um",
        "height": {"distribution": "normal", "std": "3 um"},
    },
    "path": {"separation": {"start": "6 um", "stop": "1.5 um", "steps": 10}},
    "output": {"variables": ["force", "contact_area", "model_error_curve"]},
}

# %%
# Run the three models of interaction. Add ``[reference]`` to the last one: boundary elements then press the surface
# that the asperities make together, on the same periodic patch.

models = {
    "independent": rm.run(SCENE),
    "mean field": rm.run({**SCENE, "interaction": {"model": "mean_field"}}),
    "pairwise": rm.run(
        {
            **SCENE,
            "interaction": {"model": "pairwise", "boundary": "periodic"},
            "reference": {"model": "boundary_elements", "error": 0.005},
        }
    ),
}
reference = models["pairwise"].reference_force.isel(realization=0)
grid_error = models["pairwise"].reference_error.isel(realization=0)

# %%
# The table holds the closest approach. "deviation" is from boundary elements, "stated" is what ``model_error_curve``
# says without knowing them.

last = pd.DataFrame(
    {
        name: {
            "force [mN]": 1e3 * float(law.force[0, -1]),
            "contact area [%]": 100 * float(law.contact_area[0, -1] / law.nominal_area),
            "deviation [%]": 100 * float(law.force[0, -1] / reference[-1] - 1),
            "stated [%]": 100 * float(law.model_error_curve[0, -1]),
        }
        for name, law in models.items()
    }
).T
last.round(3)

# %%
# - Independent asperities carry 21 % too little: on a periodic patch separations count from the mean plane of the
#   deformed surface, which sinks under the load. The stated error covers that.
# - The mean field needs no positions and costs almost nothing. It mends most of the error here, because the asperities
#   keep a distance from each other. Its stated error stays that of independent asperities.
# - Pairs agree with boundary elements within the error of their grid. What is stated is an error that both have in
#   common: they take slopes to be small.
#
# The picture shows the whole path. Symbols are deviations from boundary elements, lines are errors stated beforehand.

figure, (left, right) = plt.subplots(1, 2, figsize=(8, 4), layout="constrained")
for colour, (name, law) in zip(("C0", "C1", "C2"), models.items(), strict=True):
    separation = 1e6 * law.separation
    left.plot(separation, 1e3 * law.force[0], colour, label=name)
    right.semilogy(separation, 100 * np.abs(law.force[0] / reference - 1), "o", color=colour)
    right.semilogy(separation, 100 * law.model_error_curve[0], color=colour, label=f"{name}, stated")
left.plot(separation, 1e3 * reference, "k.", label="boundary elements")
right.semilogy(separation, 100 * grid_error, "k:", label="grid of the boundary elements")
left.set(xlabel="separation [um]", ylabel="force [mN]")
right.set(xlabel="separation [um]", ylabel="error of the force [%]", ylim=(5e-4, 2e4))
left.legend()
text = right.legend(fontsize=8, loc="upper right")
