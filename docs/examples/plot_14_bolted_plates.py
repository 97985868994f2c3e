"""
Bolted plates that yield
========================

Two milled aluminium plates are bolted together. How stiff is the joint, how well does it conduct, and what is left of
both when the bolt loosens? The summits yield under the first load: what follows is elastic, and another law.
"""

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

import roughmdr as rm

# %%
# The summits are those of a Gaussian surface with waves from 50 to 200 um. The roughness of both faces, 1 um each, is
# put into one. The path goes down to 30 MPa and back. Slopes reach 0.8 at the edge of the largest contacts:
# warnings tell that this is beyond the small slopes of the theory, and beyond what yielding was fitted to.

waves = {"hurst": 0.8, "long_wave": "200 um", "short_wave": "50 um", "rms_height": "1.4 um"}
scene = {
    "title": "Bolted aluminium plates",
    "material": {"modulus": "70 GPa", "poisson": 0.33},
    "counter": {"modulus": "70 GPa", "poisson": 0.33},
    "plasticity": {"hardness": "1 GPa"},
    "conduction": {"conductivity": "160 W/m/K"},
    "asperities": {"source": "nayak", "patch": "5 mm", **waves},
    "path": {"separation": {"start": "clear", "stop": {"pressure": "30 MPa"}, "steps": 400}, "unload": True},
    "batch": {"estimator": "expected"},
    "output": {"variables": ["pressure", "contact_fraction", "contact_radius_sum", "stiffness", "thermal_conductance"]},
}
plates = rm.run(scene).isel(realization=0)
area = float(plates.nominal_area)
share, load = float(plates.plastic_contact_fraction), float(plates.plastic_load_fraction)
print(f"{share:.0%} of the contacts, with {load:.0%} of the load, have yielded at 30 MPa")
print(f"models of yielding differ by up to {float(plates.plasticity_error):.0%} along the path")

# %%
# The press and the sound
# -----------------------
# Unloading is another law: the dents fit the flat. Its slope is the elastic stiffness, :math:`2 E^* \sum a`, which
# ultrasound sees during loading too; a press that goes on sees more yielding.

turn = int(plates.separation.values.argmin())
down, up = slice(0, turn + 1), slice(turn + 1, None)  # the turn is there twice: yielding, then elastic
E = rm.effective_modulus("70 GPa", 0.33, "70 GPa", 0.33)
sound = 2 * E * plates.contact_radius_sum / area
p, h, k, c = (plates[name].values for name in ("pressure", "separation", "stiffness", "thermal_conductance"))

figure, (left, right) = plt.subplots(1, 2, figsize=(8, 3.6), layout="constrained")
left.plot(1e6 * h[down], 1e-6 * p[down], label="loading")
left.plot(1e6 * h[up], 1e-6 * p[up], "--", label="unloading")
left.set(xlabel="separation [um]", ylabel="pressure [MPa]", xlim=(None, 6))
right.loglog(1e-6 * p[down], 1e-12 * k[down] / area, label="press, loading")
right.loglog(1e-6 * p[down], 1e-12 * sound[down], ":", label="ultrasound, loading")
right.loglog(1e-6 * p[up], 1e-12 * k[up] / area, "--", label="both, unloading")
right.set(xlabel="pressure [MPa]", ylabel="stiffness per area [TPa/m]", xlim=(0.1, 40), ylim=(0.01, 100))
text = left.legend(), right.legend()

# %%
# The conductance
# ---------------
# Cooper, Mikic and Yovanovich take the contacts for plane sections of the surface under the hardness. Their correlation
# needs the r.m.s. height and the mean slope of a profile, :math:`\sqrt{2 m_2/\pi}`:
#
# .. math:: h = 1.25\, k\, \frac{m}{\sigma} \left(\frac{p}{H}\right)^{0.95}.

moments = rm.spectrum.SelfAffine.of(**waves).moments
faces = {"hardness": "1 GPa", "rms_height": "1.4 um", "mean_slope": np.sqrt(2 * moments.m2 / np.pi)}
cooper = rm.theory.cooper_mikic_yovanovich(pressure=p[down], conductivity="160 W/m/K", **faces)

figure, axes = plt.subplots(figsize=(5.5, 3.6), layout="constrained")
axes.loglog(1e-6 * p[down], 1e-3 * c[down] / area, label="loading")
axes.loglog(1e-6 * p[up], 1e-3 * c[up] / area, "--", label="unloading from 30 MPa")
axes.loglog(1e-6 * p[down], 1e-3 * cooper, "k:", label="Cooper, Mikic, Yovanovich")
axes.set(xlabel="pressure [MPa]", ylabel="conductance [kW/(m² K)]", xlim=(0.1, 40), ylim=(0.5, 1000))
text = axes.legend()

# %%
# What a bolt that loosens leaves, and how far the correlation is off:

at = np.array([0.3e6, 1e6, 3e6, 10e6, 25e6])


def value(curve: np.ndarray, part: slice) -> np.ndarray:
    """Return a curve at the pressures of the table."""
    order = np.argsort(p[part])
    return np.interp(at, p[part][order], curve[part][order]) / area


table = {"loading [kW/(m² K)]": 1e-3 * value(c, down), "unloading [kW/(m² K)]": 1e-3 * value(c, up)}
table["loading over correlation"] = value(c, down) / np.interp(at, p[down], cooper)
pd.DataFrame(table, index=pd.Index(1e-6 * at, name="pressure [MPa]")).round(2)

# %%
# - Contacts that have not yielded bear less than the hardness, on larger contacts: here the conductance is above the
#   correlation. Where all have yielded, and the spectrum is narrow (:math:`\alpha = m_0 m_4/m_2^2` of 2.2), both
#   agree within 4 % for :math:`p/H` from :math:`10^{-6}` to :math:`10^{-3}`; there :math:`p/H` is 0.97 to 0.98 of the
#   contact fraction with ``"mdr"``, whose limit is 2.75 times the yield strength, and equal to it in the limit of Kogut
#   and Etsion.
# - Beyond, independent contacts lack what the correlation adds for their crowding: at :math:`p/H = 0.02` they conduct
#   18 % less.
# - A broad spectrum has many summits on a hill, which would yield into one contact; independent summits do not know.
#   They conduct 14 to 23 % more than the correlation at :math:`\alpha = 15`, and twice as much at 140.
# - ``roughmdr plot --with-theory --x pressure`` draws the correlation over a result of such a scene.
