"""Asperities that feel each other: a contact lowers the surface under its neighbours.

``settings`` holds what a scene asks for, ``placed`` the positions and the patch that it needs, and
``mean_field`` solves the cheapest of its models.
"""

from roughmdr.interaction.settings import Interaction

__all__ = ["Interaction"]
