"""A curved body on a flat with the rough layer between them, after J. A. Greenwood, J. H. Tripp, J. Appl. Mech. 34
(1967) 153.

The layer has a law per area of its own, p(s) (``local_law.py``); the half-space under it is mapped by the method of
dimensionality reduction (``bulk.py``), on rings (``rings.py``). ``equilibrium.py`` finds the separation s(r) at one
approach, ``follow.py`` goes along the path, ``law.py`` refines the rings until the force is right.
"""

from roughmdr.stages.curved.law import compute, with_body
from roughmdr.stages.curved.refine import Layer

__all__ = ["Layer", "compute", "with_body"]
