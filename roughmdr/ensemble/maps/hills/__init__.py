"""Hills of a height map: asperities whose contact grows from a summit through the scales of the surface.

``find`` makes an ensemble of them with their MDR profiles, from ``contact`` (the surface of one hill, without
its neighbours, and the best contact of each size).
"""
