r"""
JKR: one adhesive sphere pressed and pulled off
===============================================

Where does an adhesive sphere jump into contact, where does it detach, and which force gives the work of adhesion? The
answer depends on how the sphere is held: by its position (fixed grips) or by its force (dead load).
"""

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

import roughmdr as rm

R, w = 1e-3, 0.05
bead = rm.Paraboloid(radius=R)
contact = {"modulus": "3 MPa", "poisson": 0.49, "work": w}
E = rm.effective_modulus("3 MPa", 0.49)

# %%
# The loop under fixed grips
# --------------------------
# ``approach=True`` follows a slow approach from afar. JKR has no attraction across a gap, so the sphere jumps into
# contact where it touches first, at zero indentation. Without ``approach`` you get the retraction: the contact holds
# down to a negative indentation.

steps = np.linspace(-1.5e-6, 1.5e-6, 601)
loading = rm.indent(bead, indentation=steps, approach=True, **contact)
unloading = rm.indent(bead, indentation=steps, **contact)
jump_in = rm.indent(bead, indentation=0.0, **contact)
free = rm.indent(bead, force=0.0, **contact)
pull_off = rm.pull_off(bead, **contact)
grips = rm.pull_off(bead, control="displacement", **contact)

figure, (left, right) = plt.subplots(1, 2, figsize=(9, 4), layout="constrained")
for axes, name, unit, scale in ((left, "force", "mN", 1e3), (right, "contact_radius", "µm", 1e6)):
    axes.plot(steps * 1e6, loading[name] * scale, lw=3, alpha=0.6, label="loading")
    axes.plot(steps * 1e6, unloading[name] * scale, "--", label="unloading")
    axes.plot([0, 0], [0, jump_in[name] * scale], "C0^", mfc="none", label="jump into contact, fixed grips")
    axes.plot(free.indentation * 1e6, free[name] * scale, "C2D", label="after jump into contact, dead load 0")
    axes.plot(pull_off.indentation * 1e6, pull_off[name] * scale, "ko", label="largest tension: dead load detaches")
    axes.plot(grips.indentation * 1e6, grips[name] * scale, "ks", mfc="none", label="detachment under fixed grips")
    axes.set(xlabel="indentation [µm]", ylabel=f"{name.replace('_', ' ')} [{unit}]")
_ = left.legend(fontsize="small", loc="upper left")

# %%
# Three forces with a closed form
# -------------------------------
# In units of :math:`\pi w R` the JKR theory gives 4/3 after the jump into contact, 3/2 for the largest tension, and
# 5/6 at detachment under fixed grips.

unit = np.pi * w * R
computed = [-float(state.force) / unit for state in (jump_in, pull_off, grips)]
names = ["after the jump into contact", "largest tension", "detachment under fixed grips"]
pd.DataFrame({"computed": computed, "theory": [4 / 3, 3 / 2, 5 / 6]}, names)

# %%
# The work of adhesion from a measured pull-off
# ---------------------------------------------
# Use the **largest tension**: :math:`w = -2 F / (3 \pi R)`. It does not depend on the modulus, nor on the stiffness of
# the machine. The force just before detachment under fixed grips gives 5/9 of the true work.

for point, state in (("the largest tension", pull_off), ("the force at detachment", grips)):
    print(f"from {point}: {-2e3 * float(state.force) / (3 * np.pi * R):.1f} mJ/m²")

# %%
# Fixed grips against dead load
# -----------------------------
# Under a dead load the sphere jumps at other places:
#
# - At zero force it sinks in until the contact radius is :math:`(9 \pi w R^2 / 2 E^*)^{1/3}` (diamond).
# - It detaches at the largest tension (dot), where the contact radius is about twice that at detachment under fixed
#   grips (square).
#
# ``rm.equilibria`` lists every state at one indentation, with its stability under both kinds of control. Between the
# dot and the square a contact is stable under fixed grips only.

closed_form = (9 * np.pi * w * R**2 / (2 * E)) ** (1 / 3)
print(f"contact radius at zero force: {1e6 * float(free.contact_radius):.3f} µm, theory {1e6 * closed_form:.3f} µm")

between = float(pull_off.indentation + grips.indentation) / 2
states = rm.equilibria(bead, indentation=between, **contact)
states[["contact_radius", "force", "stable_displacement", "stable_force"]].to_dataframe()

# %%
# The energy that one loop loses
# ------------------------------
# The area between loading and unloading is the lost energy. On retraction from first touch to detachment, integrate the
# force along the contact radius, in which the curve is smooth. Similarity of JKR contacts gives
# :math:`7.092\, (w^5 R^4 / E^{*2})^{1/3}`.

radii = np.linspace(float(grips.contact_radius), float(jump_in.contact_radius), 2001)
branch = rm.indent(bead, contact_radius=radii, **contact)
lost = -np.trapezoid(branch.force, branch.indentation)
print(f"lost in the loop: {lost:.4e} J, theory {7.092 * (w**5 * R**4 / E**2) ** (1 / 3):.4e} J")
