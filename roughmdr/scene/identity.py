"""Tells whether two scenes without a sweep have the same numbers: whether all sections agree that decide any."""

import hashlib

from roughmdr.ensemble.from_file import FromFile
from roughmdr.scene.scene import Scene

LAYOUT = ("title", "output", "batch", "accuracy", "sweep")
"""Sections that decide the layout of a result, and how many realisations it has by which estimator, but not the numbers
of a realisation. Every other section decides these, so that one that is new, or forgotten, does."""


class Digests:
    """Digests of scenes over all of their sections but ``LAYOUT``, with files by their contents.

    Sections that cells of a sweep have in common are the same objects, and are read once.
    """

    def __init__(self) -> None:
        self._known: dict[int, tuple[object, str]] = {}  # by identity; each with its section, which so stays alive

    def of(self, scene: Scene) -> str:
        """Return the digest of a scene without a sweep."""
        names = (name for name in type(scene).model_fields if name not in LAYOUT)
        return _digest("\n".join(f"{name} {self._of_section(getattr(scene, name))}" for name in names))

    def _of_section(self, section: object) -> str:
        if id(section) not in self._known:
            by_content = section
            if isinstance(section, FromFile):
                by_content = section.model_copy(update={"file": section.content_hash})
            self._known[id(section)] = section, _digest(repr(by_content))
        return self._known[id(section)][1]


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()
