"""Kernels of one asperity: jitted scalars, floats in and floats out.

- ``closed``: power laws and the flat punch, by formulas.
- ``profile``: any other shape, without adhesion or with JKR. ``equilibrium`` has the equations, ``folds`` finds where
  the contact detaches, ``exact_fold`` the pull-off there to all digits.
- ``dugdale``: adhesion with a range. ``equilibrium`` has the equations, ``zone_edge`` the condition on the gap,
  ``branches`` finds where the contact detaches, and ``both_edges`` the contact and its zone at a given indentation.

``choose`` returns the kernels of a shape; ``profile.build`` says which functions those of a profile are made of. (H n)
is equation n of M. Hess, On the reduction method of dimensionality: the exact mapping of axisymmetric contact problems
with and without adhesion (2012).
"""
