"""Adhesive contacts (JKR) that feel each other: their equilibrium, where it ends, and the avalanches that follow.

All follows from one energy, a function of the contact radii and of the separation. ``contacts`` has the part of one
contact, ``coincident`` that of pairs that overlap, ``equilibrium`` that of all. ``tangent`` has its derivatives and
``newton`` solves with them; ``branch`` is the path along which it is stable, ``jumps`` how a contact is made or lost,
``tension`` the pull-off, and ``path`` the totals.
"""
