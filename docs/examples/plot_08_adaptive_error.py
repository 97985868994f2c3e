"""
Ask for an error instead of a number of realisations
====================================================

How many random patches does a mean force need? State the standard error that you want, and let each method stop by
itself. This page compares what was asked, what the result claims, and the true error.
"""

import numpy as np
import pandas as pd

import roughmdr as rm

# %%
# The scene is a soft rubber on rough glass, pressed and pulled off. The path starts where nothing touches.

SCENE = {
    "title": "Rubber on rough glass",
    "seed": 2026,
    "material": {"modulus": "3 MPa", "poisson": 0.49},
    "adhesion": {"model": "jkr", "work": "20 mJ/m^2"},
    "asperities": {
        "source": "random",
        "shape": "paraboloid",
        "count": 500,
        "patch": "1 mm",
        "height": {"distribution": "normal", "std": "1 um"},
        "radius": {"distribution": "lognormal", "mean": "100 um", "std": "10 um"},
    },
    "path": {"separation": {"start": "clear", "stop": "1 sigma", "steps": 40}, "unload": True},
}

# %%
# The expected law is the mean over infinitely many patches, found by integration. It is the reference here.
# Its error relative to its largest force is in ``numerical_error``:

expected = rm.run({**SCENE, "batch": {"estimator": "expected"}}).isel(realization=0)
print(f"error of the reference: {float(expected.numerical_error):.1e}")

# %%
# Now ask for an error. ``relative`` is the standard error of the mean force at every step, divided by the largest mean
# force. ``"auto"`` takes the cheaper of evenly spread draws ("stratified") and the expected law. Name ``"sampled"`` if
# you need independent random patches, for example for the spread between them.

rows = []
for method, wishes in {"auto": (0.05, 0.01, 0.005), "sampled": (0.1, 0.05, 0.02)}.items():
    for asked in wishes:
        result = rm.run({**SCENE, "accuracy": {"relative": asked, "method": method, "max_realizations": 5000}})
        names = result.accuracy_method.attrs["flag_meanings"].split()
        deviation = np.abs(result.force.mean("realization") - expected.force).max() / np.abs(expected.force).max()
        rows.append(
            {
                "method": method,
                "asked": asked,
                "chosen": names[int(result.accuracy_method)],
                "realisations": int(result.realization_count),
                "standard error": f"{float(result.accuracy_reached):.2g}",
                "deviation": f"{float(deviation):.2g}",
            }
        )
pd.DataFrame(rows)

# %%
# - The standard error is below the one asked for in every row. A run stops only when that holds with 99 % confidence,
#   so it goes somewhat below.
# - ``"auto"`` begins with 16 evenly spread realisations, which is enough for 5 %. For 0.5 % the expected law is
#   cheaper. Its error is that of the integration alone.
# - Independent patches take many more realisations: over a hundred for 2 %.
# - "deviation" is the largest distance from the reference along the path. It may be some standard errors: a standard
#   error is no bound.
#
# The error of independent patches falls as :math:`1/\sqrt{n}`. The picture shows that, and what 0.1 % would cost. It
# also shows an error that no number of realisations makes smaller: that of the model (:doc:`plot_09_interaction`).

figure = rm.plot(result, kind="convergence")
figure.set_size_inches(7, 4)
