"""Boundary elements: height maps pressed into an elastic half-space on a grid, without adhesion.

``surface`` has the pressed surface: a height map, or asperities (``union_map``). ``half_space`` solves one separation,
``path`` all on one grid, ``refine`` on a grid as fine as an error asks for.
"""
