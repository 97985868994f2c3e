"""
Hertz: a sphere pressed into a half-space
=========================================

How large are the force, the contact radius and the pressure when a glass bead is pressed into rubber? This page
compares one asperity with Hertz's closed form and with an independent solution by a row of springs.
"""

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

import roughmdr as rm

rubber = {"modulus": "3 MPa", "poisson": 0.49}
bead = rm.Paraboloid(radius="1 mm")
law = rm.indent(bead, indentation=np.linspace(0, 20e-6, 41), **rubber)
law

# %%
# Hertz replaces the sphere of radius :math:`R` by a paraboloid. At the indentation :math:`\delta` its contact radius
# and its force are
#
# .. math:: a = \sqrt{R \delta}, \qquad F = \tfrac{4}{3} E^* \sqrt{R}\, \delta^{3/2}, \qquad E^* = E / (1 - \nu^2).
#
# The glass counts as rigid. For two elastic bodies, give ``counter_modulus`` and ``counter_poisson`` as well.

R, E = 1e-3, rm.effective_modulus(**rubber)
hertz = 4 / 3 * E * np.sqrt(R) * law.indentation**1.5
r = np.linspace(0, 160e-6, 400)
pressure = rm.pressure(bead, r=r, indentation="15 um", **rubber)

figure, (left, right) = plt.subplots(1, 2, figsize=(8, 3.8), layout="constrained")
left.plot(law.indentation * 1e6, law.force * 1e3, label="rm.indent")
left.plot(law.indentation[::4] * 1e6, hertz[::4] * 1e3, "o", mfc="none", label="Hertz")
left.set(xlabel="indentation [µm]", ylabel="force [mN]")
left.legend()
right.plot(r * 1e6, pressure * 1e-3)
_ = right.set(xlabel="distance from the axis [µm]", ylabel="pressure [kPa]", title="indentation 15 µm")

# %%
# The force agrees with Hertz to rounding. The largest pressure, on the axis, is
# :math:`p_0 = 2 E^* \sqrt{\delta / R} / \pi`.

p_0 = 2 * E * np.sqrt(15e-6 / R) / np.pi
print(f"largest relative difference of the force: {float(abs(law.force / hertz - 1).max()):.1e}")
print(f"relative difference of the largest pressure: {abs(float(pressure[0]) / p_0 - 1):.1e}")

# %%
# An independent solution
# -----------------------
# The method of dimensionality reduction replaces the half-space by a row of springs that do not feel each other.
# ``method="springs"`` solves that row with a finite number of springs, for any profile. It uses no closed form. Its
# error falls with the square of the number of springs.

errors = {}
for springs in (100, 200, 400, 800):
    row = rm.indent(lambda r: r**2 / (2 * R), indentation="15 um", method="springs", springs=springs, **rubber)
    exact = rm.indent(bead, indentation="15 um", **rubber)
    errors[springs] = float(row.force / exact.force - 1)
pd.Series(errors, name="relative error of the force").rename_axis("springs").to_frame()

# %%
# A sphere is not a paraboloid
# ----------------------------
# Hertz's formula is the limit of small contacts. ``rm.Sphere`` has the exact profile of a sphere in a linear elastic
# half-space. At the same indentation Hertz's force is larger. The table shows by how much, over the contact radius
# divided by the radius of the sphere.

sphere = rm.Sphere(radius="1 mm")
ratio = [0.05, 0.1, 0.15, 0.2]
exact = rm.indent(sphere, contact_radius=[x * R for x in ratio], **rubber)
excess = 4 / 3 * E * np.sqrt(R) * exact.indentation**1.5 / exact.force - 1
pd.Series(100 * excess.values, pd.Index(ratio, name="a / R"), name="excess of Hertz [%]").round(3).to_frame()
