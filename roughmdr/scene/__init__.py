"""What is asked: the scene file and its sections."""

from roughmdr.scene.path import Path
from roughmdr.scene.read import read
from roughmdr.scene.sections import Scene

__all__ = ["Path", "Scene", "read"]
