"""Asperities that feel each other: a contact lowers the surface under its neighbours.

``settings`` holds what a scene asks for, ``placed`` the positions and the patch that it needs. ``solve`` finds coupled
contacts along a path, from ``newton`` (the equilibrium), ``contacts`` (one contact on a displaced surface), ``close``
(pairs that overlap) and ``dense`` or ``mesh`` (displacements).
"""

from roughmdr.interaction.settings import Interaction

__all__ = ["Interaction"]
