"""
Fit the work of adhesion and the modulus to a measured curve
============================================================

You have a curve of force over separation, and want the work of adhesion and Young's modulus. This page simulates a
noisy measurement, so that the true values are known, and fits them by least squares with the expected law.
"""

import numpy as np
import pandas as pd

import roughmdr as rm

# %%
# The scene says what you know: the roughness. Its modulus and its work of adhesion are where the search starts, and may
# be off by a factor of three. The path of the scene is replaced by that of the measurement.

SCENE = {
    "title": "Rubber on rough glass",
    "material": {"modulus": "2 MPa", "poisson": 0.49},
    "adhesion": {"model": "jkr", "work": "50 mJ/m^2"},
    "asperities": {
        "source": "random",
        "shape": "paraboloid",
        "count": 2000,
        "patch": "1 mm",
        "height": {"distribution": "normal", "std": "1 um"},
        "radius": "100 um",
    },
    "path": {"separation": {"start": "5.5 um", "stop": "1.8 um", "steps": 60}, "unload": True},
    "batch": {"estimator": "expected"},
}
TRUE = {"material.modulus": 3e6, "adhesion.work": 0.02}

# %%
# Simulate the measurement: the law of the true values, with noise of 1 % of the largest force. Units stand in the names
# of the columns. Keep the order of the measurement, loading and then unloading: adhesive contacts remember it.

law = rm.run(SCENE, set=TRUE).isel(realization=0)
noise = np.random.default_rng(5).normal(0, 0.01 * float(law.force.max()), law.sizes["step"])
measured = pd.DataFrame(
    {
        "separation [um]": 1e6 * law.separation.values,
        "force [mN]": 1e3 * (law.force.values + noise),
    }
)
measured.head()

# %%
# Fit. ``free`` names the keys of the scene. A file name in place of the table does as well.

fitted = rm.fit(measured, SCENE, free=list(TRUE))
rows = {}
for key, true in TRUE.items():
    name = key.replace(".", "_")
    rows[f"{key} [{fitted[name].units}]"] = {
        "true": true,
        "fitted": float(fitted[name]),
        "95 % from": float(fitted[f"{name}_low"]),
        "to": float(fitted[f"{name}_high"]),
        "shift by the model error": float(fitted[f"{name}_model_error"]),
    }
pd.DataFrame(rows).T.map("{:.4g}".format)

# %%
# - The noise alone gives intervals of about 1 % and 2 %, and both hold the true values.
# - The last column is no part of them. It says how far the error of the model may shift a parameter that is fitted to a
#   real surface: here by a fifth. The simulated curve comes from the same model, so it is not shifted.
#
# The picture has the curve above and the residuals below. They scatter around zero without a trend, so the scene
# describes the curve. A warning says so where they do not.

figure = rm.plot(fitted)
figure.set_size_inches(7, 5)

# %%
# The residuals are as large as the noise that was put in:

f"residual {1e6 * float(fitted.residual.std()):.2f} uN, noise {1e6 * noise.std():.2f} uN"

# %%
# Ask which parameters the curve can tell apart before you free more of them. Errors of the modulus and the work go
# together, since the correlation is near 1, but the unloading still tells them apart. With the radius free as well it
# would not: a warning then names the parameters, and their intervals are not given.

fitted.correlation.to_pandas().set_axis(list(TRUE), axis=0).set_axis(list(TRUE), axis=1).round(3)
