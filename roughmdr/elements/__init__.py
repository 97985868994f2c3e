"""Boundary elements: height maps pressed into an elastic half-space on a grid, without adhesion.

``half_space`` solves one separation, ``path`` a path of them. The surface is that of asperities (``union_map``).
"""
