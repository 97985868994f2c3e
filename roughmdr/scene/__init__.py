"""The scene file: its sections, their validation, and the cells of its sweep."""

from roughmdr.scene.path import FlatPath
from roughmdr.scene.read import read, with_numbers
from roughmdr.scene.scene import Scene

__all__ = ["FlatPath", "Scene", "read", "with_numbers"]
