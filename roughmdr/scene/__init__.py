"""What is asked: the scene file and its sections."""

from roughmdr.scene.path import FlatPath
from roughmdr.scene.read import read
from roughmdr.scene.sections import Scene

__all__ = ["FlatPath", "Scene", "read"]
