r"""
Flat punch: force, pressure and Kendall's pull-off
==================================================

What does a flat-ended cylinder on an elastic half-space bear in compression and in tension? This page compares the
force, the pressure and the adhesive pull-off with their closed forms.
"""

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

import roughmdr as rm

b, E, w = 10e-6, 4e6, 0.05
punch = rm.FlatPunch(radius=b)
rubber = {"effective_modulus": E}

# %%
# Force over indentation
# ----------------------
# The contact radius of a flat punch is fixed, so the force is linear: :math:`F = 2 E^* b\, \delta`. Without adhesion
# there is no tension. With JKR adhesion the same line goes on below zero, down to the point where the energy that the
# half-space releases equals the work of adhesion. There the whole contact detaches at once (Kendall):
#
# .. math:: \delta_c = -\sqrt{2 \pi b w / E^*}, \qquad F_c = -\sqrt{8 \pi E^* w\, b^3}.

steps = np.linspace(-1.5e-6, 1.5e-6, 601)
plain = rm.indent(punch, indentation=steps, **rubber)
sticky = rm.indent(punch, indentation=steps, work=w, **rubber)
pull_off = rm.pull_off(punch, work=w, **rubber)
kendall = -np.sqrt(8 * np.pi * E * w * b**3)

r = np.linspace(0, 0.995 * b, 300)
closed = E * 1e-6 / (np.pi * np.sqrt(b**2 - r**2))
pressed = rm.pressure(punch, r=r, indentation="1 um", **rubber)
pulled = rm.pressure(punch, r=r, indentation=float(pull_off.indentation) * (1 - 1e-9), work=w, **rubber)

figure, (left, right) = plt.subplots(1, 2, figsize=(9, 4), layout="constrained")
left.plot(steps * 1e6, sticky.force * 1e6, lw=3, alpha=0.6, label="JKR adhesion, unloading")
left.plot(steps * 1e6, plain.force * 1e6, "--", label="no adhesion")
left.axhline(kendall * 1e6, color="k", lw=0.8, ls=":", label="Kendall")
left.set(xlabel="indentation [µm]", ylabel="force [µN]")
left.legend()
right.plot(r * 1e6, pressed * 1e-3, label="pressed in by 1 µm")
right.plot(r[::15] * 1e6, closed[::15] * 1e-3, "o", mfc="none", label="closed form")
right.plot(r * 1e6, pulled * 1e-3, label="just before pull-off")
right.axhline(0, color="k", lw=0.5)
right.set(xlabel="distance from the axis [µm]", ylabel="pressure [kPa]", ylim=(-1000, 1000))
_ = right.legend()

# %%
# The pressure :math:`p = E^* \delta / (\pi \sqrt{b^2 - r^2})` has the same form in compression and in tension. It is
# infinite at the edge, and ``rm.pressure`` refuses ``r = b``. Its integral over the contact is the force. With
# :math:`r = b \sin t` the integrand is smooth.

t, weight = np.polynomial.legendre.leggauss(20)
t, weight = (t + 1) * np.pi / 4, weight * np.pi / 4
p = rm.pressure(punch, r=np.sort(b * np.sin(t)), indentation="1 um", **rubber)
integral = float(np.sum(weight * 2 * np.pi * p * b**2 * np.sin(t) * np.cos(t)))
print(f"pressure over closed form: off by {float(abs(pressed / closed - 1).max()):.1e}")
print(f"integral of the pressure over 2 E* b delta: off by {abs(integral / (2 * E * b * 1e-6) - 1):.1e}")
print(f"pull-off force over Kendall's: off by {abs(float(pull_off.force) / kendall - 1):.1e}")

# %%
# Many small punches hold better than a large one
# -----------------------------------------------
# Kendall's force grows as :math:`b^{3/2}`, the area as :math:`b^2`. Split the punch into :math:`N` independent ones of
# the same total area, and the pull-off force grows as :math:`N^{1/4}`.

split = {}
for number in (1, 16, 256):
    small = rm.pull_off(rm.FlatPunch(radius=b / np.sqrt(number)), work=w, **rubber)
    split[number] = number * float(small.force / pull_off.force)
pd.DataFrame({"total pull-off over that of one": split, "N to the 1/4": {n: n**0.25 for n in split}})

# %%
# No edge is sharp
# ----------------
# ``rm.RoundedPunch`` has a flat of radius ``flat_radius``, and its edge is rounded with ``edge_radius``. Adhesion pulls
# the rubber a little around the edge, so the contact is larger than the flat, and so is the pull-off force. With a
# sharper edge both go to Kendall's values.

rounded = {}
for edge in (1e-9, 1e-7, 1e-6, 1e-5):
    shape = rm.RoundedPunch(flat_radius=b, edge_radius=edge)
    off = rm.pull_off(shape, work=w, **rubber)
    rounded[edge * 1e6] = [float(off.force) / kendall, float(off.contact_radius) / b]
table = pd.DataFrame(rounded, ["pull-off force over Kendall's", "contact radius over b"]).T
table.rename_axis("edge radius [µm]").round(5)
