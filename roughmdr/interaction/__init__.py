"""Asperities that feel each other: a contact lowers the surface under its neighbours.

``settings`` holds what a scene asks for.
"""

from roughmdr.interaction.settings import Interaction

__all__ = ["Interaction"]
