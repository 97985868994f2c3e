r"""
Greenwood and Williamson: many asperities and their mean
========================================================

How far is a finite patch of asperities from the law of Greenwood and Williamson? This page draws 32 patches, shows their
scatter, and compares their mean and the expected law with the theory.
"""

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

import roughmdr as rm

scene = {
    "title": "Steel summits under a flat",
    "seed": 2026,
    "material": {"effective_modulus": "100 GPa"},
    "asperities": {
        "source": "random",
        "shape": "paraboloid",
        "count": 500,
        "patch": "1 mm",
        "radius": "50 um",
        "height": {"distribution": "normal", "std": "0.5 um"},
    },
    "path": {"separation": {"start": "4 sigma", "stop": "1 sigma", "steps": 61}},
    "output": {"variables": ["force", "contact_count"]},
    "batch": {"realizations": 32},
}
patches = rm.run(scene)
figure = rm.plot(patches, with_expected=True)

# %%
# Each thin line is one patch of 500 asperities. The band is the mean with two standard errors. The thin dark line is the
# expected law: the mean over infinitely many patches, which is integrated and not drawn. Far from the surface only a
# few of the highest summits are in contact, and the patches differ most.
#
# The theory
# ----------
# With the density of summits :math:`\eta`, their radius :math:`R` and the density :math:`\varphi` of their heights, the
# pressure is
#
# .. math:: p(h) = \tfrac{4}{3} E^* \sqrt{R}\, \eta \int_h^\infty (z - h)^{3/2} \varphi(z)\, dz.
#
# ``rm.theory.greenwood_williamson`` integrates it. ``estimator = "expected"`` computes the expected law of a scene, of
# any shape and with any adhesion. Here both must agree.

expected = rm.run(scene, set={"batch.estimator": "expected", "batch.realizations": 1}).isel(realization=0)
h = expected.separation
summits = {"radius": "50 um", "density": "500 /mm^2", "std": "0.5 um", "effective_modulus": "100 GPa"}
theory = rm.theory.greenwood_williamson(separation=h, **summits) * float(expected.nominal_area)
print(f"largest relative difference of expected law and theory: {float(abs(expected.force / theory - 1).max()):.0e}")

# %%
# The mean of the patches
# -----------------------
# ``ds.roughmdr.statistics()`` gives the mean over the realisations and its standard error (``force_sem``). The mean
# differs from the theory by chance alone, so the difference over the standard error is of order 1. The last column is
# the scatter from patch to patch.

mean = patches.roughmdr.statistics()
table = pd.DataFrame(
    {
        "h / sigma": h / 0.5e-6,
        "contacts": mean.contact_count_mean,
        "mean over theory": mean.force_mean / theory,
        "difference / standard error": (mean.force_mean - theory) / mean.force_sem,
        "scatter of one patch [%]": 100 * patches.force.std("realization", ddof=1) / theory,
    }
)
table.iloc[::-10].round(3).reset_index(drop=True)

# %%
# How many asperities does a patch need?
# --------------------------------------
# A number of contacts :math:`n` of independent asperities scatters as :math:`\sqrt{n}`, and the force a little more,
# since contacts bear different forces. On separations where at least five contacts are expected, compare the scatter of
# the force with :math:`1/\sqrt{n}`.

many = expected.contact_count > 5
scatter = (patches.force.std("realization", ddof=1) / expected.force)[many]
n = expected.contact_count[many]

scatter_figure, axes = plt.subplots(figsize=(6.5, 4), layout="constrained")
axes.loglog(n, scatter, label="32 patches")
axes.loglog(n, n**-0.5, "k--", lw=1, label="1/√n")
axes.set(xlabel="expected number of contacts n", ylabel="standard deviation over mean of the force")
axes.legend()
print(f"scatter of the force times √n: {float((scatter * np.sqrt(n)).mean()):.2f} on average")
