"""
An interface law for finite elements
====================================

The rough layer of a joint is far thinner than an element. This page computes its law, pressure over overclosure, writes
it as a table for Abaqus, CalculiX and CSV, and checks that lines between the points of the table keep the error asked.
"""

import tempfile
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib import pyplot as plt

import roughmdr as rm

# %%
# The scene is a joint of two ground steel faces, as in ``pipelines/scenes/rough_joint.toml``. The roughness of both
# faces is put into one: add the variances of their heights, slopes and curvatures. The expected law has no noise.

SCENE = {
    "title": "Ground faces of a steel joint",
    "material": {"modulus": "210 GPa", "poisson": 0.3},
    "counter": {"modulus": "210 GPa", "poisson": 0.3},
    "asperities": {
        "source": "random",
        "shape": "paraboloid",
        "count": 20_000,
        "patch": "2 mm",
        "height": {"distribution": "normal", "std": "0.5 um"},
        "radius": {"distribution": "lognormal", "mean": "150 um", "std": "30 um"},
    },
    "path": {"separation": {"start": "clear", "stop": {"contact_fraction": 0.02}, "steps": 200}},
    "batch": {"estimator": "expected"},
}
law = rm.run(SCENE).isel(realization=0)

# %%
# Write the tables. ``units`` names length, force and stress of your finite-element model. ``error`` is that of lines
# between the points: the export leaves out every step that this error does not need.

folder = Path(tempfile.mkdtemp())
rm.export(law, folder / "layer.inp", to="abaqus", units="mm,N,MPa")
