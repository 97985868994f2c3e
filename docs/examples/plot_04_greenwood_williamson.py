r"""
Greenwood and Williamson: many asperities and their mean
========================================================

How far is a finite patch of asperities from the law of Greenwood and Williamson? This page draws 32 patches, shows
their scatter, and compares their mean and the expected law with the theory.
"""

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
from scipy.integrate import quad
from scipy.stats import norm

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
# Each thin line is one patch of 500 asperities. The band is the mean with two standard errors. The thin dark line is
# the expected law: the mean over infinitely many patches. It is integrated, not drawn from random numbers.
#
# The theory
# ----------
# With the density of summits :math:`\eta`, their radius :math:`R` and the density :math:`\varphi` of their heights, the
# pressure is
#
# .. math:: p(h) = \tfrac{4}{3} E^* \sqrt{R}\, \eta \int_h^\infty (z - h)^{3/2} \varphi(z)\, dz.
#
# ``rm.theory.greenwood_williamson`` integrates it, ``estimator = "expected"`` computes the expected law of any scene.
# Here both must agree.

expected = rm.run(scene, set={"batch.estimator": "expected", "batch.realizations": 1}).isel(realization=0)
h = expected.separation
summits = {"radius": "50 um", "density": "500 /mm^2", "std": "0.5 um", "effective_modulus": "100 GPa"}
theory = rm.theory.greenwood_williamson(separation=h, **summits) * float(expected.nominal_area)
print(f"largest relative difference of expected law and theory: {float(abs(expected.force / theory - 1).max()):.0e}")

# %%
# The mean of the patches
# -----------------------
# ``ds.roughmdr.statistics()`` gives the mean over the realisations and its standard error (``force_sem``). The last
# column is the scatter from patch to patch.

mean = patches.roughmdr.statistics()
scatter = patches.force.std("realization", ddof=1) / theory
table = {"h / sigma": h / 0.5e-6, "contacts": mean.contact_count_mean, "mean / theory": mean.force_mean / theory}
table["difference / standard error"] = (mean.force_mean - theory) / mean.force_sem
table["scatter of one patch [%]"] = 100 * scatter
pd.DataFrame(table).iloc[20::10].round(3)

# %%
# With many contacts the mean differs from the theory by about one standard error. Where the patches have less than one
# contact on average, do not trust the standard error. The rare patches that bear much are mostly missing from a sample
# of 32, so that both the mean and its standard error are too small. Use the expected law there.
#
# How many asperities does a patch need?
# --------------------------------------
# The forces :math:`f` of independent asperities add up, so that the scatter of their sum is
#
# .. math:: \frac{\mathrm{std}(F)}{\langle F \rangle} =
#    \sqrt{\frac{1}{N} \left( \frac{\langle f^2 \rangle}{\langle f \rangle^2} - 1 \right)},
#    \qquad f \propto (z - h)^{3/2}.

many = expected.contact_count > 5
n, scatter = expected.contact_count[many], scatter[many]


def moment(h: float, power: float) -> float:
    """Integrate (z - h)^power over the normal density of heights above h, in units of sigma."""
    return quad(lambda x: x**power * norm.pdf(h + x), 0, np.inf)[0]


predicted = [np.sqrt((moment(x, 3) / moment(x, 1.5) ** 2 - 1) / 500) for x in h[many].values / 0.5e-6]

scatter_figure, axes = plt.subplots(figsize=(6.5, 4), layout="constrained")
axes.loglog(n, scatter, "o", mfc="none", label="32 patches of 500 asperities")
axes.loglog(n, predicted, "k-", lw=1, label="sum of independent forces")
axes.loglog(n, n**-0.5, "k--", lw=1, label="1/√n, of the number of contacts")
axes.set(xlabel="expected number of contacts n", ylabel="standard deviation over mean of the force")
axes.set_xticks([5, 10, 20, 50], ["5", "10", "20", "50"])
axes.set_yticks([0.1, 0.2, 0.5], ["0.1", "0.2", "0.5"])
axes.minorticks_off()
axes.legend()
print(f"scatter of 32 patches over the prediction: {float((scatter / predicted).mean()):.2f} on average")
