"""Asperities that feel each other: a contact lowers the surface under its neighbours.

``settings`` holds what a scene asks for, ``placed`` the positions and the patch that it needs.
"""

from roughmdr.interaction.settings import Interaction

__all__ = ["Interaction"]
